#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/extract/live/brick_leaves.h"
#include "core/extract/merged/merged_polygon.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::extract {

/// The leaves of a brick and of the cells that touch it, in the brick's coordinates from -1 to 8: what its merged cells
/// depend on. Only bricks with both signs matter beside it: the cells of others stand as cells of the grid.
class LeavesAround {
public:
    /// `leavesAt(step)`: a pointer to those of the brick a step away, which has cells in the box, (0, 0, 0) the brick
    /// itself; null for one that is not live. They and `above` must outlive the answers.
    template <class LeavesAt>
    void fill(const GridDims& dims, const std::array<std::int32_t, 3>& origin, const BitString& above,
              const LeavesAt& leavesAt) {
        static constexpr BrickLeaves kNone;
        above_ = &above;
        isCut_ = false;
        bool isAtBorder = false;
        for (std::size_t a = 0; a < 3; ++a) {
            end_[a] = static_cast<int>(std::min<std::int64_t>(kCellSide + 1, dims[a] - 1 - origin[a]));
            isCut_ = isCut_ || end_[a] < kCellSide;
            isAtBorder = isAtBorder || origin[a] == 0 || end_[a] <= kCellSide;
        }
        const auto isOutside = [&](const BrickStep& step) {
            for (std::size_t a = 0; a < 3; ++a)
                if ((step[a] < 0 && origin[a] == 0) || (step[a] > 0 && end_[a] <= kCellSide))
                    return true;
            return false;
        };
        const auto orNone = [](const BrickLeaves* leaves) { return leaves == nullptr ? &kNone : leaves; };
        around_[numberOf({0, 0, 0})] = orNone(leavesAt({0, 0, 0}));
        for (const BrickStep& step : kBrickSteps)
            around_[numberOf(step)] = isAtBorder && isOutside(step) ? nullptr : orNone(leavesAt(step));
        findUnmergedPairs();
    }

    // As MergedPolygon asks for them: points as in the brick, cells by their places here.
    static std::int64_t pointStride(std::size_t axis) { return kPointStride[axis]; }
    static std::int64_t cellStride(std::size_t axis) { return axis == 0 ? 1 : axis == 1 ? kSide : kSide * kSide; }
    static std::array<std::int32_t, 3> coordsOf(std::int64_t point) {
        const auto& at = kPoints[static_cast<std::size_t>(point)].at;
        return {at[0], at[1], at[2]};
    }
    static std::int64_t cellAt(std::int64_t point) { return kPoints[static_cast<std::size_t>(point)].cell; }
    const BitString& above() const { return *above_; }
    bool isAboveAt(std::int64_t point) const { return above_->test(ClosedPoint(static_cast<int>(point))); }
    int levelAt(std::int64_t cell) const {
        const Place& place = kPlaces[static_cast<std::size_t>(cell)];
        const BrickLeaves* const leaves = around_[place.brick];
        if (leaves == nullptr ||
            (isCut_ && (place.at[0] >= end_[0] || place.at[1] >= end_[1] || place.at[2] >= end_[2])))
            return kNoLevel;
        if (leaves->level3)
            return 3;
        if (leaves->level2 >> place.inLevel2 & 1)
            return 2;
        return static_cast<int>(leaves->level1 >> place.inLevel1 & 1);
    }

    /// Of a cell of side 2 at x, y, z = 0 to 3 and the 26 around it, in the box: which are not merged. Bit
    /// beside(dx, dy, dz) for the one a step away; those across a corner hold anything.
    std::uint64_t unmergedAround(int x, int y, int z) const {
        constexpr std::uint64_t kThreeRows = (1u << (2 * kPairs + 3)) - 1;
        const auto shift = static_cast<unsigned>(x + kPairs * y);
        const std::size_t plane = static_cast<std::size_t>(z);
        return (unmerged_[plane] >> shift & kThreeRows) | (unmerged_[plane + 1] >> shift & kThreeRows) << kPlaneBits |
               (unmerged_[plane + 2] >> shift & kThreeRows) << (2 * kPlaneBits);
    }
    static constexpr unsigned beside(int dx, int dy, int dz) {
        return static_cast<unsigned>(dx + 1 + kPairs * (dy + 1)) + kPlaneBits * static_cast<unsigned>(dz + 1);
    }

private:
    static constexpr int kSide = kCellSide + 2;
    static constexpr int kPairs = kCellSide / 2 + 2;
    static constexpr unsigned kPlaneBits = 2 * kPairs + 3;
    static constexpr std::size_t placeOf(int x, int y, int z) {
        return static_cast<std::size_t>(x + 1 + kSide * (y + 1 + kSide * (z + 1)));
    }
    static constexpr std::size_t numberOf(const BrickStep& step) {
        return static_cast<std::size_t>(step[0] + 1 + 3 * (step[1] + 1) + 9 * (step[2] + 1));
    }

    /// Where a cell is: in which brick, and which bits of its leaves are those that hold it.
    struct Place {
        std::array<std::int8_t, 3> at;
        std::uint8_t brick, inLevel1, inLevel2;
    };
    static const std::array<Place, kSide * kSide * kSide> kPlaces;
    struct Point {
        std::array<std::int8_t, 3> at;
        std::uint16_t cell; ///< the place of the cell that starts there
    };
    static const std::array<Point, kClosedPoints> kPoints;

    // Row by row, from bits x + 4 y + 16 z to bits x + 1 + kPairs * (y + 1) of plane z + 1.
    void findUnmergedPairs() {
        const auto unmergedOf = [&](int x, int y, int z) {
            const BrickLeaves* const leaves = around_[numberOf({x, y, z})];
            return leaves == nullptr ? 0 : ~leaves->level1;
        };
        const auto rowAt = [](std::uint64_t row, int y) { return (row & 15) << (1 + kPairs * (y + 1)); };
        const auto bitAt = [](std::uint64_t bit, int x, int y) { return (bit & 1) << (x + 1 + kPairs * (y + 1)); };
        for (int stepZ = -1; stepZ <= 1; ++stepZ) {
            const std::uint64_t here = unmergedOf(0, 0, stepZ), left = unmergedOf(-1, 0, stepZ),
                                right = unmergedOf(1, 0, stepZ), front = unmergedOf(0, -1, stepZ),
                                back = unmergedOf(0, 1, stepZ);
            for (int z = stepZ == -1 ? 3 : 0; z <= (stepZ == 1 ? 0 : 3); ++z) {
                std::uint64_t plane = rowAt(front >> (16 * z + 12), -1) | rowAt(back >> (16 * z), 4);
                for (int y = 0; y < 4; ++y) {
                    const int row = 16 * z + 4 * y;
                    plane |= rowAt(here >> row, y) | bitAt(left >> (row + 3), -1, y) | bitAt(right >> row, 4, y);
                }
                unmerged_[static_cast<std::size_t>(z + 1 + 4 * stepZ)] = plane;
            }
        }
        for (int z = 0; z < 4; ++z)
            unmerged_[static_cast<std::size_t>(z + 1)] |= bitAt(unmergedOf(-1, -1, 0) >> (16 * z + 15), -1, -1) |
                                                          bitAt(unmergedOf(1, -1, 0) >> (16 * z + 12), 4, -1) |
                                                          bitAt(unmergedOf(-1, 1, 0) >> (16 * z + 3), -1, 4) |
                                                          bitAt(unmergedOf(1, 1, 0) >> (16 * z), 4, 4);
        if (isCut_)
            takeOutBeyondBox();
    }

    void takeOutBeyondBox() {
        std::uint64_t inside = 0;
        for (int y = -1; y <= 4; ++y)
            for (int x = -1; x <= 4; ++x)
                inside |= std::uint64_t{2 * x < end_[0] && 2 * y < end_[1]} << (x + 1 + kPairs * (y + 1));
        for (int z = -1; z <= 4; ++z)
            unmerged_[static_cast<std::size_t>(z + 1)] &= 2 * z < end_[2] ? inside : 0;
    }

    const BitString* above_ = nullptr;
    std::array<const BrickLeaves*, 27> around_{}; ///< null: outside the box, or across a corner
    std::array<int, 3> end_{}; ///< of the cells in the box
    bool isCut_ = false; ///< the brick has cells outside
    std::array<std::uint64_t, kPairs> unmerged_{}; ///< by plane z + 1, bit x + 1 + kPairs * (y + 1)
};

inline constinit const std::array<LeavesAround::Place, LeavesAround::kSide* LeavesAround::kSide* LeavesAround::kSide>
    LeavesAround::kPlaces = [] {
        std::array<Place, kSide * kSide * kSide> places{};
        const auto stepOf = [](int at) { return at < 0 ? -1 : at < kCellSide ? 0 : 1; };
        for (int z = -1; z <= kCellSide; ++z)
            for (int y = -1; y <= kCellSide; ++y)
                for (int x = -1; x <= kCellSide; ++x) {
                    const int inX = x & (kCellSide - 1), inY = y & (kCellSide - 1), inZ = z & (kCellSide - 1);
                    places[placeOf(x, y, z)] = {
                        {static_cast<std::int8_t>(x), static_cast<std::int8_t>(y), static_cast<std::int8_t>(z)},
                        static_cast<std::uint8_t>(numberOf({stepOf(x), stepOf(y), stepOf(z)})),
                        static_cast<std::uint8_t>(inX / 2 + 4 * (inY / 2) + 16 * (inZ / 2)),
                        static_cast<std::uint8_t>(inX / 4 + 2 * (inY / 4) + 4 * (inZ / 4))};
                }
        return places;
    }();

inline constinit const std::array<LeavesAround::Point, kClosedPoints> LeavesAround::kPoints = [] {
    std::array<Point, kClosedPoints> points{};
    for (int p = 0; p < kClosedPoints; ++p) {
        const auto at = extract::coordsOf(ClosedPoint(p));
        points[static_cast<std::size_t>(p)] = {
            {static_cast<std::int8_t>(at[0]), static_cast<std::int8_t>(at[1]), static_cast<std::int8_t>(at[2])},
            static_cast<std::uint16_t>(placeOf(at[0], at[1], at[2]))};
    }
    return points;
}();

} // namespace isoslider::extract
