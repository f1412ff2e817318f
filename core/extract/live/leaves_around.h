#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/extract/live/brick_leaves.h"
#include "core/extract/merged/merged_polygon.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::extract {

/// The leaves of a brick and of the cells that touch it, in the brick's coordinates from -1 to 8: what its merged cells
/// depend on. Only bricks with both signs matter beside it: the cells of others stand as cells of the grid.
class LeavesAround {
public:
    /// `leavesAt(step)`: a pointer to those of the brick a step away, (0, 0, 0) the brick itself; null for one that is
    /// not live. `above` must outlive the answers.
    template <class LeavesAt>
    void fill(const GridDims& dims, const std::array<std::int32_t, 3>& origin, const BitString& above,
              const LeavesAt& leavesAt) {
        above_ = &above;
        fillRows(leavesAt);
        std::array<int, 3> begin{}, end{};
        for (std::size_t a = 0; a < 3; ++a) {
            begin[a] = origin[a] > 0 ? -1 : 0;
            end[a] = static_cast<int>(std::min<std::int64_t>(kCellSide + 1, dims[a] - 1 - origin[a]));
        }
        if (std::max({begin[0], begin[1], begin[2]}) == 0 || std::min({end[0], end[1], end[2]}) <= kCellSide)
            takeOutBesideBox(begin, end);
    }

    // As MergedPolygon asks for them: points as in the brick, cells by their places here.
    static std::int64_t pointStride(std::size_t axis) { return kPointStride[axis]; }
    static std::int64_t cellStride(std::size_t axis) { return axis == 0 ? 1 : axis == 1 ? kSide : kSide * kSide; }
    static std::array<std::int32_t, 3> coordsOf(std::int64_t point) {
        return extract::coordsOf(ClosedPoint(static_cast<int>(point)));
    }
    static std::int64_t cellAt(std::int64_t point) {
        const auto c = coordsOf(point);
        return static_cast<std::int64_t>(placeOf(c[0], c[1], c[2]));
    }
    const BitString& above() const { return *above_; }
    bool isAboveAt(std::int64_t point) const { return above_->test(ClosedPoint(static_cast<int>(point))); }
    int levelAt(std::int64_t cell) const { return levels_[static_cast<std::size_t>(cell)]; }

private:
    static constexpr int kSide = kCellSide + 2;
    /// Where the next two cells begin that lie in one cell of side 2; of -1 and 8, that are by themselves, 0 and 9.
    static int nextPair(int at) { return at < 0 ? 0 : (at & ~1) + 2; }
    static std::size_t placeOf(int x, int y, int z) {
        return static_cast<std::size_t>(x + 1 + kSide * (y + 1 + kSide * (z + 1)));
    }

    // Rows at y and at the place after it are alike where both lie in one cell of side 2, and so are planes: 36 of the
    // 100 are made.
    template <class LeavesAt>
    void fillRows(const LeavesAt& leavesAt) {
        const BrickLeaves none;
        std::array<const BrickLeaves*, 27> around; // those across a corner are not asked for
        const auto at = [&](int x, int y, int z) -> const BrickLeaves*& {
            return around[static_cast<std::size_t>(x + 1 + 3 * (y + 1) + 9 * (z + 1))];
        };
        const auto find = [&](const BrickStep& step) {
            const BrickLeaves* const leaves = leavesAt(step);
            at(step[0], step[1], step[2]) = leaves == nullptr ? &none : leaves;
        };
        find({0, 0, 0});
        forEachBrickStep(find);
        const auto stepOf = [](int place) { return place < 0 ? -1 : place < kCellSide ? 0 : 1; };
        constexpr int kIn = kCellSide - 1;
        for (int z = -1; z <= kCellSide; z = nextPair(z))
            for (int y = -1; y <= kCellSide; y = nextPair(y)) {
                const int stepY = stepOf(y), stepZ = stepOf(z), inY = y & kIn, inZ = z & kIn;
                const std::uint64_t levels = at(0, stepY, stepZ)->levelsOfRow(inY, inZ);
                // Beside a brick across an edge lies one that has no more than a point in common with this one.
                const bool isBesideEdge = stepY != 0 && stepZ != 0;
                const int before = isBesideEdge ? kNoLevel : at(-1, stepY, stepZ)->levelOf(kIn, inY, inZ);
                const int behind = isBesideEdge ? kNoLevel : at(1, stepY, stepZ)->levelOf(0, inY, inZ);
                const int endY = std::min(nextPair(y), kCellSide + 1), endZ = std::min(nextPair(z), kCellSide + 1);
                for (int atZ = z; atZ < endZ; ++atZ)
                    for (int atY = y; atY < endY; ++atY) {
                        std::int8_t* const row = levels_.data() + placeOf(0, atY, atZ);
                        row[-1] = static_cast<std::int8_t>(before);
                        std::memcpy(row, &levels, sizeof levels);
                        row[kCellSide] = static_cast<std::int8_t>(behind);
                    }
            }
    }

    void takeOutBesideBox(const std::array<int, 3>& begin, const std::array<int, 3>& end) {
        for (int z = -1; z <= kCellSide; ++z) {
            const bool isOutsideZ = z < begin[2] || z >= end[2];
            for (int y = -1; y <= kCellSide; ++y) {
                std::int8_t* const row = levels_.data() + placeOf(-1, y, z);
                if (isOutsideZ || y < begin[1] || y >= end[1]) {
                    std::fill_n(row, kSide, static_cast<std::int8_t>(kNoLevel));
                    continue;
                }
                if (begin[0] == 0)
                    row[0] = kNoLevel;
                for (int x = end[0]; x <= kCellSide; ++x)
                    row[x + 1] = kNoLevel;
            }
        }
    }

    const BitString* above_ = nullptr;
    std::array<std::int8_t, kSide * kSide * kSide> levels_{};
};

} // namespace isoslider::extract
