#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stop_token>
#include <vector>

#include "core/grid/classification.h"
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
    void prepare() {
        findStars();
        findFlatRows();
        const std::int64_t planes = zEnd + 1 - firstPlane;
        higher.find(samples.data(), dims, planes, false,
                    static_cast<std::int64_t>(samples.size()) > planes * planeStep());
    }
    /// The same point's place in `samples` and `higher`.
    std::int64_t inPlanes(std::int64_t place) const { return place + planeStep() * (zBegin - firstPlane); }

private:
    void findStars();
    void findStarsOfBox();
    void findStarsWithMissing();
    void findFlatRows();
};

template <class Sample>
void LayerWindow<Sample>::findStars() {
    stars.resize(static_cast<std::size_t>(points()));
    if (std::any_of(samples.begin(), samples.end(), [](Sample s) { return isMissing(s); }))
        findStarsWithMissing();
    else
        findStarsOfBox();
}

template <class Sample>
void LayerWindow<Sample>::findStarsOfBox() {
    // A side of the star sticks out of the grid at its ends.
    const auto inside = [this](std::size_t axis, std::int64_t at) {
        unsigned star = kWholeStar;
        if (at == 0)
            star &= kStarSides[2 * axis + 1];
        if (at + 1 == dims[axis])
            star &= kStarSides[2 * axis];
        return static_cast<CellStar>(star);
    };
    auto out = stars.begin();
    for (std::int64_t z = zBegin; z <= zEnd; ++z)
        for (std::int64_t y = 0; y < dims[1]; ++y, out += dims[0]) {
            const auto row = static_cast<CellStar>(inside(2, z) & inside(1, y));
            std::fill_n(out, dims[0], row);
            out[0] = static_cast<CellStar>(row & inside(0, 0));
            out[dims[0] - 1] = static_cast<CellStar>(out[dims[0] - 1] & inside(0, dims[0] - 1));
        }
}

template <class Sample>
void LayerWindow<Sample>::findStarsWithMissing() {
    const std::int64_t nx = dims[0], ny = dims[1], step = planeStep();
    const std::int64_t planes = static_cast<std::int64_t>(samples.size()) / step;
    // A plane of cells at a time adds its bits to the points below and above.
    std::fill(stars.begin(), stars.end(), CellStar{0});
    std::vector<std::uint8_t> isComplete(static_cast<std::size_t>(step));
    for (std::int64_t plane = 0; plane + 1 < planes; ++plane) {
        const Sample* const low = samples.data() + step * plane;
        for (std::int64_t y = 0; y + 1 < ny; ++y)
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                bool isWhole = true;
                for (std::size_t c = 0; c < 8; ++c)
                    isWhole = isWhole && !isMissing(low[x + (c & 1) + nx * (y + (c >> 1 & 1)) + step * (c >> 2)]);
                isComplete[static_cast<std::size_t>(x + nx * y)] = isWhole;
            }
        for (std::int64_t dz = 0; dz < 2; ++dz) {
            const std::int64_t z = firstPlane + plane + dz;
            if (z < zBegin || z > zEnd)
                continue;
            for (std::int64_t y = 0; y + 1 < ny; ++y)
                for (std::int64_t x = 0; x + 1 < nx; ++x)
                    if (isComplete[static_cast<std::size_t>(x + nx * y)] != 0)
                        for (std::int64_t c = 0; c < 4; ++c) // the cell lies on the far side of its near corners
                            stars[static_cast<std::size_t>(x + (c & 1) + nx * (y + (c >> 1)) + step * (z - zBegin))] |=
                                static_cast<CellStar>(1u << (7 - (c | dz << 2)));
        }
    }
}

template <class Sample>
void LayerWindow<Sample>::findFlatRows() {
    const std::int64_t nx = dims[0], ny = dims[1];
    const std::int64_t rows = static_cast<std::int64_t>(samples.size()) / nx;
    const auto rowAt = [&](std::int64_t row) { return samples.data() + nx * row; };
    std::vector<std::uint8_t> isConstant(static_cast<std::size_t>(rows));
    for (std::int64_t row = 0; row < rows; ++row)
        isConstant[static_cast<std::size_t>(row)] =
            !isMissing(*rowAt(row)) &&
            std::memcmp(rowAt(row), rowAt(row) + 1, static_cast<std::size_t>(nx - 1) * sizeof(Sample)) == 0;
    const std::int64_t firstRow = ny * (zBegin - firstPlane);
    flatRows.resize(static_cast<std::size_t>(ny * (zEnd - zBegin + 1)));
    for (std::size_t i = 0; i < flatRows.size(); ++i) {
        const std::int64_t row = firstRow + static_cast<std::int64_t>(i), y = row % ny;
        bool isFlat = true;
        for (const std::int64_t plane : {-ny, std::int64_t{0}, ny})
            for (std::int64_t dy = y > 0 ? -1 : 0; dy <= (y + 1 < ny ? 1 : 0); ++dy) {
                const std::int64_t other = row + plane + dy;
                isFlat = isFlat && (other < 0 || other >= rows ||
                                    (isConstant[static_cast<std::size_t>(other)] != 0 && *rowAt(other) == *rowAt(row)));
            }
        flatRows[i] = isFlat;
    }
}

} // namespace isoslider::topology
