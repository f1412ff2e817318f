#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/base/job_control.h"
#include "core/extract/live/brick_points.h"
#include "core/extract/sources/stored_samples.h"
#include "core/grid/normal_codec.h"
#include "core/index/index_reader.h"

namespace isoslider::extract {

/// The normals of an index of edges, which keeps them by point, behind a cache of decoded chunks. Used in turns.
class StoredNormals {
public:
    /// REQUIRES: hasNormalChunks() of the index. `reader` must outlive this. At most `cacheBytes` are kept.
    StoredNormals(const index::IndexReader& reader, std::uint64_t cacheBytes);

    /// Bricks whose normals lie together have numbers near each other.
    std::uint64_t orderOf(BrickIndex brick) const { return chunks_.orderOf(brick); }
    /// Where the normals of the i-th brick go: those of kPaddedPoints points.
    using Place = std::function<NormalCode*(std::size_t i)>;
    /// Normals of the points of each brick, those outside the box "no normal". On several threads; `placeOf` is called
    /// once for each brick. Cheapest in order. Adds to `stats` what was read. Errors: IoError, Corruption, Cancelled.
    Status read(std::span<const BrickIndex> bricks, const Place& placeOf, SlideStats& stats, const JobControl& job);
    void dropCaches() { chunks_.dropCaches(); }

private:
    StoredSamples<NormalCode> chunks_;
};

} // namespace isoslider::extract
