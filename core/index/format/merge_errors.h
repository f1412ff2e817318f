#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/index/format/chunk_codec.h"

namespace isoslider::index {

/// Merged cells of level n have side 2^n, n = 1 to kMergeLevels, and lie at multiples of it.
inline constexpr int kMergeLevels = 4;
static_assert(kChunkSide == 1 << kMergeLevels);

/// Grid points on and between the faces of a chunk's cells, along each axis: kChunkSide + 1, fewer where the
/// grid ends.
using MergeExtent = std::array<int, 3>;

/// Upper bounds on how far the trilinear interpolants of a chunk's merged cells, each from its 8 corner
/// samples, are from the samples inside and on the faces: 4 bits each. Merged cells that stick out of the
/// grid do not exist and take no bytes.
///
/// What is stored is the error that adds up over the levels (see the source), rounded up to a power of two: 0
/// only where that is 0, less than twice it down to 2^-13 of the chunk's largest, 2^-13 of that below.
/// Infinite where a sample is missing, or the error is above 2^1023. Bounds hold up to the rounding of
/// doubles, some 2^-50 of the largest sample, which there is none of for integers, nor for floats that are
/// such.
class MergeErrors {
public:
    /// All 0. REQUIRES: each extent is 1 to kChunkSide + 1.
    explicit MergeErrors(const MergeExtent& points = {1, 1, 1});

    const MergeExtent& points() const { return points_; }
    /// Merged cells of level n along x, y and z. REQUIRES, here and below: 1 <= n <= kMergeLevels.
    std::array<int, 3> cells(int n) const {
        return {(points_[0] - 1) >> n, (points_[1] - 1) >> n, (points_[2] - 1) >> n};
    }
    /// Of the merged cell from grid point (cx, cy, cz) * 2^n of the chunk on. REQUIRES: within cells(n).
    double errorBound(int n, int cx, int cy, int cz) const;

    bool operator==(const MergeErrors&) const = default;

private:
    friend class MergeErrorCodec;
    static constexpr std::size_t kMaxCells = 8 * 8 * 8 + 4 * 4 * 4 + 2 * 2 * 2 + 1;
    static constexpr int kInfinite = 15; // 0: none; 1 to 14: octaves
    static constexpr int kTopCode = 14;

    std::size_t count() const;
    std::size_t indexOf(int n, int cx, int cy, int cz) const;

    MergeExtent points_;
    int topExponent_ = 0; // of code 14, as in a double's bits: 2^(topExponent_ - 1023)
    std::array<std::uint8_t, kMaxCells> codes_{}; // level 1 first, x fastest; only those that exist
};

/// Where the samples of a chunk lie, x fastest.
template <class Sample>
struct SampleBox {
    const Sample* first = nullptr;
    std::ptrdiff_t toNextRow = 0, toNextPlane = 0; // in samples
    MergeExtent points{1, 1, 1};
};

/// Any thread. REQUIRES: each extent is 1 to kChunkSide + 1.
template <class Sample>
MergeErrors measureMergeErrors(const SampleBox<Sample>& box);

/// One byte where all is 0, at most 3 + 293. Any thread. The bytes depend on the errors and zstd's version.
std::vector<std::byte> encodeMergeErrors(const MergeErrors& errors);

/// False when `bytes` are not the errors of a chunk of so many points; `out` is unspecified then. Believes
/// nothing, but does not see every damage. Any thread. REQUIRES: each extent is 1 to kChunkSide + 1.
[[nodiscard]] bool decodeMergeErrors(std::span<const std::byte> bytes, const MergeExtent& points, MergeErrors& out);

extern template MergeErrors measureMergeErrors(const SampleBox<std::uint8_t>&);
extern template MergeErrors measureMergeErrors(const SampleBox<std::int8_t>&);
extern template MergeErrors measureMergeErrors(const SampleBox<std::uint16_t>&);
extern template MergeErrors measureMergeErrors(const SampleBox<std::int16_t>&);
extern template MergeErrors measureMergeErrors(const SampleBox<std::int32_t>&);
extern template MergeErrors measureMergeErrors(const SampleBox<float>&);
extern template MergeErrors measureMergeErrors(const SampleBox<double>&);

} // namespace isoslider::index
