#include "core/extract/live/brick_shapes.h"

#include <algorithm>
#include <iterator>

namespace isoslider::extract {
namespace {

using Cell = std::array<std::int64_t, 3>;

// Cell k of the four around an edge of that axis that starts at `point`.
Cell cellAround(const Cell& point, int axis, int k) {
    Cell cell = point;
    cell[static_cast<std::size_t>((axis + 1) % 3)] -= 1 - (k & 1);
    cell[static_cast<std::size_t>((axis + 2) % 3)] -= 1 - (k >> 1);
    return cell;
}

bool isInBrick(const Cell& cell) {
    return std::all_of(cell.begin(), cell.end(), [](std::int64_t c) { return c >= 0 && c < kCellSide; });
}

// `isValid(cell)` at coordinates of the brick, from -1 to 8.
template <class IsValid>
BrickMasks makeMasks(const IsValid& isValid) {
    BrickMasks masks;
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y)
            for (int x = 0; x < kPointSide; ++x) {
                const Cell point{x, y, z};
                const ClosedPoint p = closedPoint(x, y, z);
                if (isInBrick(point) && isValid(point))
                    masks.cells.set(p);
                for (int axis = 0; axis < 3; ++axis) {
                    const auto a = static_cast<std::size_t>(axis);
                    if (point[a] == kCellSide)
                        continue; // leaves the brick
                    bool isFirst = true;
                    for (int k = 0; k < 4; ++k) {
                        const Cell cell = cellAround(point, axis, k);
                        if (!isValid(cell))
                            continue;
                        if (isInBrick(cell)) {
                            masks.edges[a].set(p);
                            if (isFirst)
                                masks.owned[a].set(p);
                        }
                        isFirst = false;
                    }
                }
            }
    return masks;
}

} // namespace

BrickShapes::BrickShapes(const GridDims& dims, const std::vector<index::MissingCells>& missing)
    : dims_(dims), grid_(dims), missing_(missing), byPlace_(64) {
    for (unsigned place = 0; place < 64; ++place) {
        std::array<std::int64_t, 3> begin, end; // cells in the box, in coordinates of the brick
        for (int a = 0; a < 3; ++a) {
            const std::int64_t lastOrigin = (grid_.bricks()[a] - 1) * kCellSide;
            begin[static_cast<std::size_t>(a)] = place >> a & 1 ? 0 : -1;
            end[static_cast<std::size_t>(a)] = place >> (a + 3) & 1 ? dims[a] - 1 - lastOrigin : kPointSide;
        }
        // The brick before the last may border on one without cells.
        byPlace_[place] = makeMasks([&](const Cell& cell) {
            for (std::size_t a = 0; a < 3; ++a)
                if (cell[a] < begin[a] || cell[a] >= end[a])
                    return false;
            return true;
        });
    }
}

unsigned BrickShapes::placeOf(BrickIndex brick) const {
    const auto c = grid_.brickCoords(brick);
    unsigned place = 0;
    for (unsigned a = 0; a < 3; ++a) {
        place |= static_cast<unsigned>(c[a] == 0) << a;
        place |= static_cast<unsigned>(c[a] + 1 == grid_.bricks()[static_cast<int>(a)]) << (a + 3);
    }
    return place;
}

bool BrickShapes::hasCells(BrickIndex brick) const {
    const auto c = grid_.brickCoords(brick);
    for (int a = 0; a < 3; ++a)
        if (c[static_cast<std::size_t>(a)] * kCellSide + 1 >= dims_[a])
            return false;
    return true;
}

const index::MissingCells* BrickShapes::missingOf(BrickIndex brick) const {
    const auto found = std::lower_bound(missing_.begin(), missing_.end(), brick,
                                        [](const index::MissingCells& m, BrickIndex b) { return m.brick < b; });
    return found != missing_.end() && found->brick == brick ? &*found : nullptr;
}

bool BrickShapes::isNearMissing(BrickIndex brick) const {
    if (missing_.empty())
        return false;
    const auto c = grid_.brickCoords(brick);
    for (std::int64_t z = std::max<std::int64_t>(0, c[2] - 1); z <= std::min(grid_.bricks()[2] - 1, c[2] + 1); ++z)
        for (std::int64_t y = std::max<std::int64_t>(0, c[1] - 1); y <= std::min(grid_.bricks()[1] - 1, c[1] + 1); ++y)
            for (std::int64_t x = std::max<std::int64_t>(0, c[0] - 1); x <= std::min(grid_.bricks()[0] - 1, c[0] + 1); ++x)
                if (missingOf(grid_.brickAt(x, y, z)))
                    return true;
    return false;
}

bool BrickShapes::isCellValid(const Cell& cell) const {
    for (int a = 0; a < 3; ++a)
        if (cell[static_cast<std::size_t>(a)] < 0 || cell[static_cast<std::size_t>(a)] + 1 >= dims_[a])
            return false;
    const index::MissingCells* missing = missingOf(grid_.brickAt(cell[0] >> 3, cell[1] >> 3, cell[2] >> 3));
    return !missing || !(missing->cells[cell[2] & 7] >> ((cell[0] & 7) + 8 * (cell[1] & 7)) & 1);
}

BrickMasks BrickShapes::masksNearMissing(BrickIndex brick) const {
    const auto first = origin(brick);
    return makeMasks([&](const Cell& cell) { return isCellValid({first[0] + cell[0], first[1] + cell[1], first[2] + cell[2]}); });
}

} // namespace isoslider::extract
