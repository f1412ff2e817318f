#pragma once

#include "core/index/validation/fault_list.h"
#include "core/index/validation/part_sums.h"

namespace isoslider::index {

/// What level 0 of an index states of its volume, in sums.
struct Level0Sums {
    explicit Level0Sums(std::uint64_t bricks) : intervals(bricks) {}

    PartSums intervals; ///< intervalHash of each edge, or each brick, by the brick that it begins in
    bool isWhole = true; ///< all its pages could be read
    std::uint64_t distinctKeys = 0; ///< of records
};

/// An edge from its lower end on, or a brick (then `axis` is 0), and the keys at both ends: least first for bricks.
inline std::uint64_t intervalHash(std::uint64_t id, int axis, std::uint64_t lowerKey, std::uint64_t upperKey) {
    return mixHash(mixHash(mixHash(id, static_cast<std::uint64_t>(axis)), lowerKey), upperKey);
}

/// Reads all pages of all levels: order, counts, both ends of each edge or brick, each block against level 0. Fills
/// `sums`. Errors: IoError, Cancelled.
Status checkLevels(const IndexReader& reader, FaultList& faults, Level0Sums& sums, const JobControl& job);

} // namespace isoslider::index
