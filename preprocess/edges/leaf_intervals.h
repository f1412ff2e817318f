#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/extract/live/brick_leaves.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/sources/sample_kernels.h"
#include "core/grid/scalar_key.h"

namespace isoslider::preprocess {

/// Thresholds in (after, until]: between crossing a grid point with the one key upwards and crossing one with the
/// other.
template <class Key>
struct KeyInterval {
    Key after = 0, until = 0;
};

/// At which thresholds the merged cells of one brick are leaves that the surface passes through. PAPER 2.2 and 3.1:
/// merges and splits.
///
/// Which cells merge depends on samples of the brick alone and changes only where the threshold crosses one of them. So
/// the brick is swept through its own values once, as the live surface would go through it: O(values * active edges).
template <class Key>
class LeafIntervals {
public:
    bool isEmpty() const { return intervals_.empty(); }
    std::size_t count() const { return intervals_.size(); }
    /// Of the cell of side 2^level that holds the brick's cell (x, y, z); ascending, disjoint. REQUIRES: 1 <= level
    /// <= 3.
    std::span<const KeyInterval<Key>> of(int level, int x, int y, int z) const {
        return ofNumber(numberOf(level, x, y, z));
    }
    /// Calls visit(level, x, y, z, interval): the first cell of the brick in the merged one.
    template <class Visit>
    void forEach(const Visit& visit) const {
        for (int level = 1; level <= 3; ++level)
            for (int z = 0; z < 8; z += 1 << level)
                for (int y = 0; y < 8; y += 1 << level)
                    for (int x = 0; x < 8; x += 1 << level)
                        for (const KeyInterval<Key>& interval : of(level, x, y, z))
                            visit(level, x, y, z, interval);
    }

    /// `samples`: kPaddedPoints of the brick, those that do not exist or are missing repeat one that does; 64-byte
    /// aligned. `masks`: of its cells and their edges.
    template <class Sample>
    void find(const extract::StoredSample<Sample>* samples, const extract::BrickMasks& masks,
              const extract::MergeBound& bound);

private:
    static constexpr std::size_t kCells = 64 + 8 + 1; ///< of levels 1, 2 and 3
    static std::size_t numberOf(int level, int x, int y, int z) {
        return static_cast<std::size_t>(level == 1   ? x / 2 + 4 * (y / 2) + 16 * (z / 2)
                                        : level == 2 ? 64 + x / 4 + 2 * (y / 4) + 4 * (z / 4)
                                                     : 72);
    }
    std::span<const KeyInterval<Key>> ofNumber(std::size_t number) const {
        if (intervals_.empty())
            return {};
        return {intervals_.data() + begins_[number], begins_[number + 1] - begins_[number]};
    }

    std::array<std::uint32_t, kCells + 1> begins_{}; ///< by cell, into the intervals
    std::vector<KeyInterval<Key>> intervals_;
};

} // namespace isoslider::preprocess
