#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "core/base/result.h"
#include "core/extract/surface_frame.h"
#include "core/grid/brick_grid.h"
#include "core/grid/normal_codec.h"
#include "core/grid/scalar_key.h"

namespace isoslider::extract {

/// An edge that becomes active, with all that interpolation needs. `scalar1` is at the lower grid
/// point, where the edge starts; the edge is local to `brick`. Live is float or double.
template <class Live>
struct ActivatedEdge {
    Live scalar1, scalar2;
    BrickIndex brick;
    LocalEdge edge;
    NormalCode normal1, normal2;
};

struct DeactivatedEdge {
    BrickIndex brick;
    LocalEdge edge;
};

/// Net edge changes of one move: no edge appears twice. Bricks are cut into kPartitions runs of brick
/// numbers, so that producing and applying share nothing between threads and what is applied together
/// lies together; lists are per producing thread.
template <class Live>
class ChangeSet {
public:
    static constexpr unsigned kPartitions = 64;

    struct Lists {
        std::array<std::vector<ActivatedEdge<Live>>, kPartitions> activated;
        std::array<std::vector<DeactivatedEdge>, kPartitions> deactivated;
        std::array<std::vector<BrickIndex>, kPartitions> cleared; ///< bricks all of whose edges leave; no other change names them
    };

    explicit ChangeSet(std::uint64_t brickCount)
        : scale_(((std::uint64_t{kPartitions} << 32) - 1) / (brickCount > 0 ? brickCount : 1)) {}

    unsigned partitionOf(BrickIndex brick) const { return static_cast<unsigned>(brick * scale_ >> 32); }

    Lists& local() { return lists_.local(); }
    template <class Visit>
    void forEachList(const Visit& visit) const {
        for (const Lists& lists : lists_)
            visit(lists);
    }
    void clear() {
        for (Lists& lists : lists_)
            for (unsigned p = 0; p < kPartitions; ++p) {
                lists.activated[p].clear();
                lists.deactivated[p].clear();
                lists.cleared[p].clear();
            }
    }
    /// Gives memory back that an unusually large move has left.
    void trim() { lists_.clear(); }

private:
    std::uint64_t scale_; ///< partitions per brick, 32 bits of fraction
    tbb::enumerable_thread_specific<Lists> lists_;
};

/// The seam that everything hangs on: what changes between two isovalues. Edge blocks are one source;
/// bricks of samples, on disk or in memory, are others. ActiveSurface knows none of them.
template <class Live>
class ChangeSource {
public:
    virtual ~ChangeSource() = default;

    /// Fills `changes` with the net edge changes from threshold `from` to `to`, and `stats` with what
    /// was read (edgesTouched, bytesRead, walk). O(log N + K). Errors: IoError, Corruption, Cancelled.
    virtual Status collect(KeyThreshold from, KeyThreshold to, ChangeSet<Live>& changes, SlideStats& stats,
                           std::stop_token stop) = 0;

    /// Edge entries that collect() would look at, about; decides between patching and building anew.
    virtual std::uint64_t estimate(KeyThreshold from, KeyThreshold to) const = 0;

    /// The next move may be from `from` to `to`: what it needs may be fetched in the background until then.
    /// Returns at once.
    virtual void foresee(KeyThreshold /*from*/, KeyThreshold /*to*/) {}
    /// Waits until what is foreseen has been fetched.
    virtual void settle() {}
    /// Forgets what is kept of what has been read, after settle().
    virtual void dropCaches() {}

    /// The threshold of an isovalue in the volume's scalar type.
    virtual KeyThreshold threshold(double isovalue) const = 0;
    /// Thresholds below and above every sample, where the surface is empty.
    virtual KeyThreshold lowest() const = 0;
    virtual KeyThreshold highest() const = 0;
};

} // namespace isoslider::extract
