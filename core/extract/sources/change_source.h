#pragma once

#include <cstdint>
#include <optional>

#include "core/base/job_control.h"
#include "core/extract/live/live_surface.h"
#include "core/extract/merged/merge_bound.h"
#include "core/grid/brick_box.h"
#include "core/grid/scalar_key.h"

namespace isoslider::extract {

/// The seam that everything hangs on: what changes between two isovalues. Which bricks change and what is
/// in those is the source's business; the live surface knows nothing of skip lists and samples.
template <class Live>
class ChangeSource {
public:
    struct Move {
        KeyThreshold from, to;
        double isovalue; ///< that `to` is the threshold of
    };

    virtual ~ChangeSource() = default;

    /// Brings `surface` from one threshold to the other: adds, replaces and removes bricks. Fills `stats` with what
    /// was read and what changed. Tells `job` how far it is by the bricks that are done. A move from lowest() or
    /// highest() starts with an empty surface, whatever was before. O(log N + K). Errors: IoError, Corruption,
    /// Cancelled; the surface must be cleared then.
    virtual Status move(const Move& move, LiveSurface<Live>& surface, SlideStats& stats, const JobControl& job) = 0;

    /// From the next move on, cells are merged within the bound; that move makes all live bricks again.
    virtual void setMergeBound(const MergeBound&) {}

    /// From the next move on, the surface has bricks in the region only; none: all. That move looks at all active ones.
    virtual void setRegion(const std::optional<BrickBox>&) {}

    /// Entries that move() would look at, about; decides between patching and building again.
    virtual std::uint64_t estimate(KeyThreshold from, KeyThreshold to) const = 0;

    /// Whether a part of the index that is known to be damaged lies on the way, so that move() fails.
    virtual bool isBlocked(KeyThreshold /*from*/, KeyThreshold /*to*/) const { return false; }
    /// How many parts were found damaged so far that another way may go around: where a failed move has added some, the
    /// estimates are others now.
    virtual std::uint64_t partsLost() const { return 0; }

    /// The next move may be from `from` to `to`: what it needs may be fetched in the background until then.
    /// Returns at once.
    virtual void prefetch(KeyThreshold /*from*/, KeyThreshold /*to*/) {}
    /// Whether more skip levels are built in the background as moves come to need them.
    virtual void setBuildsLevels(bool /*builds*/) {}
    /// Waits until what prefetch() asked for has been read, and those levels are built.
    virtual void waitForPrefetch() {}
    /// Bytes of what is kept of lists, without samples.
    virtual std::uint64_t listBytes() const { return 0; }
    /// Forgets what is kept of what has been read, after waitForPrefetch().
    virtual void dropCaches() {}

    /// The threshold of an isovalue in the volume's scalar type.
    virtual KeyThreshold threshold(double isovalue) const = 0;
    /// Thresholds below and above every sample, where the surface is empty.
    virtual KeyThreshold lowest() const = 0;
    virtual KeyThreshold highest() const = 0;
};

} // namespace isoslider::extract
