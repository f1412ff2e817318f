#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/extract/sources/sample_block.h"

namespace isoslider::extract {

/// Where the samples around a brick lie, local coordinates -1 to 9, without a copy: a brick's row is in three pieces,
/// x = -1, 0 to 7 and 8 to 9, and rows lie in nine places, y and z each before the brick, in it and behind it: the
/// brick itself and the 26 around it. Pieces outside the box are null and must not be asked for; within the box, only
/// samples may be.
template <class Sample>
struct SampleRows {
    static constexpr std::size_t kPlaces = 9;
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
    std::ptrdiff_t rowStride = 0, planeStride = 0;
    std::array<Piece, kPlaces> before, own, behind; ///< by placeOf()

    /// -1 before the brick, 0 in it, 1 behind it; of a local coordinate.
    static constexpr int stepOf(int coordinate) {
        return (coordinate >= kBrickSide ? 1 : 0) - (coordinate < 0 ? 1 : 0);
    }
    static constexpr std::size_t placeOf(int stepY, int stepZ) {
        return static_cast<std::size_t>(stepY + 1 + 3 * (stepZ + 1));
    }
    bool isWhole() const {
        return std::max({begin[0], begin[1], begin[2]}) < 0 && std::min({end[0], end[1], end[2]}) > 9;
    }

    Row row(int y, int z) const {
        const std::size_t place = placeOf(stepOf(y), stepOf(z));
        const std::ptrdiff_t offset = rowStride * y + planeStride * z;
        const auto at = [offset](const Piece& piece) {
            return piece.data ? piece.data + (piece.first + offset) : nullptr;
        };
        return {at(before[place]), at(own[place]), at(behind[place])};
    }
};

/// Copies them to a block.
template <class Sample>
inline void readBlock(const SampleRows<Sample>& from, SampleBlock<Sample>& block) {
    block.begin = from.begin;
    block.end = from.end;
    const bool hasBefore = from.begin[0] < 0;
    const auto own = static_cast<std::size_t>(std::min(kBrickSide, from.end[0]));
    const auto behind = static_cast<std::size_t>(from.end[0]) - own;
    for (int z = from.begin[2]; z < from.end[2]; ++z)
        for (int y = from.begin[1]; y < from.end[1]; ++y) {
            const auto row = from.row(y, z);
            Sample* const out = block.samples.data() + block.offset(0, y, z);
            if (hasBefore)
                out[-1] = *row.before;
            std::copy_n(row.own, own, out);
            std::copy_n(row.behind, behind, out + kBrickSide);
        }
}

} // namespace isoslider::extract
