#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "core/index/validation/fault_list.h"
#include "core/index/validation/part_sums.h"

namespace isoslider::index {

/// The points that have records, and sums of hashes of their keys by brick. Any thread.
class PointKeySums {
public:
    explicit PointKeySums(std::uint64_t bricks)
        : keys_(bricks), words_(std::make_unique<std::atomic<std::uint64_t>[]>(wordCount(bricks))) {}

    static constexpr std::uint64_t wordCount(std::uint64_t bricks) { return bricks * (kBrickPoints / 64); }
    void add(std::uint64_t id, std::uint64_t key) {
        words_[id / 64].fetch_or(std::uint64_t{1} << id % 64, std::memory_order_relaxed);
        keys_.add(id / kBrickPoints, keyHash(id, key));
    }
    bool has(std::uint64_t id) const { return words_[id / 64].load(std::memory_order_relaxed) >> id % 64 & 1; }
    static std::uint64_t keyHash(std::uint64_t id, std::uint64_t key) { return mixHash(idHash(id), key); }
    const PartSums& keys() const { return keys_; }

private:
    PartSums keys_;
    std::unique_ptr<std::atomic<std::uint64_t>[]> words_; ///< a bit for each point
};

/// What level 0 of an index states of its volume, in sums.
struct Level0Sums {
    explicit Level0Sums(std::uint64_t bricks) : intervals(bricks) {}

    PartSums
        intervals; ///< intervalHash of each brick, or edgeEndHash of both ends of each edge, by the brick of either
    bool isWhole = true; ///< all its pages could be read
    std::uint64_t distinctKeys = 0; ///< of records
    /// Where cells are merged, edges do not follow from samples alone, but keys of points do. Null: not compared.
    std::unique_ptr<PointKeySums> pointKeys;
};

/// A brick by its first point, with its least and its greatest key.
inline std::uint64_t intervalHash(std::uint64_t id, std::uint64_t least, std::uint64_t greatest) {
    return mixHash(mixHash(idHash(id), least), greatest);
}

/// One end of an edge: the point's id and key, the edge's number there, and whether the key at the other end is
/// greater.
inline std::uint64_t edgeEndHash(std::uint64_t id, std::uint64_t key, int edge, bool rises) {
    return mixHash(mixHash(idHash(id), static_cast<std::uint64_t>(2 * edge + (rises ? 1 : 0))), key);
}

/// An edge, wherever its ends lie, by its lower point.
inline std::uint64_t edgeHash(std::uint64_t lowerId, int axis) {
    return mixHash(idHash(lowerId), static_cast<std::uint64_t>(axis));
}

/// Reads all pages of all levels: order, counts, both ends of each edge or brick, each block against level 0. Fills
/// `sums`. Errors: IoError, Cancelled.
Status checkLevels(const IndexReader& reader, FaultList& faults, Level0Sums& sums, const JobControl& job);

} // namespace isoslider::index
