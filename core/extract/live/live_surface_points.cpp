// What bricks make their vertices from: replaced while pictures refer to it, and made ahead of need.

#include <utility>

#include "core/extract/live/live_surface.h"
#include "core/extract/live/stream_copy.h"

namespace isoslider::extract {

template <class Live>
void LiveSurface<Live>::putPoints(BrickSlot slot, BrickDraft<Live>& draft) {
    if (!draft.newPoints)
        return;
    Brick& brick = bricks_[slot.index()];
    if (isWatched_ && brick.hasPoints)
        draft.retired.push_back({{}, {}, {}, std::exchange(brick.points, {})});
    arenas_->points.resize(brick.points, pointLines_);
    streamCopy(arenas_->points.at(brick.points.begin), std::exchange(draft.newPoints, nullptr),
               pointLines_ * sizeof(PointLine));
    brick.pointsVersion = version_;
    brick.hasPoints = true;
}

template <class Live>
PointLine* LiveSurface<Live>::roomForNextPoints(BrickSlot slot) {
    Brick& brick = bricks_[slot.index()];
    arenas_->points.resize(brick.nextPoints, pointLines_);
    return arenas_->points.at(brick.nextPoints.begin);
}

template <class Live>
bool LiveSurface<Live>::takeNextPoints(BrickSlot slot, BrickDraft<Live>& draft) {
    if (!hasNextPoints(slot))
        return false;
    Brick& brick = bricks_[slot.index()];
    ArenaRun old = std::exchange(brick.points, std::exchange(brick.nextPoints, {}));
    if (isWatched_)
        draft.retired.push_back({{}, {}, {}, old});
    else
        arenas_->points.release(old);
    brick.pointsVersion = version_;
    return true;
}

#define ISO_INSTANTIATE(Live) \
    template void LiveSurface<Live>::putPoints(BrickSlot, BrickDraft<Live>&); \
    template PointLine* LiveSurface<Live>::roomForNextPoints(BrickSlot); \
    template bool LiveSurface<Live>::takeNextPoints(BrickSlot, BrickDraft<Live>&);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
