#include "core/extract/live/brick_shapes.h"

#include <algorithm>

namespace isoslider::extract {
namespace {

/// Which cells around a brick are valid, local coordinates -1 to 8: bit x + 1 of word [z + 1][y + 1].
constexpr int kAround = kCellSide + 2;
using ValidCells = std::array<std::array<std::uint16_t, kAround>, kAround>;

/// Nine bits of points that lie in one row, from the point (0, y, z) on.
void setRow(BitString& bits, int y, int z, unsigned row) {
    const unsigned first = closedPoint(0, y, z).number();
    bits.words[first >> 6] |= std::uint64_t{row} << (first & 63);
    if ((first & 63) + kPointSide > 64)
        bits.words[(first >> 6) + 1] |= std::uint64_t{row} >> (64 - (first & 63));
}

/// The edges of one axis that start in a row of points, from the cells around them in the order of their places.
struct RowOfEdges {
    unsigned edges = 0, owned = 0, seen = 0;

    /// `valid`: by point, whether this cell is; `inBrick`: whether it is one of the brick.
    void add(unsigned valid, unsigned inBrick) {
        edges |= valid & inBrick;
        owned |= valid & inBrick & ~seen;
        seen |= valid;
    }
};

BrickMasks makeMasks(const ValidCells& valid) {
    constexpr unsigned kPoints = (1u << kPointSide) - 1, kOwnCells = (1u << kCellSide) - 1,
                       kCellsBefore = kOwnCells << 1;
    BrickMasks masks;
    for (int z = 0; z < kPointSide; ++z)
        for (int y = 0; y < kPointSide; ++y) {
            // Row (j, k) of cells is that at y - 1 + j, z - 1 + k. At point x it has the cells x - 1 and x.
            const auto row = [&](int j, int k) {
                return unsigned{valid[static_cast<std::size_t>(z + k)][static_cast<std::size_t>(y + j)]};
            };
            const auto before = [&](int j, int k) { return row(j, k) & kPoints; };
            const auto at = [&](int j, int k) { return row(j, k) >> 1 & kPoints; };
            const auto isOwn = [](int place) { return place >= 0 && place < kCellSide; };
            const bool ownRow[2] = {isOwn(y - 1), isOwn(y)}, ownPlane[2] = {isOwn(z - 1), isOwn(z)};
            if (ownRow[1] && ownPlane[1])
                setRow(masks.cells, y, z, at(1, 1) & kOwnCells);
            RowOfEdges alongX, alongY, alongZ;
            for (int k = 0; k < 2; ++k)
                for (int j = 0; j < 2; ++j)
                    alongX.add(at(j, k) & kOwnCells, ownRow[j] && ownPlane[k] ? kOwnCells : 0);
            if (ownRow[1]) {
                for (int k = 0; k < 2; ++k)
                    alongY.add(before(1, k), ownPlane[k] ? kCellsBefore : 0);
                for (int k = 0; k < 2; ++k)
                    alongY.add(at(1, k), ownPlane[k] ? kOwnCells : 0);
            }
            if (ownPlane[1])
                for (int j = 0; j < 2; ++j) {
                    alongZ.add(before(j, 1), ownRow[j] ? kCellsBefore : 0);
                    alongZ.add(at(j, 1), ownRow[j] ? kOwnCells : 0);
                }
            const RowOfEdges* const rows[3] = {&alongX, &alongY, &alongZ};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                setRow(masks.edges[axis], y, z, rows[axis]->edges);
                setRow(masks.owned[axis], y, z, rows[axis]->owned);
            }
        }
    return masks;
}

} // namespace

BrickShapes::BrickShapes(const GridDims& dims, const std::vector<index::MissingCells>& missing)
    : dims_(dims), grid_(dims), missing_(missing), byPlace_(64) {
    for (unsigned place = 0; place < 64; ++place) {
        // The brick before the last may border on one without cells.
        std::array<std::int64_t, 3> begin, end; // cells in the box, in coordinates of the brick
        for (int a = 0; a < 3; ++a) {
            const std::int64_t lastOrigin = (grid_.bricks()[a] - 1) * kCellSide;
            begin[static_cast<std::size_t>(a)] = place >> a & 1 ? 0 : -1;
            end[static_cast<std::size_t>(a)] = place >> (a + 3) & 1 ? dims[a] - 1 - lastOrigin : kPointSide;
        }
        ValidCells valid{};
        for (std::int64_t z = begin[2]; z < end[2]; ++z)
            for (std::int64_t y = begin[1]; y < end[1]; ++y)
                for (std::int64_t x = begin[0]; x < end[0]; ++x)
                    valid[static_cast<std::size_t>(z + 1)][static_cast<std::size_t>(y + 1)] |=
                        static_cast<std::uint16_t>(1u << (x + 1));
        byPlace_[place] = makeMasks(valid);
    }
    if (missing.empty())
        return;
    isNearMissing_.resize(grid_.brickCount());
    for (const index::MissingCells& cells : missing)
        forEachAround(cells.brick, [&](BrickIndex brick, const auto&) { isNearMissing_[brick.index()] = true; });
}

// Calls visit(brick, {dx, dy, dz}) for a brick and those that touch it.
template <class Visit>
void BrickShapes::forEachAround(BrickIndex brick, const Visit& visit) const {
    const auto c = grid_.brickCoords(brick);
    for (std::int64_t z = std::max<std::int64_t>(0, c[2] - 1); z <= std::min(grid_.bricks()[2] - 1, c[2] + 1); ++z)
        for (std::int64_t y = std::max<std::int64_t>(0, c[1] - 1); y <= std::min(grid_.bricks()[1] - 1, c[1] + 1); ++y)
            for (std::int64_t x = std::max<std::int64_t>(0, c[0] - 1); x <= std::min(grid_.bricks()[0] - 1, c[0] + 1);
                 ++x)
                visit(grid_.brickAt(x, y, z), std::array<std::int64_t, 3>{x - c[0], y - c[1], z - c[2]});
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

BrickMasks BrickShapes::masksNearMissing(BrickIndex brick) const {
    const auto first = origin(brick);
    std::array<std::int64_t, 3> begin, end; // cells in the box, in coordinates of the brick
    for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        begin[i] = first[i] > 0 ? -1 : 0;
        end[i] = std::min<std::int64_t>(kPointSide, dims_[a] - 1 - first[i]);
    }
    ValidCells valid{};
    forEachAround(brick, [&](BrickIndex around, const std::array<std::int64_t, 3>& step) {
        const index::MissingCells* const missing = missingOf(around);
        const auto from = [&](std::size_t a) { return std::max(begin[a], kCellSide * step[a]); };
        const auto to = [&](std::size_t a) { return std::min(end[a], kCellSide * (step[a] + 1)); };
        for (std::int64_t z = from(2); z < to(2); ++z)
            for (std::int64_t y = from(1); y < to(1); ++y)
                for (std::int64_t x = from(0); x < to(0); ++x)
                    if (!missing || !(missing->cells[z & 7] >> ((x & 7) + 8 * (y & 7)) & 1))
                        valid[static_cast<std::size_t>(z + 1)][static_cast<std::size_t>(y + 1)] |=
                            static_cast<std::uint16_t>(1u << (x + 1));
    });
    return makeMasks(valid);
}

} // namespace isoslider::extract
