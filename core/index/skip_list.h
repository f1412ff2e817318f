#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/scalar_key.h"
#include "core/index/format/index_format.h"

namespace isoslider::index {

/// A stretch of a walk: the points with keys in [beginKey, endKey), taken from one level. Above level
/// 0 the stretch is made of whole blocks, at level 0 of pages that may stick out at its ends.
struct WalkSegment {
    SkipLevel level;
    std::uint64_t beginKey = 0;
    std::uint64_t endKey = 0;
    std::size_t firstPage = 0;
    std::size_t pageEnd = 0;
    std::uint64_t firstBlock = 0;
    std::uint64_t blocks = 0; ///< 0 at level 0, where blocks are counted when pages are decoded
};

/// Pages that cannot be read, by level and number.
using DamagedPages = std::set<std::pair<SkipLevel, std::size_t>>;

/// The walk between two positions on the isovalue axis (PAPER 2.1): up to the highest level whose
/// blocks lie between them, along it, and down again. Blocks of a level are unions of blocks below,
/// so taking at every level all blocks that fit into what is left touches the fewest edges.
///
/// The segments cover [lower, upper) once and come in key order. A walk in the other direction takes
/// the same segments backwards. O(levels * log N), and as much again for each damaged page.
///
/// A block with a damaged page is left to the levels below, which hold all that it holds. Below level 0 there is
/// nothing: a segment of it contains damaged pages where no whole block covers them.
class SkipList {
public:
    /// `levels` must outlive the list.
    explicit SkipList(std::span<const LevelDirectory> levels) : levels_(levels) {}

    std::vector<WalkSegment> plan(KeyThreshold lower, KeyThreshold upper, const DamagedPages& damaged = {}) const;

    /// Edge entries on the pages of plan(lower, upper, damaged), those of half-covered pages in proportion.
    std::uint64_t estimateEdges(KeyThreshold lower, KeyThreshold upper, const DamagedPages& damaged = {}) const;
    /// Whether that plan contains a damaged page.
    bool isBlocked(KeyThreshold lower, KeyThreshold upper, const DamagedPages& damaged) const;

    SkipLevel top() const { return SkipLevel(levels_.size() - 1); }
    const PageEntry& page(SkipLevel level, std::size_t index) const { return levels_[level.index()].pages[index]; }
    /// REQUIRES: not level 0.
    const BlockEntry& block(SkipLevel level, std::uint64_t index) const { return levels_[level.index()].blocks[index]; }

private:
    struct Plan {
        const DamagedPages& damaged;
        std::vector<WalkSegment> segments;
    };
    void cover(SkipLevel level, std::uint64_t begin, std::uint64_t end, Plan& plan) const;

    std::span<const LevelDirectory> levels_;
};

} // namespace isoslider::index
