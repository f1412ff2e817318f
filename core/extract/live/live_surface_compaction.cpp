// Memory follows the surface where it shrinks.

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/extract/live/live_surface.h"

namespace isoslider::extract {

// Memory, here and on the card, follows the highest run: where much of what is below it stays free, the runs that lie
// highest move down, a few megabytes at a move, so that none takes long; bricks that are made again meanwhile go below
// by themselves. Pictures keep what they are of: runs that were moved are given back as those of a brick that is made
// again. Not at once where the surface is not much smaller: a jump leaves room that the next one fills, and new memory
// costs as much as what is in it.
template <class Live>
void LiveSurface<Live>::compact() {
    if (hasCleared_)
        trim();
    if (!arenas_->isEvacuating()) {
        sparseMoves_ = arenas_->isSparse(3, 4) && arenas_->unusedBytes() > slackBytes_ ? sparseMoves_ + 1 : 0;
        if (sparseMoves_ == 0 || (sparseMoves_ < kSparseMoves && !arenas_->isSparse(1, kVerySparse)))
            return;
        sparseMoves_ = 0;
        arenas_->evacuateSparse(3, 4);
        nextToMove_ = 0;
    }
    moveRunsDown();
    arenas_->finishEvacuation();
}

template <class Live>
void LiveSurface<Live>::moveRunsDown() {
    constexpr std::uint64_t kBytesAtOnce = std::uint64_t{4} << 20;
    std::uint64_t bytes = 0;
    const auto moveDown = [&](auto& arena, ArenaRun& run, ArenaRun& left) {
        if (!arena.reachesAbove(run))
            return false;
        const auto moved = arena.takeBelow(run);
        if (!moved)
            return false;
        std::memcpy(arena.at(moved->begin), arena.at(run.begin), run.capacity * sizeof(*arena.at(0)));
        bytes += run.capacity * sizeof(*arena.at(0));
        left = std::exchange(run, *moved);
        return true;
    };
    const auto leave = [&](RetiredRuns& runs) {
        if (isWatched_)
            retired_.add(version_, runs);
        else
            release(runs);
    };
    for (; nextToMove_ < slotCount() && bytes < kBytesAtOnce; ++nextToMove_) {
        Brick& brick = bricks_[nextToMove_];
        bytes += sizeof(LiveBrickHead);
        if (!brick.isLive)
            continue;
        RetiredRuns left;
        const bool hasOtherVertices = moveDown(arenas_->vertices, brick.vertices, left.vertices);
        if (hasOtherVertices && arenas_->hasGroups && brick.edgeVertices > 0) {
            auto* const groups = arenas_->template groupsFor<Live>(brick.vertices);
            std::copy_n(arenas_->template groupsAt<Live>(left.vertices.begin), groupCount(brick.edgeVertices), groups);
        }
        const bool hasOtherIndices = moveDown(arenas_->indices, brick.indices, left.indices),
                   hasOtherInner = moveDown(arenas_->inner, brick.inner, left.inner),
                   hasOtherPoints = moveDown(arenas_->points, brick.points, left.points);
        if (!hasOtherVertices && !hasOtherIndices && !hasOtherInner && !hasOtherPoints)
            continue;
        if (hasOtherPoints)
            brick.pointsVersion = version_; // the card has others in their place
        show(BrickSlot(nextToMove_));
        leave(left);
    }
    if (nextToMove_ < slotCount() || !arenas_->points.isEvacuating())
        return;
    kept_.forEach([&](KeptPoints::Kept& kept) {
        if (RetiredRuns left; bytes < kBytesAtOnce && moveDown(arenas_->points, kept.run, left.points)) {
            kept.version = version_;
            leave(left);
        }
    });
}

#define ISO_INSTANTIATE(Live) \
    template void LiveSurface<Live>::compact(); \
    template void LiveSurface<Live>::moveRunsDown();
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
