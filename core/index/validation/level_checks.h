#pragma once

#include "core/index/validation/fault_list.h"
#include "core/index/validation/part_sums.h"

namespace isoslider::index {

/// What level 0 of an index states of its volume, in sums.
struct Level0Sums {
    explicit Level0Sums(std::uint64_t bricks) : intervals(bricks) {}

    PartSums
        intervals; ///< intervalHash of each brick, or edgeEndHash of both ends of each edge, by the brick of either
    bool isWhole = true; ///< all its pages could be read
    std::uint64_t distinctKeys = 0; ///< of records
};

/// A brick by its first point, with its least and its greatest key.
inline std::uint64_t intervalHash(std::uint64_t id, std::uint64_t least, std::uint64_t greatest) {
    return mixHash(mixHash(id, least), greatest);
}

/// One end of an edge: the point's id and key, the edge's number there, and whether the key at the other end is
/// greater.
inline std::uint64_t edgeEndHash(std::uint64_t id, std::uint64_t key, int edge, bool rises) {
    return mixHash(mixHash(id, static_cast<std::uint64_t>(2 * edge + (rises ? 1 : 0))), key);
}

/// Reads all pages of all levels: order, counts, both ends of each edge or brick, each block against level 0. Fills
/// `sums`. Errors: IoError, Cancelled.
Status checkLevels(const IndexReader& reader, FaultList& faults, Level0Sums& sums, const JobControl& job);

} // namespace isoslider::index
