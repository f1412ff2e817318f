// What bricks make their vertices from: put there once, and kept when the bricks leave.

#include <utility>
#include <vector>

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

// Pictures may refer to points that are kept: nothing is written to them, as to those of live bricks.
template <class Live>
void LiveSurface<Live>::leavePoints(Brick& brick) {
    if (!brick.hasPoints || kept_.bound() == 0)
        return;
    if (const auto givenUp = kept_.put(brick.index, {brick.points, brick.pointsVersion}))
        brick.points = *givenUp; // goes with the rest of the brick
    else
        brick.points = {};
}

template <class Live>
void LiveSurface<Live>::addKeptRuns(std::vector<RetiredRuns>& runs) {
    kept_.forEach([&](const KeptPoints::Kept& kept) { runs.push_back({{}, {}, {}, kept.run}); });
}

// There may be pictures of those that are given up.
template <class Live>
void LiveSurface<Live>::keepPoints(std::uint64_t bytes) {
    kept_.setBound(bytes / (pointLines_ * sizeof(PointLine)));
    if (kept_.count() <= kept_.bound())
        return;
    std::vector<RetiredRuns> runs;
    runs.reserve(kept_.count() - kept_.bound());
    while (kept_.count() > kept_.bound())
        runs.push_back({{}, {}, {}, kept_.giveUp()});
    retired_.add(version_ + 1, runs);
}

template <class Live>
void LiveSurface<Live>::dropKeptPoints() {
    std::vector<RetiredRuns> runs;
    addKeptRuns(runs);
    kept_.clear();
    retired_.add(version_ + 1, runs);
}

#define ISO_INSTANTIATE(Live) \
    template void LiveSurface<Live>::putPoints(BrickSlot, BrickDraft<Live>&); \
    template void LiveSurface<Live>::leavePoints(Brick&); \
    template void LiveSurface<Live>::keepPoints(std::uint64_t); \
    template void LiveSurface<Live>::addKeptRuns(std::vector<RetiredRuns>&); \
    template void LiveSurface<Live>::dropKeptPoints();
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
