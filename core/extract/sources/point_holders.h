#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/extract/live/brick_bits.h"
#include "core/grid/brick_grid.h"
#include "core/index/format/point_record.h"

namespace isoslider::extract {

/// Edges of a point that a closed brick has. `onFaces`: bit a, the point lies on the lower face of its own brick across
/// axis a. `below`, of these: the holder is the brick below, so that the point lies on its upper face.
constexpr unsigned edgesInHolder(unsigned onFaces, unsigned below) {
    unsigned mask = 0;
    for (unsigned a = 0; a < 3; ++a) {
        const bool isOnFace = onFaces >> a & 1, isBelow = below >> a & 1;
        mask |= unsigned{!isOnFace || isBelow} << (2 * a) | unsigned{!isOnFace || !isBelow} << (2 * a + 1);
    }
    return mask;
}
inline constexpr auto kEdgesInHolder = [] {
    std::array<std::array<std::uint8_t, 8>, 8> masks{};
    for (unsigned onFaces = 0; onFaces < 8; ++onFaces)
        for (unsigned below = 0; below < 8; ++below)
            masks[onFaces][below] = static_cast<std::uint8_t>(edgesInHolder(onFaces, below));
    return masks;
}();

/// Which closed bricks hold a point: that of its own brick and, where it lies on lower faces, those below, on whose
/// upper faces it lies.
class PointHolders {
public:
    explicit PointHolders(const BrickGrid& grid) : places_(grid.brickCount()) {
        GridDims cellBricks; // the last bricks along an axis may hold points only
        for (int a = 0; a < 3; ++a) {
            stride_[static_cast<std::size_t>(a)] = static_cast<std::uint32_t>(grid.brickStride(a));
            cellBricks[a] = (grid.dims()[a] + kCellSide - 2) / kCellSide;
        }
        for (const BrickIndex brick : firstIds<BrickIndex>(places_.size())) {
            const auto at = grid.brickCoords(brick);
            unsigned place = 0;
            for (int a = 0; a < 3; ++a)
                place |= unsigned{at[static_cast<std::size_t>(a)] > 0} << a |
                         unsigned{at[static_cast<std::size_t>(a)] >= cellBricks[a]} << (a + 3);
            places_[brick.index()] = static_cast<std::uint8_t>(place);
        }
    }

    /// Whether its own brick alone holds the point: of two points in three.
    bool isHeldOnce(PointId id) const { return (facesAt(localOf(id)) | places_[brickOf(id).index()] >> 3) == 0; }
    /// Calls visit(holder, mask of the edges at the point that the holder has).
    template <class Visit>
    void forEach(PointId id, const Visit& visit) const {
        const BrickIndex brick = brickOf(id);
        const unsigned onFaces = facesAt(localOf(id)), place = places_[brick.index()];
        const unsigned may = onFaces & place, must = place >> 3;
        for (unsigned below = may;; below = (below - 1) & may) {
            if ((below & must) == must) {
                BrickIndex holder = brick;
                for (std::size_t a = 0; a < 3; ++a)
                    if (below >> a & 1)
                        holder = holder - stride_[a];
                visit(holder, unsigned{kEdgesInHolder[onFaces][below]});
            }
            if (below == 0)
                return;
        }
    }

private:
    /// Bit a: the point lies on the lower face of its own brick across axis a.
    static unsigned facesAt(LocalPoint local) {
        const unsigned p = local.number();
        return unsigned{(p & 7u) == 0} | unsigned{(p >> 3 & 7u) == 0} << 1 | unsigned{p >> 6 == 0} << 2;
    }

    std::array<std::uint32_t, 3> stride_{};
    std::vector<std::uint8_t> places_; // by brick, bit a: there is one below along axis a, bit a + 3: it has no cells
};

} // namespace isoslider::extract
