#include "core/index/format/merge_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>

#include <gtest/gtest.h>
#include <zstd.h>

namespace isoslider::index {
namespace {

constexpr MergeExtent kWhole{17, 17, 17};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A chunk with something else around it, which nobody may look at.
template <class Sample>
struct Volume {
    template <class Function>
    Volume(const MergeExtent& extent, const Function& function) : points(extent) {
        const auto [px, py, pz] = std::tuple(extent[0] + 2, extent[1] + 3, extent[2] + 2);
        random.seed(static_cast<unsigned>(px * 31 + py * 7 + pz));
        for (int i = 0; i < px * py * pz; ++i)
            samples.push_back(std::is_floating_point_v<Sample> && i % 3 ? std::numeric_limits<Sample>::quiet_NaN()
                                                                        : static_cast<Sample>(random() % 100));
        for (int z = 0; z < extent[2]; ++z)
            for (int y = 0; y < extent[1]; ++y)
                for (int x = 0; x < extent[0]; ++x)
                    at(x, y, z) = static_cast<Sample>(function(x, y, z));
    }
    std::ptrdiff_t toNextRow() const { return points[0] + 2; }
    std::ptrdiff_t toNextPlane() const { return toNextRow() * (points[1] + 3); }
    std::size_t indexOf(int x, int y, int z) const {
        return static_cast<std::size_t>((z + 1) * toNextPlane() + (y + 1) * toNextRow() + x + 1);
    }
    Sample& at(int x, int y, int z) { return samples[indexOf(x, y, z)]; }
    long double value(int x, int y, int z) const { return static_cast<long double>(samples[indexOf(x, y, z)]); }
    MergeErrors measure() const {
        return measureMergeErrors(
            SampleBox<Sample>{samples.data() + indexOf(0, 0, 0), toNextRow(), toNextPlane(), points});
    }

    MergeExtent points;
    std::mt19937 random;
    std::vector<Sample> samples;
};

// From first principles: every weight of every corner.
template <class Sample>
long double interpolate(const Volume<Sample>& volume, int side, const MergeExtent& c, const MergeExtent& p) {
    long double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        long double weight = 1;
        MergeExtent q = c;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool isFar = corner >> a & 1;
            const int along = p[a] - c[a];
            weight *= static_cast<long double>(isFar ? along : side - along) / side;
            q[a] += isFar ? side : 0;
        }
        sum += weight * volume.value(q[0], q[1], q[2]);
    }
    return sum;
}

// The largest error in the merged cell from grid point c on, at points `step` apart. Not finite if any is
// not.
template <class Sample>
long double largestError(const Volume<Sample>& volume, int side, const MergeExtent& c, int step) {
    long double most = 0;
    for (int z = c[2]; z <= c[2] + side; z += step)
        for (int y = c[1]; y <= c[1] + side; y += step)
            for (int x = c[0]; x <= c[0] + side; x += step) {
                if (!std::isfinite(volume.value(x, y, z)))
                    return std::numeric_limits<long double>::infinity();
                most = std::max(most, std::fabs(volume.value(x, y, z) - interpolate(volume, side, c, {x, y, z})));
            }
    return most;
}

template <class Sample>
long double addedError(const Volume<Sample>& volume, int side, const MergeExtent& c) {
    if (side == 1)
        return 0;
    long double most = 0;
    for (int i = 0; i < 8; ++i)
        most = std::max(
            most, addedError(volume, side / 2,
                             {c[0] + (i & 1) * side / 2, c[1] + (i >> 1 & 1) * side / 2, c[2] + (i >> 2) * side / 2}));
    return most + largestError(volume, side, c, side / 2);
}

template <class Function>
void forEachCell(const MergeErrors& errors, const Function& function) {
    for (int n = 1; n <= kMergeLevels; ++n)
        for (int z = 0; z < errors.cells(n)[2]; ++z)
            for (int y = 0; y < errors.cells(n)[1]; ++y)
                for (int x = 0; x < errors.cells(n)[0]; ++x)
                    function(n, x, y, z);
}

template <class Sample>
void expectBoundsHold(const Volume<Sample>& volume, const char* name) {
    const MergeErrors errors = volume.measure();
    std::map<std::array<int, 4>, long double> added;
    long double largest = 0, magnitude = 0;
    for (int z = 0; z < volume.points[2]; ++z)
        for (int y = 0; y < volume.points[1]; ++y)
            for (int x = 0; x < volume.points[0]; ++x)
                if (const auto value = volume.value(x, y, z); std::isfinite(value))
                    magnitude = std::max(magnitude, std::fabs(value));
    const long double rounding = std::is_integral_v<Sample> ? 0 : std::ldexp(magnitude, -50);
    forEachCell(errors, [&](int n, int x, int y, int z) {
        const long double e = addedError(volume, 1 << n, {x << n, y << n, z << n});
        added[{n, x, y, z}] = e;
        if (std::isfinite(e))
            largest = std::max(largest, e);
    });
    forEachCell(errors, [&](int n, int x, int y, int z) {
        SCOPED_TRACE(testing::Message() << name << ", level " << n << " at " << x << ' ' << y << ' ' << z);
        const long double bound = errors.errorBound(n, x, y, z);
        const long double e = added[{n, x, y, z}];
        ASSERT_GE(bound + rounding, largestError(volume, 1 << n, {x << n, y << n, z << n}, 1));
        ASSERT_GE(bound + rounding, e);
        if (!std::isfinite(e)) {
            ASSERT_EQ(bound, kInfinity);
        } else if (e <= rounding) {
            ASSERT_LE(bound, std::max(4 * rounding, rounding > 0 ? largest / 4096 : 0));
        } else {
            ASSERT_LT(bound, std::max(2.0001L * (e + rounding), largest / 4096));
        }
    });
}

const MergeExtent kExtents[] = {kWhole,      {1, 1, 1},    {2, 2, 2},   {3, 3, 3},   {17, 2, 17}, {16, 17, 17},
                                {17, 16, 9}, {17, 17, 10}, {5, 17, 17}, {15, 8, 16}, {4, 9, 3}};

template <class T>
class MergeErrorsOf : public testing::Test {
protected:
    std::mt19937 random_{1969};
    double uniform() { return static_cast<double>(random_()) / 4294967296.0; }

    // Within 0 to 120, so that all types can have it.
    std::vector<std::pair<const char*, Volume<T>>> kinds(const MergeExtent& extent) {
        std::vector<std::pair<const char*, Volume<T>>> all;
        const auto add = [&](const char* name, const auto& function) {
            all.emplace_back(name, Volume<T>(extent, function));
        };
        add("noise", [&](int, int, int) { return 120 * uniform(); });
        add("smooth",
            [](int x, int y, int z) { return 60 + 50 * std::sin(0.2 * x + 0.1) * std::cos(0.15 * y - 0.1 * z); });
        add("constant", [](int, int, int) { return 77; });
        add("bowl", [](int x, int y, int z) { return (x * x + y * z) / 5; });
        add("spike", [](int x, int y, int z) { return x == 1 && y == 1 && z == 1 ? 120 : 3; });
        add("step", [](int x, int, int) { return x < 8 ? 100 : 0; });
        return all;
    }
};

using SampleTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::int32_t, float, double>;
TYPED_TEST_SUITE(MergeErrorsOf, SampleTypes);

TYPED_TEST(MergeErrorsOf, BoundTheErrorAndNotByMuchMore) {
    for (const MergeExtent& extent : kExtents)
        for (const auto& [name, volume] : this->kinds(extent))
            expectBoundsHold(volume, name);
}

TYPED_TEST(MergeErrorsOf, BoundTheErrorOfTheWholeRange) {
    using Limits = std::numeric_limits<TypeParam>;
    if (std::is_floating_point_v<TypeParam>)
        return;
    expectBoundsHold(Volume<TypeParam>(
                         kWhole, [&](int, int, int) { return this->random_() % 2 ? Limits::max() : Limits::lowest(); }),
                     "ends of the range");
    expectBoundsHold(Volume<TypeParam>(kWhole,
                                       [&](int, int, int) {
                                           return Limits::lowest() +
                                                  this->uniform() *
                                                      (static_cast<double>(Limits::max()) - Limits::lowest());
                                       }),
                     "noise of the whole range");
}

TYPED_TEST(MergeErrorsOf, AreZeroWhereTheSamplesAreTrilinear) {
    for (const MergeExtent& extent : kExtents)
        for (const int slope : {-1, 0, 2}) {
            const Volume<TypeParam> volume(extent, [&](int x, int y, int z) { return 40 + slope * x + 2 * y - z; });
            const MergeErrors errors = volume.measure();
            forEachCell(errors, [&](int n, int x, int y, int z) { EXPECT_EQ(errors.errorBound(n, x, y, z), 0.0); });
            EXPECT_EQ(encodeMergeErrors(errors).size(), 1u);
        }
}

// The sanitizer sees a step too far.
TYPED_TEST(MergeErrorsOf, LookAtNoOtherSamples) {
    for (const MergeExtent& e : kExtents) {
        const std::size_t count = static_cast<std::size_t>(e[0] * e[1] * e[2]);
        const auto samples = std::make_unique<TypeParam[]>(count);
        for (std::size_t i = 0; i < count; ++i)
            samples[i] = static_cast<TypeParam>(i % 90);
        const MergeErrors packed =
            measureMergeErrors(SampleBox<TypeParam>{samples.get(), e[0], std::ptrdiff_t{e[0]} * e[1], e});
        EXPECT_TRUE(packed == Volume<TypeParam>(e, [&](int x, int y, int z) {
                                  return ((z * e[1] + y) * e[0] + x) % 90;
                              }).measure());
    }
}

TYPED_TEST(MergeErrorsOf, ComeBackFromBytes) {
    for (const MergeExtent& extent : kExtents)
        for (const auto& [name, volume] : this->kinds(extent)) {
            const MergeErrors errors = volume.measure();
            const std::vector<std::byte> bytes = encodeMergeErrors(errors);
            EXPECT_LE(bytes.size(), 3u + 293u);
            MergeErrors out;
            ASSERT_TRUE(decodeMergeErrors(bytes, extent, out)) << name;
            EXPECT_TRUE(out == errors) << name;
        }
}

// x y z grows from 0 to 4096, and no cell sees anything but a trilinear function.
TEST(MergeErrors, AreZeroForAProductOfTheCoordinates) {
    const auto product = [](int x, int y, int z) { return x * y * z - 7 * x * z + 100; };
    const MergeErrors ofShort = Volume<std::int16_t>(kWhole, product).measure();
    const MergeErrors ofFloat = Volume<float>(kWhole, product).measure();
    EXPECT_TRUE(ofShort == MergeErrors(kWhole));
    EXPECT_TRUE(ofFloat == MergeErrors(kWhole));
}

TEST(MergeErrors, AreInfiniteInCellsWithAMissingSampleOnly) {
    for (const MergeExtent& extent : {kWhole, MergeExtent{17, 12, 17}})
        for (const MergeExtent& hole : {MergeExtent{0, 0, 0}, {5, 6, 7}, {8, 8, 8}, {16, 11, 16}, {4, 9, 1}})
            for (const double missing : {std::nan(""), kInfinity, -kInfinity}) {
                Volume<double> volume(extent, [](int x, int y, int z) { return x * x + y * z; });
                volume.at(hole[0], hole[1], hole[2]) = missing;
                expectBoundsHold(volume, "hole");
                const MergeErrors errors = volume.measure();
                MergeErrors out;
                ASSERT_TRUE(decodeMergeErrors(encodeMergeErrors(errors), extent, out));
                EXPECT_TRUE(out == errors);
            }
    const MergeErrors none = Volume<float>(kWhole, [](int, int, int) { return std::nanf(""); }).measure();
    forEachCell(none, [&](int n, int x, int y, int z) { EXPECT_EQ(none.errorBound(n, x, y, z), kInfinity); });
    EXPECT_EQ(encodeMergeErrors(none).size(), 1u);
}

// Holes in what is linear elsewhere: codes 0 and 15 alone.
TEST(MergeErrors, ComeBackWhenThereIsNothingBetweenZeroAndInfinite) {
    Volume<float> volume(kWhole, [](int x, int y, int z) { return 1000 - x - y - z; });
    volume.at(3, 3, 3) = std::nanf("");
    const MergeErrors errors = volume.measure();
    EXPECT_EQ(errors.errorBound(1, 1, 1, 1), kInfinity);
    EXPECT_EQ(errors.errorBound(1, 5, 5, 5), 0.0);
    MergeErrors out;
    ASSERT_TRUE(decodeMergeErrors(encodeMergeErrors(errors), kWhole, out));
    EXPECT_TRUE(out == errors);
}

TEST(MergeErrors, RoundUpSmallOnesBesideLargeOnes) {
    std::mt19937 random(6);
    Volume<std::int32_t> volume(kWhole, [&](int, int, int) { return random() % 3; });
    volume.at(7, 9, 8) = 1 << 30;
    expectBoundsHold(volume, "spike");
    EXPECT_EQ(volume.measure().errorBound(1, 0, 0, 0), std::ldexp(1.0, 30 - 12)); // level 4 has 2^31
}

TEST(MergeErrors, BearTheEndsOfDoubles) {
    constexpr double kMax = std::numeric_limits<double>::max();
    EXPECT_TRUE(Volume<double>(kWhole, [](int, int, int) { return kMax; }).measure() == MergeErrors(kWhole));
    std::mt19937 random(4);
    for (const double scale : {1e308, 1.7e308, 1e-300, 5e-324}) {
        const Volume<double> volume(kWhole,
                                    [&](int, int, int) { return (static_cast<double>(random() % 3) - 1.0) * scale; });
        const MergeErrors errors = volume.measure();
        forEachCell(errors, [&](int n, int x, int y, int z) {
            ASSERT_GE(errors.errorBound(n, x, y, z), static_cast<double>(scale));
        });
        MergeErrors out;
        ASSERT_TRUE(decodeMergeErrors(encodeMergeErrors(errors), kWhole, out));
        EXPECT_TRUE(out == errors);
    }
}

// ---- bytes

// In memory that ends where the bytes end, so that the sanitizer sees a step too far.
bool decodeExactly(std::span<const std::byte> bytes, const MergeExtent& points, MergeErrors& out) {
    const auto input = std::make_unique<std::byte[]>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), input.get());
    return decodeMergeErrors({input.get(), bytes.size()}, points, out);
}

std::vector<std::byte> bytesOf(std::initializer_list<int> values) {
    std::vector<std::byte> bytes;
    for (const int value : values)
        bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

// 5 x 5 x 3 points: 4 merged cells of side 2, of which two lie along x, and no larger one. 3 x 3 x 3: one.
TEST(MergeErrorsFormat, IsAsDocumented) {
    MergeErrors out;
    ASSERT_TRUE(decodeExactly(bytesOf({0x01, 0x01, 0x04, 0xe0, 0xf1}), {5, 5, 3}, out)); // 1025: 2^2
    EXPECT_EQ(out.errorBound(1, 0, 0, 0), 0.0);
    EXPECT_EQ(out.errorBound(1, 1, 0, 0), 4.0);
    EXPECT_EQ(out.errorBound(1, 0, 1, 0), std::ldexp(4.0, -13));
    EXPECT_EQ(out.errorBound(1, 1, 1, 0), kInfinity);
    ASSERT_TRUE(decodeExactly(bytesOf({0xd0, 0x01, 0x04}), {5, 5, 3}, out));
    EXPECT_EQ(out.errorBound(1, 1, 1, 0), 2.0);
    ASSERT_TRUE(decodeExactly(bytesOf({0xf0}), {5, 5, 3}, out));
    EXPECT_EQ(out.errorBound(1, 0, 1, 0), kInfinity);
    ASSERT_TRUE(decodeExactly(bytesOf({0x00}), {1, 17, 17}, out));
}

TEST(MergeErrorsFormat, RefusesMalformedBytes) {
    MergeErrors out;
    const auto isRefused = [&](std::initializer_list<int> values, const MergeExtent& points) {
        return !decodeExactly(bytesOf(values), points, out);
    };
    EXPECT_TRUE(isRefused({}, {5, 5, 3}));
    EXPECT_TRUE(isRefused({0x00, 0x00}, {5, 5, 3})) << "longer";
    EXPECT_TRUE(isRefused({0xd0, 0x01}, {5, 5, 3})) << "no exponent";
    EXPECT_TRUE(isRefused({0xd0, 0x01, 0x04, 0x00}, {5, 5, 3})) << "longer";
    EXPECT_TRUE(isRefused({0xd0, 0xff, 0x07}, {5, 5, 3})) << "exponent of infinity";
    EXPECT_TRUE(isRefused({0xf0}, {1, 5, 3})) << "a code, but no cell";
    EXPECT_TRUE(isRefused({0x01, 0x01, 0x04, 0xe0}, {5, 5, 3})) << "half the cells";
    EXPECT_TRUE(isRefused({0x01, 0x01, 0x04, 0xe0, 0xf1, 0x00}, {5, 5, 3})) << "more cells";
    EXPECT_TRUE(isRefused({0x01, 0x01, 0x04, 0x1e}, {3, 3, 3})) << "a code after the last";
    EXPECT_FALSE(isRefused({0x01, 0x01, 0x04, 0x0e}, {3, 3, 3}));
    EXPECT_TRUE(isRefused({0x11, 0x01, 0x04, 0xe0, 0xf1}, {5, 5, 3})) << "reserved bits";
    for (int mode = 3; mode < 16; ++mode)
        EXPECT_TRUE(isRefused({mode, 0x01, 0x04, 0xe0, 0xf1}, {5, 5, 3})) << "mode " << mode;
    EXPECT_TRUE(isRefused({0x02, 0x01, 0x04, 0xe0, 0xf1}, {5, 5, 3})) << "no frame";
}

TEST(MergeErrorsFormat, RefusesFramesOfOtherThings) {
    const auto isDecoded = [](const std::vector<std::uint8_t>& codes) {
        auto bytes = bytesOf({0x02, 0x01, 0x04});
        bytes.resize(3 + ZSTD_compressBound(codes.size()));
        bytes.resize(3 + ZSTD_compress(&bytes[3], bytes.size() - 3, codes.data(), codes.size(), 1));
        MergeErrors out;
        return decodeExactly(bytes, {5, 5, 3}, out);
    };
    EXPECT_TRUE(isDecoded({0, 14, 1, 15}));
    EXPECT_FALSE(isDecoded({0, 14, 16, 15}));
    EXPECT_FALSE(isDecoded({0, 14, 1}));
    EXPECT_FALSE(isDecoded({0, 14, 1, 15, 0}));
    EXPECT_FALSE(isDecoded(std::vector<std::uint8_t>(2000, 3)));
}

class MergeErrorsDamage : public testing::Test {
protected:
    std::mt19937 random_{42};
    // Raw, packed and constant.
    std::vector<std::vector<std::byte>> chunks() {
        const auto wave = [](int x, int y, int z) { return 100.0 * std::sin(0.1 * x + 0.2 * y) + z; };
        return {encodeMergeErrors(anyErrors()), encodeMergeErrors(Volume<float>(kWhole, wave).measure()),
                bytesOf({0xd0, 0x01, 0x04})};
    }
    // All codes, one as likely as the other.
    MergeErrors anyErrors() {
        auto bytes = bytesOf({0x01, 0x01, 0x04});
        for (int i = 0; i < 293; ++i)
            bytes.push_back(static_cast<std::byte>(random_() % (i < 292 ? 256 : 16)));
        MergeErrors errors;
        EXPECT_TRUE(decodeExactly(bytes, kWhole, errors));
        EXPECT_EQ(encodeMergeErrors(errors), bytes);
        return errors;
    }
};

TEST_F(MergeErrorsDamage, IsFoundWhereTheLengthIsWrong) {
    for (auto chunk : chunks()) {
        MergeErrors out;
        for (std::size_t size = 0; size < chunk.size(); ++size)
            ASSERT_FALSE(decodeExactly(std::span(chunk).first(size), kWhole, out)) << size << " of " << chunk.size();
        chunk.push_back(std::byte{0});
        ASSERT_FALSE(decodeExactly(chunk, kWhole, out));
    }
}

TEST_F(MergeErrorsDamage, DoesNoHarm) {
    for (const auto& chunk : chunks())
        for (int i = 0; i < 20000; ++i) {
            auto damaged = chunk;
            const std::size_t reach = i % 2 ? damaged.size() : std::min<std::size_t>(damaged.size(), 24);
            for (unsigned flips = 1 + random_() % 3; flips > 0; --flips)
                damaged[random_() % reach] ^= static_cast<std::byte>(1 << random_() % 8);
            MergeErrors out;
            if (decodeExactly(damaged, kWhole, out))
                forEachCell(out, [&](int n, int x, int y, int z) { ASSERT_GE(out.errorBound(n, x, y, z), 0.0); });
        }
}

TEST_F(MergeErrorsDamage, IsFoundWhereTheExtentIsAnother) {
    const auto all = chunks();
    for (const MergeExtent& other : {MergeExtent{17, 17, 14}, {9, 17, 17}, {3, 3, 3}, {1, 1, 1}})
        for (std::size_t i = 0; i < 2; ++i) {
            MergeErrors out;
            EXPECT_FALSE(decodeExactly(all[i], other, out)) << i;
        }
}

TEST_F(MergeErrorsDamage, IsTriedInEveryMode) {
    const auto all = chunks();
    EXPECT_EQ(static_cast<int>(all[0][0]), 1);
    EXPECT_EQ(static_cast<int>(all[1][0]), 2);
}

} // namespace
} // namespace isoslider::index
