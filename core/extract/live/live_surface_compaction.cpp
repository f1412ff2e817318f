// Memory follows the surface where it shrinks.

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/extract/live/live_surface.h"

namespace isoslider::extract {
namespace {

// The bytes that were moved; none where the run may stay, or there is no room for it.
template <class Arena>
std::uint64_t moveRunDown(Arena& arena, ArenaRun& run, ArenaRun& left) {
    if (!arena.reachesAbove(run))
        return 0;
    const auto moved = arena.takeBelow(run);
    if (!moved)
        return 0;
    const std::uint64_t bytes = run.capacity * sizeof(*arena.at(0));
    std::memcpy(arena.at(moved->begin), arena.at(run.begin), bytes);
    left = std::exchange(run, *moved);
    return bytes;
}

} // namespace

// Memory, here and on the card, follows the highest run: where much of what is below it stays free, the runs that lie
// highest move down, few at a move, so that none takes long; bricks that are made again
// meanwhile go below by themselves. Pictures keep what they are of: runs that were moved are given back as those of a
// brick that is made again. Not at once where the surface is not much smaller: a jump leaves room that the next one
// fills, and new memory costs as much as what is in it.
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
        if (!arenas_->isEvacuating()) // there was no room below, the last times
            return;
        nextToMove_ = 0;
    }
    moveRunsDown();
    arenas_->finishEvacuation();
}

template <class Live>
void LiveSurface<Live>::leave(RetiredRuns& runs) {
    if (isWatched_)
        retired_.add(version_, runs);
    else
        release(runs);
}

template <class Live>
void LiveSurface<Live>::moveRunsDown() {
    constexpr std::uint64_t kLeastAtOnce = std::uint64_t{2} << 20;
    const std::uint64_t most = std::max({kLeastAtOnce, slackBytes_ / 8, arenas_->usedBytes() / 32});
    std::uint64_t bytes = 0;
    for (; nextToMove_ < slotCount() && bytes < most; ++nextToMove_) {
        Brick& brick = bricks_[nextToMove_];
        bytes += sizeof(LiveBrickHead);
        if (!brick.isLive)
            continue;
        RetiredRuns left;
        const std::uint64_t ofVertices = moveRunDown(arenas_->vertices, brick.vertices, left.vertices);
        if (ofVertices > 0 && arenas_->hasGroups && brick.edgeVertices > 0) {
            auto* const groups = arenas_->template groupsFor<Live>(brick.vertices);
            const std::size_t count = groupCount(brick.edgeVertices);
            std::copy_n(arenas_->template groupsAt<Live>(left.vertices.begin), count, groups);
            bytes += count * sizeof *groups;
        }
        const std::uint64_t ofPoints = moveRunDown(arenas_->points, brick.points, left.points);
        const std::uint64_t moved = ofVertices + ofPoints + moveRunDown(arenas_->indices, brick.indices, left.indices) +
                                    moveRunDown(arenas_->inner, brick.inner, left.inner);
        if (moved == 0)
            continue;
        bytes += moved;
        if (ofPoints > 0)
            brick.pointsVersion = version_; // the card has others in their place
        show(BrickSlot(nextToMove_));
        leave(left);
    }
    if (nextToMove_ < slotCount() || !arenas_->points.isEvacuating())
        return;
    kept_.forEach([&](KeptPoints::Kept& kept) {
        if (bytes < most)
            bytes += moveDown(kept);
    });
}

template <class Live>
std::uint64_t LiveSurface<Live>::moveDown(KeptPoints::Kept& kept) {
    RetiredRuns left;
    const std::uint64_t bytes = moveRunDown(arenas_->points, kept.run, left.points);
    if (bytes > 0) {
        kept.version = version_;
        leave(left);
    }
    return bytes;
}

#define ISO_INSTANTIATE(Live) \
    template void LiveSurface<Live>::compact(); \
    template void LiveSurface<Live>::leave(RetiredRuns&); \
    template void LiveSurface<Live>::moveRunsDown(); \
    template std::uint64_t LiveSurface<Live>::moveDown(KeptPoints::Kept&);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
