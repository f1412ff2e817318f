#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/higher_neighbours.h"
#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// The cells round a grid point that have eight finite corners: bit i that at (i & 1, i >> 1 & 1, i >> 2) - 1 from it.
using CellStar = std::uint8_t;
inline constexpr CellStar kWholeStar = 255;
/// Cells of a star on each side of the point: those with x = 0, with x = 1, with y = 0 ...
inline constexpr std::array<CellStar, 6> kStarSides{0x55, 0xaa, 0x33, 0xcc, 0x0f, 0xf0};

/// Rows of a layer's grid points, in all of its planes, and the cells between them: as much as is worked on at once.
/// Rows `yEnd` belong to the strip after it, too.
struct Strip {
    std::int64_t yBegin = 0, yEnd = 0;

    std::int64_t rows() const { return yEnd - yBegin + 1; }
};

/// Planes of samples around one layer of cells: those of the layer's grid points, and one more on each side where the
/// grid has one, by which the cells round the outer points are known.
template <class Sample>
class LayerWindow {
public:
    /// Grid points of the layer lie in planes zBegin to zEnd, its cells between them.
    GridDims dims{};
    std::int64_t firstPlane = 0, zBegin = 0, zEnd = 0;
    std::vector<Sample> samples; ///< from plane `firstPlane` on
    std::vector<CellStar> stars; ///< of the layer's grid points
    HigherNeighbours higher; ///< of the planes from `firstPlane` to zEnd
    /// By row of the layer's grid points: whether all samples in it and in the rows round it are equal. Nothing happens
    /// there, so that backgrounds and labels take little time.
    std::vector<std::uint8_t> flatRows;
    std::stop_token stop; ///< once asked for, what is found in the layer no longer matters

    std::int64_t rowStep() const { return dims[0]; }
    std::int64_t planeStep() const { return dims[0] * dims[1]; }
    bool isLast() const { return zEnd + 1 == dims[2]; }
    /// Planes of grid points that belong to this layer and to no other.
    std::int64_t ownedEnd() const { return isLast() ? zEnd + 1 : zEnd; }
    std::int64_t points() const { return planeStep() * (zEnd - zBegin + 1); }
    Strip wholeStrip() const { return {0, dims[1] - 1}; }
    bool isLast(const Strip& strip) const { return strip.yEnd + 1 == dims[1]; }
    /// Rows of grid points that belong to this strip and to no other.
    std::int64_t ownedEnd(const Strip& strip) const { return isLast(strip) ? strip.yEnd + 1 : strip.yEnd; }
    /// Of one plane.
    std::int64_t points(const Strip& strip) const { return dims[0] * strip.rows(); }
    /// What the place of a grid point in plane `z`, from the layer's first, is more than that from the strip's first,
    /// counting none but the strip's.
    std::int64_t shift(const Strip& strip, std::int64_t z) const {
        return rowStep() * strip.yBegin + (planeStep() - points(strip)) * (z - zBegin);
    }
    /// Of the whole grid.
    Point firstPoint() const { return static_cast<Point>(planeStep() * zBegin); }
    /// The layer's samples: element 0 is its first grid point. Planes before and after it are there too.
    const Sample* layer() const { return samples.data() + inPlanes(0); }

    bool isFlat(std::int64_t y, std::int64_t z) const {
        return flatRows[static_cast<std::size_t>(dims[1] * (z - zBegin) + y)] != 0;
    }

    /// Fills `stars`, `higher` and `flatRows`. O(points).
    void prepare();
    /// The same point's place in `samples` and `higher`.
    std::int64_t inPlanes(std::int64_t place) const { return place + planeStep() * (zBegin - firstPlane); }

private:
    void findStars();
    void findStarsOfBox();
    void findStarsWithMissing();
    void findFlatRows();
};

} // namespace isoslider::topology
