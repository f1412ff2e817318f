#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/extract/live/brick_bits.h"
#include "core/extract/live/brick_slot.h"
#include "core/extract/live/pair_cells.h"
#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// Which merged cells of a brick are usable (merged/leaf_levels.h): the leaves are the largest. A cell that is usable
/// has usable halves. Bricks that have no samples above and below the isovalue have none.
struct BrickLeaves {
    std::uint64_t level1 = 0; ///< bit x + 4 y + 16 z
    std::uint8_t level2 = 0; ///< bit x + 2 y + 4 z
    bool level3 = false;

    bool hasMerged() const { return level1 != 0; }
    /// Of the leaf that holds a cell of the brick.
    int levelOf(int x, int y, int z) const {
        if (level3)
            return 3;
        if (level2 >> (x / 4 + 2 * (y / 4) + 4 * (z / 4)) & 1)
            return 2;
        return static_cast<int>(level1 >> (x / 2 + 4 * (y / 2) + 16 * (z / 2)) & 1);
    }
    friend bool operator==(const BrickLeaves&, const BrickLeaves&) = default;
};

/// One merged cell with all its halves; `number` as its bit in BrickLeaves, 0 at level 3.
inline BrickLeaves leafBits(int level, unsigned number) {
    if (level == 1)
        return {std::uint64_t{1} << number, 0, false};
    if (level == 2)
        return {pairsOfFour(number), static_cast<std::uint8_t>(1u << number), false};
    return {~std::uint64_t{0}, 0xff, true};
}

/// The cells of side 2 in a merged cell, which starts at `first`.
inline std::uint64_t pairsOfLeaf(ClosedPoint first, int level) {
    if (level == 3)
        return ~std::uint64_t{0};
    const auto at = coordsOf(first);
    return (level == 1 ? 1 : pairsOfFour(0)) << (at[0] / 2 + 4 * (at[1] / 2) + 16 * (at[2] / 2));
}

/// The cells of a brick whose leaf has another level.
inline BitString cellsOfOtherLevel(const BrickLeaves& before, const BrickLeaves& now) {
    std::uint64_t others = before.level1 ^ now.level1; // cells of side 2
    for (unsigned i = 0; i < 8; ++i)
        if ((before.level2 ^ now.level2) >> i & 1)
            others |= leafBits(2, i).level1;
    if (before.level3 != now.level3)
        others = ~std::uint64_t{0};
    return cellsOfPairs(others);
}

/// A step to a brick beside, along one axis or two: -1, 0 or 1 each.
using BrickStep = std::array<int, 3>;

/// To the 18 bricks that share more than a point with a brick.
inline constexpr std::array<BrickStep, 18> kBrickSteps = [] {
    std::array<BrickStep, 18> steps{};
    std::size_t count = 0;
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                if ((x == 0 || y == 0 || z == 0) && (x != 0 || y != 0 || z != 0))
                    steps[count++] = {x, y, z};
    return steps;
}();

/// The cells of a brick that touch the brick a step away.
inline BrickLeaves cellsBeside(const BrickStep& step) {
    BrickLeaves beside;
    const auto isBeside = [&](const std::array<int, 3>& cell, int last) {
        for (std::size_t a = 0; a < 3; ++a)
            if ((step[a] < 0 && cell[a] != 0) || (step[a] > 0 && cell[a] != last))
                return false;
        return true;
    };
    for (int i = 0; i < 64; ++i)
        if (isBeside({i % 4, i / 4 % 4, i / 16}, 3))
            beside.level1 |= std::uint64_t{1} << i;
    for (int i = 0; i < 8; ++i)
        if (isBeside({i % 2, i / 2 % 2, i / 4}, 1))
            beside.level2 = static_cast<std::uint8_t>(beside.level2 | 1u << i);
    beside.level3 = true;
    return beside;
}

/// Whether leaves among the given cells differ.
inline bool leavesDiffer(const BrickLeaves& a, const BrickLeaves& b, const BrickLeaves& among) {
    return ((a.level1 ^ b.level1) & among.level1) != 0 || ((a.level2 ^ b.level2) & among.level2) != 0 ||
           a.level3 != b.level3;
}

/// The live brick a step from the one at `at`, if there is one. `slotOf(brick)`: one more than its slot, 0 for none.
template <class SlotOf>
std::optional<BrickSlot> slotBeside(const BrickGrid& grid, std::array<std::int64_t, 3> at, const BrickStep& step,
                                    const SlotOf& slotOf) {
    for (std::size_t a = 0; a < 3; ++a) {
        at[a] += step[a];
        if (at[a] < 0 || at[a] >= grid.bricks()[a])
            return std::nullopt;
    }
    const std::uint32_t slot = slotOf(grid.brickAt(at[0], at[1], at[2]));
    return slot == 0 ? std::nullopt : std::optional(BrickSlot(slot - 1));
}

/// Calls visit(slot) for the live bricks that touch leaves of a brick which are others now.
template <class SlotOf, class Visit>
void forEachBesideChanged(const BrickGrid& grid, const std::array<std::int64_t, 3>& at, const BrickLeaves& before,
                          const BrickLeaves& now, const SlotOf& slotOf, const Visit& visit) {
    static const auto kBeside = [] {
        std::vector<std::pair<BrickStep, BrickLeaves>> cells;
        for (const BrickStep& step : kBrickSteps)
            cells.emplace_back(step, cellsBeside(step));
        return cells;
    }();
    for (const auto& [step, cells] : kBeside)
        if (leavesDiffer(before, now, cells))
            if (const auto other = slotBeside(grid, at, step, slotOf))
                visit(*other);
}

} // namespace isoslider::extract
