#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "core/base/result.h"
#include "core/extract/sample_block.h"
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
    /// Fills the block round a brick. REQUIRES: it is ready. Any thread.
    virtual void read(BrickIndex brick, SampleBlock<Sample>& block) const = 0;
    /// One sample, ready or not, at coordinates of the grid. Any thread, while none makes bricks ready.
    /// Adds to `bytesRead`. Errors: IoError, Corruption.
    virtual Result<Sample> sampleAt(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t& bytesRead) const = 0;
    /// Whether fetching ahead of need is of any use.
    virtual bool fetchesAhead() const { return false; }
    /// As prepare(), in a hurry to no one: fetches what the first of `bricks` miss, up to a part of the room.
    virtual Status fetch(std::span<const BrickIndex> /*bricks*/, SlideStats& /*stats*/,
                         std::stop_token /*stop*/) {
        return {};
    }
    /// Forgets what is kept: no brick is ready any more.
    virtual void dropCaches() {}
};

} // namespace isoslider::extract
