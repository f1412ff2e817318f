#include "core/index/format/chunk_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <zstd.h>

namespace isoslider::index {
namespace {

enum Mode { kRaw, kConstant, kPlain, kAlongX, kLorenzo, kModes };
int modeOf(const std::vector<std::byte>& chunk) { return static_cast<int>(chunk.at(0)) & 0xf; }

constexpr ChunkExtent kWhole{kChunkSide, kChunkSide, kChunkSide};

std::size_t countOf(const ChunkExtent& e) {
    return static_cast<std::size_t>(e[0]) * static_cast<std::size_t>(e[1]) * static_cast<std::size_t>(e[2]);
}

// In memory that ends where the chunk and the samples end, so that the sanitizer sees a step too far.
template <class Sample>
bool decodeExactly(std::span<const std::byte> bytes, const ChunkExtent& extent, std::span<Sample> out) {
    const auto input = std::make_unique<std::byte[]>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), input.get());
    const auto output = std::make_unique<Sample[]>(out.size());
    const bool isDecoded = decodeChunk<Sample>({input.get(), bytes.size()}, extent, {output.get(), out.size()});
    std::memcpy(out.data(), output.get(), out.size_bytes());
    return isDecoded;
}

template <class Sample>
void expectRoundTrip(const std::vector<Sample>& samples, const ChunkExtent& extent) {
    const std::vector<std::byte> chunk = encodeChunk<Sample>(samples, extent);
    EXPECT_LE(chunk.size(), samples.size() * sizeof(Sample) + kChunkHeaderBytes);
    std::vector<Sample> out(samples.size());
    ASSERT_TRUE(decodeExactly<Sample>(chunk, extent, out)) << extent[0] << 'x' << extent[1] << 'x' << extent[2];
    ASSERT_EQ(std::memcmp(samples.data(), out.data(), samples.size() * sizeof(Sample)), 0)
        << extent[0] << 'x' << extent[1] << 'x' << extent[2] << ", mode " << modeOf(chunk);
}

template <class T>
class ChunkCodec : public testing::Test {
protected:
    using Sample = T;
    std::mt19937_64 random_{2003};

    int below(int end) { return static_cast<int>(random_() % static_cast<std::uint64_t>(end)); }

    template <class Function>
    std::vector<Sample> make(const ChunkExtent& extent, const Function& function) {
        std::vector<Sample> samples;
        for (int z = 0; z < extent[2]; ++z)
            for (int y = 0; y < extent[1]; ++y)
                for (int x = 0; x < extent[0]; ++x)
                    samples.push_back(static_cast<Sample>(function(x, y, z)));
        return samples;
    }
    // Any bit pattern, so NaNs of every payload, infinities and denormals.
    std::vector<Sample> noise(const ChunkExtent& extent) {
        std::vector<Sample> samples(countOf(extent));
        for (Sample& sample : samples) {
            const std::uint64_t bits = random_();
            std::memcpy(&sample, &bits, sizeof sample);
        }
        return samples;
    }
    std::vector<Sample> ramp(const ChunkExtent& extent) {
        return make(extent, [](int x, int y, int z) { return x + 2 * y + 3 * z; });
    }
    std::vector<Sample> bowl(const ChunkExtent& extent) {
        return make(extent, [](int x, int y, int z) { return (x * x + y * z + x * y * z) % 120; });
    }
    std::vector<Sample> fewValues(const ChunkExtent& extent) {
        return make(extent, [&](int, int, int) { return std::array{0, 3, 64, 101}[random_() % 4]; });
    }
    // Each row goes its own way.
    std::vector<Sample> walks(const ChunkExtent& extent) {
        int at = 0;
        return make(extent, [&](int x, int, int) { return x == 0 ? at = 20 + below(80) : at += below(3) - 1; });
    }
    // Of every mode, if the type has one: all that a decoder can meet.
    std::vector<std::vector<Sample>> kinds(const ChunkExtent& extent) {
        return {noise(extent),     std::vector<Sample>(countOf(extent), Sample(77)),
                fewValues(extent), walks(extent),
                bowl(extent),      ramp(extent)};
    }
    ChunkExtent randomExtent() { return {1 + below(16), 1 + below(16), 1 + below(16)}; }
};

using SampleTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::int32_t, float, double>;
TYPED_TEST_SUITE(ChunkCodec, SampleTypes);

TYPED_TEST(ChunkCodec, RoundTripsEveryKindOfWholeChunk) {
    for (const auto& samples : this->kinds(kWhole))
        expectRoundTrip<TypeParam>(samples, kWhole);
}

TYPED_TEST(ChunkCodec, RoundTripsChunksOfEveryExtent) {
    for (int side = 1; side <= kChunkSide; ++side)
        for (const ChunkExtent& extent :
             {ChunkExtent{side, 16, 16}, {16, side, 16}, {16, 16, side}, {side, 1, 1}, {1, side, 1}, {1, 1, side}})
            for (const auto& samples : this->kinds(extent))
                expectRoundTrip<TypeParam>(samples, extent);
    for (int i = 0; i < 150; ++i) {
        const ChunkExtent extent = this->randomExtent();
        for (const auto& samples : this->kinds(extent))
            expectRoundTrip<TypeParam>(samples, extent);
    }
}

TYPED_TEST(ChunkCodec, RoundTripsTheEndsOfTheRange) {
    using Limits = std::numeric_limits<TypeParam>;
    for (const double share : {0.01, 0.5, 0.99}) {
        const auto samples = this->make(kWhole, [&](int, int, int) {
            return this->random_() < share * std::pow(2.0, 64) ? Limits::lowest() : Limits::max();
        });
        expectRoundTrip<TypeParam>(samples, kWhole);
    }
}

TYPED_TEST(ChunkCodec, UsesEachModeWhereItServes) {
    const auto mode = [](const std::vector<TypeParam>& samples) {
        return modeOf(encodeChunk<TypeParam>(samples, kWhole));
    };
    EXPECT_EQ(mode(this->noise(kWhole)), kRaw);
    EXPECT_EQ(mode(std::vector<TypeParam>(countOf(kWhole), TypeParam(5))), kConstant);
    EXPECT_EQ(mode(this->fewValues(kWhole)), kPlain);
    if (std::is_integral_v<TypeParam>) { // the bits of a float do not walk as its value does
        EXPECT_EQ(mode(this->walks(kWhole)), kAlongX);
        EXPECT_EQ(mode(this->ramp(kWhole)), kLorenzo);
    }
}

TYPED_TEST(ChunkCodec, StoresSmoothSamplesInLittle) {
    const std::size_t rawBytes = countOf(kWhole) * sizeof(TypeParam);
    EXPECT_LE(encodeChunk<TypeParam>(std::vector<TypeParam>(countOf(kWhole), TypeParam(1)), kWhole).size(),
              2 + sizeof(TypeParam));
    EXPECT_LT(encodeChunk<TypeParam>(this->ramp(kWhole), kWhole).size(),
              rawBytes / (std::is_integral_v<TypeParam> ? 20 : 6));
    EXPECT_LT(encodeChunk<TypeParam>(this->fewValues(kWhole), kWhole).size(), rawBytes * 2 / 5);
}

TYPED_TEST(ChunkCodec, EncodesTheSameAfterOtherChunksAndOnOtherThreads) {
    const auto all = this->kinds(kWhole);
    std::vector<std::vector<std::byte>> first;
    for (const auto& samples : all)
        first.push_back(encodeChunk<TypeParam>(samples, kWhole));
    std::array<int, 4> differences{};
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < differences.size(); ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < 3 * all.size(); ++i) {
                const std::size_t k = (i * (2 * t + 5) + t) % all.size();
                differences[t] += encodeChunk<TypeParam>(all[k], kWhole) != first[k];
                std::vector<TypeParam> out(countOf(kWhole));
                differences[t] += !decodeChunk<TypeParam>(first[k], kWhole, out);
                differences[t] += std::memcmp(out.data(), all[k].data(), out.size() * sizeof(TypeParam)) != 0;
            }
        });
    threads.clear();
    EXPECT_EQ(differences, (std::array<int, 4>{}));
}

TYPED_TEST(ChunkCodec, RefusesEveryOtherLength) {
    for (const ChunkExtent& extent : {kWhole, ChunkExtent{7, 5, 16}})
        for (const auto& samples : this->kinds(extent)) {
            const auto chunk = encodeChunk<TypeParam>(samples, extent);
            std::vector<TypeParam> out(samples.size());
            for (std::size_t size = 0; size < chunk.size(); size += 1 + size / 4096)
                ASSERT_FALSE(decodeExactly<TypeParam>(std::span(chunk).first(size), extent, out))
                    << size << " of " << chunk.size();
            for (const int extra : {0, 1, 40, 255}) {
                auto longer = chunk;
                longer.push_back(static_cast<std::byte>(extra));
                ASSERT_FALSE(decodeExactly<TypeParam>(longer, extent, out)) << extra;
            }
        }
}

TYPED_TEST(ChunkCodec, RefusesAnotherExtent) {
    const ChunkExtent extent{8, 16, 4};
    for (const auto& samples : this->kinds(extent)) {
        const auto chunk = encodeChunk<TypeParam>(samples, extent);
        for (const ChunkExtent& other : {ChunkExtent{16, 8, 4},
                                         {8, 4, 16},
                                         {4, 8, 16},
                                         {8, 16, 3},
                                         {8, 16, 5},
                                         {7, 16, 4},
                                         {1, 1, 1},
                                         {16, 16, 16},
                                         {16, 16, 2}}) {
            std::vector<TypeParam> out(countOf(other));
            EXPECT_FALSE(decodeExactly<TypeParam>(chunk, other, out))
                << other[0] << 'x' << other[1] << 'x' << other[2] << ", mode " << modeOf(chunk);
        }
    }
}

TYPED_TEST(ChunkCodec, RefusesUnknownModes) {
    for (const auto& samples : this->kinds(kWhole)) {
        auto chunk = encodeChunk<TypeParam>(samples, kWhole);
        std::vector<TypeParam> out(samples.size());
        for (int mode = kModes; mode < 16; ++mode) {
            chunk[0] = (chunk[0] & std::byte{0xf0}) | static_cast<std::byte>(mode);
            EXPECT_FALSE(decodeExactly<TypeParam>(chunk, kWhole, out)) << mode;
        }
    }
}

// 112,000 damaged chunks over the seven types. Not every one is found; none does harm.
TYPED_TEST(ChunkCodec, SurvivesDamage) {
    int found = 0, tried = 0;
    for (const ChunkExtent& extent : {kWhole, ChunkExtent{16, 16, 5}, {5, 7, 3}, {16, 2, 1}})
        for (const auto& samples : this->kinds(extent)) {
            const auto chunk = encodeChunk<TypeParam>(samples, extent);
            std::vector<TypeParam> out(samples.size());
            for (int i = 0; i < 667; ++i, ++tried) {
                auto damaged = chunk;
                // The first bytes state how to read all others: they get half of the flips.
                const int reach = static_cast<int>(i % 2 ? damaged.size() : std::min<std::size_t>(damaged.size(), 40));
                for (int flips = 1 + this->below(3); flips > 0; --flips)
                    damaged[static_cast<std::size_t>(this->below(reach))] ^=
                        static_cast<std::byte>(1 << this->below(8));
                found += !decodeExactly<TypeParam>(damaged, extent, out);
            }
        }
    EXPECT_GE(tried, 16000);
    EXPECT_GT(found, tried / 4);
}

template <class Float>
void expectBitsKept() {
    using Bits = std::conditional_t<sizeof(Float) == 4, std::uint32_t, std::uint64_t>;
    using Limits = std::numeric_limits<Float>;
    constexpr Bits kNan = std::bit_cast<Bits>(Limits::quiet_NaN());
    constexpr Bits kSign = Bits(1) << (8 * sizeof(Bits) - 1);
    const std::vector<Bits> patterns{0,
                                     kSign,
                                     kNan,
                                     kNan | 0x123,
                                     kNan | kSign,
                                     std::bit_cast<Bits>(Limits::infinity()) | 1, // signalling
                                     std::bit_cast<Bits>(Limits::infinity()),
                                     std::bit_cast<Bits>(-Limits::infinity()),
                                     1,
                                     kSign | 1,
                                     0x7ff};
    for (std::size_t runs = 1; runs <= 4096; runs *= 8) { // from all mixed up to one after the other
        std::vector<Float> samples(countOf(kWhole));
        for (std::size_t i = 0; i < samples.size(); ++i)
            std::memcpy(&samples[i], &patterns[i / runs % patterns.size()], sizeof(Float));
        expectRoundTrip<Float>(samples, kWhole);
    }
    for (const Bits pattern : patterns) {
        std::vector<Float> constant(countOf(kWhole));
        for (Float& sample : constant)
            std::memcpy(&sample, &pattern, sizeof(Float));
        expectRoundTrip<Float>(constant, kWhole);
        std::vector<Float> mixed = constant; // all the same but for the sign of one zero, or the last bit
        const Bits other = pattern == 0 ? kSign : pattern ^ 1;
        std::memcpy(&mixed[4095], &other, sizeof(Float));
        expectRoundTrip<Float>(mixed, kWhole);
    }
}

TEST(ChunkCodecFloats, KeepNanPayloadsSignsOfZeroAndDenormals) {
    expectBitsKept<float>();
    expectBitsKept<double>();
}

// ---- bytes written by hand after the document

std::vector<std::byte> bytesOf(std::initializer_list<int> values) {
    std::vector<std::byte> bytes;
    for (const int value : values)
        bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

std::vector<std::uint16_t> decodeByHand(std::initializer_list<int> values) {
    std::vector<std::uint16_t> out(12);
    EXPECT_TRUE(decodeExactly<std::uint16_t>(bytesOf(values), {3, 2, 2}, out));
    return out;
}

// Extent 3 x 2 x 2: codes 2, 1, 1. Tables: 12 raw bytes (0x400c), then one constant (0x0001).
TEST(ChunkCodecFormat, IsAsDocumented) {
    using Samples = std::vector<std::uint16_t>;
    EXPECT_EQ(decodeByHand({0x20, 0x11, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 7, 0, 8, 0, 9, 0, 10, 0, 11, 0, 0, 1}),
              (Samples{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 256}));
    EXPECT_EQ(decodeByHand({0x21, 0x11, 0x34, 0x12}), Samples(12, 0x1234));
    EXPECT_EQ(decodeByHand({0x22, 0x11, 0x0c, 0x40, 0x01, 0x00, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 2}),
              (Samples{513, 514, 515, 516, 517, 518, 519, 520, 521, 522, 523, 524}));
    // Zigzag: 0, -1, 1, -2, 2 are 0, 1, 2, 3, 4. A row goes on from the start of the row before, or of the
    // plane before.
    EXPECT_EQ(decodeByHand({0x23, 0x11, 0x0c, 0x40, 0x01, 0x00, 200, 2, 1, 4, 0, 2, 20, 0, 0, 3, 2, 2, 0}),
              (Samples{100, 101, 100, 102, 102, 103, 110, 110, 110, 108, 109, 110}));
    // 100 + 10 x + 20 y + 30 z, and 1 more at the last sample.
    EXPECT_EQ(decodeByHand({0x24, 0x11, 0x0c, 0x40, 0x01, 0x00, 200, 20, 20, 40, 0, 0, 60, 0, 0, 0, 0, 2, 0}),
              (Samples{100, 110, 120, 120, 130, 140, 130, 140, 150, 150, 160, 171}));
}

TEST(ChunkCodecFormat, RefusesMalformedPlanes) {
    std::vector<std::uint16_t> out(12);
    const auto isRefused = [&](std::initializer_list<int> values) {
        return !decodeExactly<std::uint16_t>(bytesOf(values), {3, 2, 2}, out);
    };
    EXPECT_FALSE(isRefused({0x22, 0x11, 0x01, 0x00, 0x01, 0x00, 1, 2}));
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x02, 0x00, 0x01, 0x00, 1, 2, 3})) << "constant of two bytes";
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x00, 0x00, 0x01, 0x00, 2})) << "constant of none";
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x0b, 0x40, 0x01, 0x00, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 2}))
        << "raw, one short";
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x01, 0xc0, 0x01, 0x00, 1, 2})) << "unknown plane mode";
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x01, 0x00, 0x00, 0x80, 1})) << "no frame";
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x01, 0x00})) << "half a table";
    EXPECT_TRUE(isRefused({0x22, 0x11, 0x01, 0x00, 0x01, 0x00, 1})) << "last plane missing";
    EXPECT_TRUE(isRefused({0x21, 0x11, 0x34})) << "half a sample";
}

// A frame of more samples, or fewer, than the chunk has.
TEST(ChunkCodecFormat, RefusesFramesOfAnotherSize) {
    for (const std::size_t size : {11u, 12u, 13u, 5000u}) {
        const std::vector<char> content(size, 'a');
        std::vector<std::byte> frame(ZSTD_compressBound(size));
        frame.resize(ZSTD_compress(frame.data(), frame.size(), content.data(), size, 1));
        auto chunk = bytesOf({0x22, 0x11, static_cast<int>(frame.size()), 0x80});
        chunk.insert(chunk.end(), frame.begin(), frame.end());
        std::vector<std::uint8_t> out(12);
        EXPECT_EQ(decodeExactly<std::uint8_t>(chunk, {3, 2, 2}, out), size == 12) << size;
    }
}

// ---- the same bytes everywhere and for ever

std::uint64_t addHash(std::uint64_t hash, std::span<const std::byte> bytes) { // FNV-1a
    for (const std::byte byte : bytes)
        hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
    return hash;
}

bool hasFrame(const std::vector<std::byte>& chunk, std::size_t planes) {
    for (std::size_t p = 0; p < planes && modeOf(chunk) >= kPlain; ++p)
        if (static_cast<unsigned>(chunk.at(kChunkHeaderBytes + 2 * p + 1)) >> 6 == 2)
            return true;
    return false;
}

// Of chunks whose planes zstd leaves alone, or of others; in integers, so there is no rounding anywhere.
std::uint64_t goldenHash(bool throughZstd) {
    std::uint64_t hash = 0xcbf29ce484222325u, state = 1;
    const auto next = [&] { return state = state * 6364136223846793005u + 1442695040888963407u, state >> 33; };
    const auto add = [&]<class Sample>(const ChunkExtent& extent, const auto& function) {
        std::vector<Sample> samples(countOf(extent));
        for (std::size_t i = 0; i < samples.size(); ++i)
            samples[i] = static_cast<Sample>(function(static_cast<std::int64_t>(i)));
        const auto chunk = encodeChunk<Sample>(samples, extent);
        EXPECT_EQ(hasFrame(chunk, sizeof(Sample)), throughZstd);
        hash = addHash(hash, chunk);
    };
    for (const ChunkExtent& extent : {kWhole, ChunkExtent{16, 9, 4}, {13, 16, 16}}) {
        if (throughZstd) {
            const auto field = [&](std::int64_t i) {
                return (i % 16) * (i / 16 % 16) / 4 + i / 256 + static_cast<std::int64_t>(next() % 5);
            };
            add.operator()<std::uint8_t>(extent, field);
            if (countOf(extent) > 1000) // an eighth to save, less the frame and its table
                add.operator()<std::uint8_t>(extent, [&](std::int64_t) { return next() % 128; });
            add.operator()<std::int16_t>(extent, [&](std::int64_t i) { return 40 * field(i) - 1000; });
            add.operator()<float>(extent, field);
            add.operator()<double>(extent, field);
        } else {
            add.operator()<std::int8_t>(extent, [](std::int64_t) { return -7; });
            add.operator()<std::uint8_t>(extent, [&](std::int64_t) { return next(); });
            // All but the low byte are constant: as they are, or after the filter.
            add.operator()<std::uint16_t>(extent, [&](std::int64_t) { return next() % 256; });
            std::int64_t at = 0, rowStart = 0, planeStart = 0;
            add.operator()<std::int32_t>(extent, [&](std::int64_t i) {
                const std::int64_t step = static_cast<std::int64_t>(next() % 256) - 128;
                if (i % extent[0] != 0)
                    return at += step;
                const bool startsPlane = i / extent[0] % extent[1] == 0;
                at = rowStart = (startsPlane ? planeStart : rowStart) + step;
                planeStart = startsPlane ? at : planeStart;
                return at;
            });
        }
    }
    return hash;
}

TEST(ChunkCodecGolden, BytesAreThoseOfTheFirstVersion) { EXPECT_EQ(goldenHash(false), 3854271039961006640u); }

TEST(ChunkCodecGolden, BytesAreThoseOfTheFirstVersionThroughZstd) {
    if (ZSTD_versionNumber() != 10504)
        GTEST_SKIP() << "packed planes differ between versions of zstd; the hash is of 1.5.4";
    EXPECT_EQ(goldenHash(true), 11472711456714126112u);
}

} // namespace
} // namespace isoslider::index
