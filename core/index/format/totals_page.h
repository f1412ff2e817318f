#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/grid/brick_grid.h"

namespace isoslider::index {

/// What the records of an interval of values add up to for one brick: so much does its count of active edges (of a list
/// of bricks: its own) rise by when the isovalue rises past all of them. Never 0.
struct BrickTotal {
    BrickIndex brick;
    std::int32_t count;
    friend bool operator==(const BrickTotal&, const BrickTotal&) = default;
};

/// What is larger than that is none of a brick, which has fewer edges.
inline constexpr std::int32_t kMostOfTotal = (1 << 30) - 1;

/// Sorts them by brick and adds up those of the same one; a sum beyond kMostOfTotal stays there. O(n log n).
void combineTotals(std::vector<BrickTotal>& totals);

/// No page holds more, so a damaged count never sizes a large allocation.
inline constexpr std::size_t kMaxPageTotals = 1u << 16;
/// Nor more bytes: a plane that does not compress is stored as it is.
constexpr std::size_t mostBytesOfTotals(std::size_t totals) {
    return sizeof(std::uint32_t) * 9 + totals * 2 * sizeof(std::uint32_t);
}

/// Encodes totals as FORMAT.md, "Lazy levels", states. O(totals), deterministic.
/// REQUIRES: 0 < totals.size() <= kMaxPageTotals, as combineTotals() leaves them.
std::vector<std::byte> encodeTotals(std::span<const BrickTotal> totals);

/// Decodes them, in the same order. Errors: Corruption, a brick outside the grid among them; `totals` are unspecified
/// then. `path` is only for the message. Reuses their memory.
Status decodeTotals(std::span<const std::byte> bytes, const BrickGrid& grid, std::vector<BrickTotal>& totals,
                    const std::string& path);

} // namespace isoslider::index
