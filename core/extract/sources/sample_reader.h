#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "core/base/result.h"
#include "core/extract/sources/sample_rows.h"
#include "core/extract/surface_frame.h"

namespace isoslider::extract {

/// Where bricks' samples come from: a volume in memory, or a store on disk behind a cache. Used in turns: one
/// thread makes bricks ready, then any number of threads read those.
template <class Sample>
class SampleReader {
public:
    virtual ~SampleReader() = default;

    /// Bricks whose samples lie together have numbers near each other.
    virtual std::uint64_t orderOf(BrickIndex brick) const = 0;
    /// Makes the first of `bricks` ready to be read, as many as there is room for; returns how many, at least
    /// one of those given. Others may no longer be ready then. Cheapest when `bricks` rise or fall in order.
    /// Adds to `stats` what was read. Errors: IoError, Corruption, Cancelled.
    virtual Result<std::size_t> prepare(std::span<const BrickIndex> bricks, SlideStats& stats,
                                        std::stop_token stop) = 0;
    /// Where a brick's samples and those around it lie. REQUIRES: the brick is ready; it stays so while they are read.
    /// Any thread.
    virtual SampleRows<Sample> rows(BrickIndex brick) const = 0;
    /// Whether the brick may be read now; it stays so until the next call of prepare(), fetch() or dropCaches(). Any
    /// thread.
    virtual bool isReady(BrickIndex /*brick*/) const { return true; }
    /// Reports that bricks were read without prepare(), so that they are kept as if they had been prepared.
    virtual void touch(std::span<const BrickIndex> /*bricks*/) {}
    /// Asks for the memory that rows() leads to. Any thread.
    virtual void prefetch(BrickIndex /*brick*/) const {}
    /// Whether fetching ahead of need is of any use.
    virtual bool fetchesAhead() const { return false; }
    /// As prepare(), but with low priority: fetches what the first of `bricks` miss, up to a part of the room.
    virtual Status fetch(std::span<const BrickIndex> /*bricks*/, SlideStats& /*stats*/, std::stop_token /*stop*/) {
        return {};
    }
    /// Forgets what is kept: no brick is ready any more.
    virtual void dropCaches() {}
};

} // namespace isoslider::extract
