#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#include "core/extract/live/brick_bits.h"
#include "core/extract/sources/sample_block.h"

namespace isoslider::extract {

/// Where the samples around a brick lie, local coordinates -1 to 9, without a copy: a brick's row is in up to three
/// pieces, x = -1, 0 to 7 and 8 to 9, and rows may lie in up to four places: before and from `splitY` on, before and
/// from `splitZ` on. Pieces outside the box are null and must not be asked for; within the box, only samples may be.
template <class Sample>
struct SampleRows {
    struct Piece {
        const Sample* data = nullptr;
        std::ptrdiff_t first = 0; ///< of the piece's first sample in local row 0 of plane 0; may lie before `data`
    };
    struct Row {
        const Sample* before; ///< x = -1
        const Sample* own; ///< x = 0 to 7
        const Sample* behind; ///< x = 8 and 9
    };

    std::array<int, 3> begin{}, end{}; ///< as in SampleBlock
    int splitY = kNoSplit, splitZ = kNoSplit;
    std::ptrdiff_t rowStride = 0, planeStride = 0;
    std::array<Piece, 4> before, own, behind; ///< by place: bit 0 from splitY on, bit 1 from splitZ on

    static constexpr int kNoSplit = 10;

    Row row(int y, int z) const {
        const auto place = static_cast<std::size_t>((y >= splitY ? 1 : 0) + (z >= splitZ ? 2 : 0));
        const std::ptrdiff_t offset = rowStride * y + planeStride * z;
        const auto at = [offset](const Piece& piece) {
            return piece.data ? piece.data + (piece.first + offset) : nullptr;
        };
        return {at(before[place]), at(own[place]), at(behind[place])};
    }
};

/// Copies rows of a block; its other rows stay as they are. `To`: the samples' type, or one that holds them all.
template <class Sample, class To>
inline void readBlock(const SampleRows<Sample>& from, const BlockRows& rows, SampleBlock<To>& block) {
    block.begin = from.begin;
    block.end = from.end;
    const bool hasBefore = from.begin[0] < 0;
    const auto own = static_cast<std::size_t>(std::min(kBrickSide, from.end[0]));
    const auto behind = static_cast<std::size_t>(from.end[0]) - own;
    for (int z = from.begin[2]; z < from.end[2]; ++z)
        for (int y = from.begin[1]; y < from.end[1]; ++y) {
            if (!(rows[static_cast<std::size_t>(z + 1)] >> (y + 1) & 1))
                continue;
            const auto row = from.row(y, z);
            To* const out = block.samples.data() + SampleBlock<To>::offset(0, y, z);
            if (hasBefore)
                out[-1] = static_cast<To>(*row.before);
            if (own == kBrickSide)
                for (std::size_t x = 0; x < kBrickSide; ++x)
                    out[x] = static_cast<To>(row.own[x]);
            else
                for (std::size_t x = 0; x < own; ++x)
                    out[x] = static_cast<To>(row.own[x]);
            for (std::size_t x = 0; x < behind; ++x)
                out[kBrickSide + x] = static_cast<To>(row.behind[x]);
        }
}

/// Copies what the gradients at the points of `rows` need besides the brick's own samples: x = -1 and 9 of these rows,
/// and the rows on either side where they lie outside the brick.
template <class Sample, class To>
inline void readApron(const SampleRows<Sample>& from, const PointRows& rows, SampleBlock<To>& block) {
    BlockRows outside{};
    for (std::size_t z = 0; z < rows.size(); ++z) {
        const unsigned wanted = rows[z];
        outside[z + 1] = static_cast<std::uint16_t>((wanted & 1) | (wanted >> 8 & 1) << 10);
    }
    outside[0] = static_cast<std::uint16_t>(unsigned{rows[0]} << 1);
    outside[10] = static_cast<std::uint16_t>(unsigned{rows[8]} << 1);
    unsigned any = 0;
    for (const std::uint16_t plane : outside)
        any |= plane;
    if (any != 0)
        readBlock(from, outside, block);
    block.begin = from.begin;
    block.end = from.end;
    const bool hasBefore = from.begin[0]<0, hasBehind = from.end[0]> kPointSide;
    for (int z = 0; z < std::min(kPointSide, from.end[2]); ++z)
        for (unsigned left = rows[static_cast<std::size_t>(z)]; left != 0; left &= left - 1) {
            const int y = std::countr_zero(left);
            if (y >= from.end[1])
                break;
            const auto row = from.row(y, z);
            To* const out = block.samples.data() + SampleBlock<To>::offset(0, y, z);
            if (hasBefore)
                out[-1] = static_cast<To>(*row.before);
            if (hasBehind)
                out[kPointSide] = static_cast<To>(row.behind[1]);
        }
}

} // namespace isoslider::extract
