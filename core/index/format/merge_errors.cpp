#include "core/index/format/merge_errors.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>

#include <zstd.h>

#include "core/base/byte_codec.h"
#include "core/base/check.h"
#include "core/grid/classification.h"
#include "core/index/format/zstd_contexts.h"

namespace isoslider::index {

// The error of a merged cell of level n is e_n = d_n + the largest e_(n-1) of its 8 children, e_0 = 0, where
// d_n is the largest |S - T_n| at its 27 samples of spacing 2^(n-1), T_n being its interpolant. That is a
// bound: in a child, |S - T_n| <= |S - T_(n-1)| + |T_(n-1) - T_n|. The first is at most e_(n-1). The second
// is the difference of two trilinear functions, so trilinear in the child and largest at one of its corners;
// these are among the 27, and there T_(n-1) = S.
//
// FORMAT.md, "Errors of merged cells", has the bytes.

namespace {

// Measured on one core of a busy machine, ns per sample of 129^3, zstd 1.5.4: measured in 2.3 (f32, f64), 1.5
// (16 bits and less); encoded in 0.5, decoded in 0.2 to 0.4. Bytes of a chunk: smooth 98 to 106, noisy 129 to
// 180, at most 296; constant 1.

constexpr int kSide = kChunkSide + 1;

// Sums of 8 samples of 16 bits, and what is added up from them in eighths, are exact in a float.
template <class Sample>
using RealFor = std::conditional_t<(sizeof(Sample) <= 2), float, double>;

// Samples of every 2^(n-1)-th grid point with, in each row, the even ones before the odd ones: so no loop
// below has to take turns. `cells` along each side.
template <class Real, int cells>
struct Lattice {
    static constexpr int kCells = cells;
    static constexpr int kPoints = 2 * cells + 1;
    static constexpr int kOdd = cells + 1; // where the odd ones begin
    using Plane = std::array<Real, kPoints * kPoints>;
    std::array<Plane, kPoints> planes;
};

template <class Real, int cells>
using PerCell = std::array<Real, cells * cells * cells>;

template <class Real>
inline Real larger(Real a, Real b) {
    return a > b ? a : b;
}

// Halves first: a sum of doubles may overflow.
template <class Real>
inline Real mean(Real a, Real b) {
    return a * Real(0.5) + b * Real(0.5);
}

// Of a plane that has corners of cells: interpolants in the layout of its samples.
template <class Real, int cells>
void interpolatePlane(const Real* plane, Real* out) {
    using L = Lattice<Real, cells>;
    for (int y = 0; y < L::kPoints; y += 2) {
        const Real* row = plane + y * L::kPoints;
        Real* to = out + y * L::kPoints;
        for (int i = 0; i <= cells; ++i)
            to[i] = row[i];
        for (int i = 0; i < cells; ++i)
            to[L::kOdd + i] = mean(row[i], row[i + 1]);
    }
    for (int y = 1; y < L::kPoints; y += 2) {
        Real* to = out + y * L::kPoints;
        for (int i = 0; i < L::kPoints; ++i)
            to[i] = mean(to[i - L::kPoints], to[i + L::kPoints]);
    }
}

// The largest error of a plane's samples for each cell above or below it.
template <class Real, int cells>
void errorsOfPlane(const Real* samples, const Real* interpolants, std::array<Real, cells * cells>& out) {
    using L = Lattice<Real, cells>;
    std::array<Real, L::kPoints * L::kPoints> errors;
    for (std::size_t i = 0; i < errors.size(); ++i)
        errors[i] = std::fabs(samples[i] - interpolants[i]);
    std::array<Real, L::kPoints * cells> rows;
    for (int y = 0; y < L::kPoints; ++y) {
        const Real* e = errors.data() + y * L::kPoints;
        for (int i = 0; i < cells; ++i)
            rows[y * cells + i] = larger(larger(e[i], e[i + 1]), e[L::kOdd + i]);
    }
    for (int j = 0; j < cells; ++j) {
        const Real* r = rows.data() + 2 * j * cells;
        for (int i = 0; i < cells; ++i)
            out[j * cells + i] = larger(larger(r[i], r[i + cells]), r[i + 2 * cells]);
    }
}

// d_n of all merged cells.
template <class Real, int cells>
void measureLevel(const Lattice<Real, cells>& lattice, PerCell<Real, cells>& out) {
    using L = Lattice<Real, cells>;
    constexpr std::size_t kLayer = cells * cells;
    typename L::Plane below, between, above;
    std::array<Real, kLayer> belowErrors, betweenErrors, aboveErrors;
    interpolatePlane<Real, cells>(lattice.planes[0].data(), below.data());
    errorsOfPlane<Real, cells>(lattice.planes[0].data(), below.data(), belowErrors);
    for (int k = 0; k < cells; ++k) {
        interpolatePlane<Real, cells>(lattice.planes[2 * k + 2].data(), above.data());
        errorsOfPlane<Real, cells>(lattice.planes[2 * k + 2].data(), above.data(), aboveErrors);
        for (std::size_t i = 0; i < between.size(); ++i)
            between[i] = mean(below[i], above[i]);
        errorsOfPlane<Real, cells>(lattice.planes[2 * k + 1].data(), between.data(), betweenErrors);
        for (std::size_t i = 0; i < kLayer; ++i)
            out[k * kLayer + i] = larger(larger(belowErrors[i], betweenErrors[i]), aboveErrors[i]);
        below = above;
        belowErrors = aboveErrors;
    }
}

// Every second point.
template <class Real, int cells>
void thinOut(const Lattice<Real, 2 * cells>& fine, Lattice<Real, cells>& out) {
    constexpr int kPoints = 2 * cells + 1;
    for (int z = 0; z < kPoints; ++z)
        for (int y = 0; y < kPoints; ++y) {
            const Real* from = fine.planes[2 * z].data() + 2 * y * (4 * cells + 1);
            Real* to = out.planes[z].data() + y * kPoints;
            for (int i = 0; i <= cells; ++i)
                to[i] = from[2 * i];
            for (int i = 0; i < cells; ++i)
                to[cells + 1 + i] = from[2 * i + 1];
        }
}

template <class Real, int cells>
void addChildren(const PerCell<Real, 2 * cells>& children, PerCell<Real, cells>& errors) {
    constexpr int kFine = 2 * cells;
    for (int z = 0; z < cells; ++z)
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x) {
                Real most = 0;
                for (int c = 0; c < 8; ++c)
                    most = larger(
                        most, children[((2 * z + (c >> 2)) * kFine + 2 * y + (c >> 1 & 1)) * kFine + 2 * x + (c & 1)]);
                errors[(z * cells + y) * cells + x] += most;
            }
}

// Where the grid ends its last points are repeated: merged cells that exist do not see it.
template <class Real, class Sample>
bool load(const SampleBox<Sample>& box, Lattice<Real, kChunkSide / 2>& out) {
    bool isMissingAny = false;
    std::array<Real, kSide + 1> line{};
    for (int z = 0; z < kSide; ++z)
        for (int y = 0; y < kSide; ++y) {
            const Sample* row = box.first + std::min(z, box.points[2] - 1) * box.toNextPlane +
                                std::min(y, box.points[1] - 1) * box.toNextRow;
            if (box.points[0] == kSide)
                for (int x = 0; x < kSide; ++x)
                    line[x] = static_cast<Real>(row[x]);
            else
                for (int x = 0; x < kSide; ++x)
                    line[x] = static_cast<Real>(row[std::min(x, box.points[0] - 1)]);
            if constexpr (std::is_floating_point_v<Sample>) {
                Real difference = 0; // NaN if any is not finite
                for (int x = 0; x < kSide; ++x)
                    difference += line[x] - line[x]; // NOLINT(misc-redundant-expression)
                if (difference != 0) {
                    isMissingAny = true;
                    for (Real& value : line)
                        value = isMissing(value) ? Real(0) : value;
                }
            }
            Real* to = out.planes[z].data() + y * kSide;
            for (int i = 0; i <= kChunkSide / 2; ++i)
                to[i] = line[2 * i];
            for (int i = 0; i < kChunkSide / 2; ++i)
                to[kChunkSide / 2 + 1 + i] = line[2 * i + 1];
        }
    return isMissingAny;
}

// Of the power of two next above, in a double's bits: 0 for 0, 2047 beyond the largest power.
template <class Real>
int exponentAbove(Real error) {
    constexpr std::uint64_t kMantissa = (std::uint64_t{1} << 52) - 1;
    return static_cast<int>((std::bit_cast<std::uint64_t>(static_cast<double>(error)) + kMantissa) >> 52);
}
constexpr int kExponentBeyond = 2047;

ZstdContexts& contexts() {
    thread_local ZstdContexts kept;
    return kept;
}

enum Mode : unsigned { kConstant = 0, kRaw = 1, kZstd = 2 };
constexpr std::size_t kHeaderBytes = 3;

} // namespace

MergeErrors::MergeErrors(const MergeExtent& points) : points_(points) {
    for (const int side : points)
        ISO_CHECK(side >= 1 && side <= kSide);
}

std::size_t MergeErrors::count() const {
    std::size_t count = 0;
    for (int n = 1; n <= kMergeLevels; ++n) {
        const auto along = cells(n);
        count += static_cast<std::size_t>(along[0] * along[1] * along[2]);
    }
    return count;
}

std::size_t MergeErrors::indexOf(int n, int cx, int cy, int cz) const {
    std::size_t index = 0;
    for (int level = 1; level < n; ++level) {
        const auto along = cells(level);
        index += static_cast<std::size_t>(along[0] * along[1] * along[2]);
    }
    const auto along = cells(n);
    return index + static_cast<std::size_t>((cz * along[1] + cy) * along[0] + cx);
}

double MergeErrors::errorBound(int n, int cx, int cy, int cz) const {
    const int code = codes_[indexOf(n, cx, cy, cz)];
    if (code == 0)
        return 0.0;
    if (code == kInfinite)
        return std::numeric_limits<double>::infinity();
    return std::ldexp(1.0, topExponent_ - 1023 - kTopCode + code);
}

// Between errors, codes and bytes.
class MergeErrorCodec {
public:
    explicit MergeErrorCodec(const MergeExtent& points) : errors_(points) {}

    // Takes the levels from 1 on, then the missing samples, then finish().
    template <class Real, int cells>
    void addLevel(const PerCell<Real, cells>& errors) {
        const auto along = errors_.cells(std::countr_zero(unsigned{kChunkSide / cells}));
        for (int z = 0; z < along[2]; ++z)
            for (int y = 0; y < along[1]; ++y)
                for (int x = 0; x < along[0]; ++x)
                    exponents_[count_++] =
                        static_cast<std::uint16_t>(exponentAbove(errors[(z * cells + y) * cells + x]));
    }

    template <class Sample>
    void addMissing(const SampleBox<Sample>& box) {
        for (int z = 0; z < box.points[2]; ++z)
            for (int y = 0; y < box.points[1]; ++y)
                for (int x = 0; x < box.points[0]; ++x)
                    if (isMissing(box.first[z * box.toNextPlane + y * box.toNextRow + x]))
                        markAround({x, y, z});
    }

    MergeErrors finish() {
        int top = 0;
        for (std::size_t i = 0; i < count_; ++i)
            if (exponents_[i] != kExponentBeyond)
                top = std::max<int>(top, exponents_[i]);
        for (std::size_t i = 0; i < count_; ++i) {
            const int exponent = exponents_[i];
            const int octave = std::max(1, MergeErrors::kTopCode - top + exponent);
            const int code = exponent == 0 ? 0 : exponent == kExponentBeyond ? MergeErrors::kInfinite : octave;
            errors_.codes_[i] = static_cast<std::uint8_t>(code);
        }
        errors_.topExponent_ = top;
        return errors_;
    }

    static std::vector<std::byte> encode(const MergeErrors& errors);
    static bool decode(std::span<const std::byte> bytes, MergeErrors& out);

private:
    // All merged cells that have the point inside, on a face or at a corner.
    void markAround(const std::array<int, 3>& point) {
        for (int n = 1; n <= kMergeLevels; ++n) {
            const auto along = errors_.cells(n);
            std::array<int, 3> from, to;
            for (std::size_t a = 0; a < 3; ++a) {
                from[a] = std::max(0, (point[a] - 1) >> n);
                to[a] = std::min(along[a] - 1, point[a] >> n);
            }
            for (int z = from[2]; z <= to[2]; ++z)
                for (int y = from[1]; y <= to[1]; ++y)
                    for (int x = from[0]; x <= to[0]; ++x)
                        exponents_[errors_.indexOf(n, x, y, z)] = kExponentBeyond;
        }
    }

    static bool isOctave(int code) { return code != 0 && code != MergeErrors::kInfinite; }

    MergeErrors errors_;
    std::array<std::uint16_t, MergeErrors::kMaxCells> exponents_;
    std::size_t count_ = 0;
};

template <class Sample>
MergeErrors measureMergeErrors(const SampleBox<Sample>& box) {
    using Real = RealFor<Sample>;
    MergeErrorCodec codec(box.points);
    Lattice<Real, 8> fine;
    Lattice<Real, 4> half;
    Lattice<Real, 2> quarter;
    Lattice<Real, 1> whole;
    PerCell<Real, 8> ofFine;
    PerCell<Real, 4> ofHalf;
    PerCell<Real, 2> ofQuarter;
    PerCell<Real, 1> ofWhole;
    const bool isMissingAny = load(box, fine);
    measureLevel(fine, ofFine);
    codec.addLevel<Real, 8>(ofFine);
    thinOut(fine, half);
    measureLevel(half, ofHalf);
    addChildren<Real, 4>(ofFine, ofHalf);
    codec.addLevel<Real, 4>(ofHalf);
    thinOut(half, quarter);
    measureLevel(quarter, ofQuarter);
    addChildren<Real, 2>(ofHalf, ofQuarter);
    codec.addLevel<Real, 2>(ofQuarter);
    thinOut(quarter, whole);
    measureLevel(whole, ofWhole);
    addChildren<Real, 1>(ofQuarter, ofWhole);
    codec.addLevel<Real, 1>(ofWhole);
    if (isMissingAny)
        codec.addMissing(box);
    return codec.finish();
}

std::vector<std::byte> MergeErrorCodec::encode(const MergeErrors& errors) {
    const std::size_t count = errors.count();
    const std::span<const std::uint8_t> codes(errors.codes_.data(), count);
    std::vector<std::byte> bytes(kHeaderBytes);
    const bool isConstant = std::all_of(codes.begin(), codes.end(), [&](int code) { return code == codes[0]; });
    if (isConstant) {
        const unsigned code = count > 0 ? codes[0] : 0u;
        bytes[0] = static_cast<std::byte>(kConstant | code << 4);
        storeLittle<std::uint16_t>(&bytes[1], static_cast<std::uint16_t>(errors.topExponent_));
        bytes.resize(isOctave(static_cast<int>(code)) ? kHeaderBytes : 1);
        return bytes;
    }
    storeLittle<std::uint16_t>(&bytes[1], static_cast<std::uint16_t>(errors.topExponent_));
    const std::size_t rawBytes = (count + 1) / 2;
    bytes.resize(kHeaderBytes + rawBytes);
    const std::size_t packed = orOutOfMemory(
        ZSTD_compressCCtx(contexts().compress.get(), &bytes[kHeaderBytes], rawBytes, codes.data(), count, 1));
    if (!ZSTD_isError(packed) && packed < rawBytes - rawBytes / 8) {
        bytes[0] = std::byte{kZstd};
        bytes.resize(kHeaderBytes + packed);
        return bytes;
    }
    bytes[0] = std::byte{kRaw};
    for (std::size_t i = 0; i < rawBytes; ++i) {
        const unsigned high = 2 * i + 1 < count ? codes[2 * i + 1] : 0u;
        bytes[kHeaderBytes + i] = static_cast<std::byte>(codes[2 * i] | high << 4);
    }
    return bytes;
}

bool MergeErrorCodec::decode(std::span<const std::byte> bytes, MergeErrors& out) {
    if (bytes.empty())
        return false;
    const unsigned mode = static_cast<unsigned>(bytes[0]) & 0xf, high = static_cast<unsigned>(bytes[0]) >> 4;
    const std::size_t count = out.count();
    const bool hasExponent = mode != kConstant || isOctave(static_cast<int>(high));
    if (bytes.size() < (hasExponent ? kHeaderBytes : 1))
        return false;
    if (hasExponent) {
        out.topExponent_ = loadLittle<std::uint16_t>(&bytes[1]);
        if (out.topExponent_ >= kExponentBeyond)
            return false;
    }
    const std::span<const std::byte> data = bytes.subspan(hasExponent ? kHeaderBytes : 1);
    if (mode == kConstant) {
        std::fill_n(out.codes_.begin(), count, static_cast<std::uint8_t>(high));
        return data.empty() && (count > 0 || high == 0);
    }
    if (high != 0)
        return false;
    if (mode == kRaw) {
        if (data.size() != (count + 1) / 2)
            return false;
        for (std::size_t i = 0; i < count; ++i)
            out.codes_[i] = static_cast<std::uint8_t>(static_cast<unsigned>(data[i / 2]) >> 4 * (i % 2) & 0xf);
        return count % 2 == 0 || static_cast<unsigned>(data[count / 2]) >> 4 == 0;
    }
    if (mode != kZstd ||
        ZSTD_decompressDCtx(contexts().decompress.get(), out.codes_.data(), count, data.data(), data.size()) != count)
        return false; // an error is a number larger than any count
    return std::all_of(out.codes_.begin(), out.codes_.begin() + static_cast<std::ptrdiff_t>(count),
                       [](int code) { return code <= MergeErrors::kInfinite; });
}

std::vector<std::byte> encodeMergeErrors(const MergeErrors& errors) { return MergeErrorCodec::encode(errors); }

bool decodeMergeErrors(std::span<const std::byte> bytes, const MergeExtent& points, MergeErrors& out) {
    out = MergeErrors(points);
    return MergeErrorCodec::decode(bytes, out);
}

template MergeErrors measureMergeErrors(const SampleBox<std::uint8_t>&);
template MergeErrors measureMergeErrors(const SampleBox<std::int8_t>&);
template MergeErrors measureMergeErrors(const SampleBox<std::uint16_t>&);
template MergeErrors measureMergeErrors(const SampleBox<std::int16_t>&);
template MergeErrors measureMergeErrors(const SampleBox<std::int32_t>&);
template MergeErrors measureMergeErrors(const SampleBox<float>&);
template MergeErrors measureMergeErrors(const SampleBox<double>&);

} // namespace isoslider::index
