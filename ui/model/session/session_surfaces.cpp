// The part of Session that keeps several surfaces of one volume. See inactive_surfaces.h for how.
#include <algorithm>
#include <utility>

#include "ui/model/session/session.h"

namespace isoslider::model {

std::shared_ptr<const extract::SurfaceFrame> Session::pictureOf(SurfaceId id) const {
    if (id != surfaces_.list().active)
        return inactive_->find(id);
    return isFrameOfActive_ ? frame_ : standIn_;
}

std::shared_ptr<const extract::SurfacePieces> Session::piecesOf(SurfaceId id) const {
    const auto picture = pictureOf(id);
    return picture && picture->pieces ? picture->pieces : inactive_->piecesOf(id);
}

void Session::addSurface() {
    if (!dataset_)
        return;
    const auto all = suggestions();
    const SuggestedRange range = dataset_->suggestedRange();
    const double isovalue = isovalueForAnother(surfaces_.list(), all, range.min, range.max);
    surfaces_.add(std::clamp(suggestedAs(isovalue, range), isovalue_.min(), isovalue_.max()));
}

void Session::followSurfaces() {
    if (surfaces_.active() == nullptr || !dataset_) {
        active_.reset();
        return;
    }
    const ListedSurface active = *surfaces_.active(); // moving changes it
    const auto before = std::exchange(active_, active.id);
    if (before && before != active.id)
        changeActive(*before, active);
    isovalue_.request(active.isovalue);
    // What is out of range, of a session or typed, is clamped.
    const SurfaceList listed = surfaces_.list();
    for (const ListedSurface& surface : listed.surfaces) {
        const double isovalue = std::clamp(surface.isovalue, isovalue_.min(), isovalue_.max());
        surfaces_.change(surface.id, [isovalue](ListedSurface& changed) { changed.isovalue = isovalue; });
    }
    inactive_->follow(surfaces_.list());
}

// The frame on screen stays that of the surface before, which it now stands for, until the live surface has moved on:
// panels that read frame() follow then, as they do at any move.
void Session::changeActive(SurfaceId before, const ListedSurface& active) {
    if (isFrameOfActive_ && frame_)
        inactive_->keep(before, frame_);
    standIn_ = inactive_->find(active.id);
    const auto pieces = inactive_->piecesOf(active.id);
    isFrameOfActive_ = frame_ && frame_->isovalue == active.isovalue && !isovalue_.isLagging() && !pieces;
    failedIsovalue_.reset();
    if (!isFrameOfActive_)
        generation_ = worker_->beginAgain(active.isovalue, pieces);
}

extract::MergeBound Session::boundAtRest() const {
    return extract::boundOf(detail_.error(), dataset_->min, dataset_->max);
}

void Session::setMaking() {
    InactiveSurfaces::Making making;
    making.bound = boundAtRest();
    making.pictureLimit = pictureLimit_;
    if (indexState_ == IndexState::Ready) {
        making.geometry = dataset_->geometry;
        making.openSource = [path = dataset_->indexPath](const JobControl&) -> Result<std::unique_ptr<SurfaceSource>> {
            // It moves once.
            extract::SlideOptions options;
            options.cacheBytes = extract::kEdgesCacheBytes;
            options.readsAhead = options.buildsLevels = false;
            auto engine = extract::SlideEngine::open(path, options);
            if (!engine.isOk())
                return std::move(engine).error();
            return makeIndexSource(std::move(engine).value());
        };
    } else {
        making.geometry = grid_->geometry();
        making.openSource = [grid = grid_, builder = services_.indexBuilder](
                                const JobControl&) -> Result<std::unique_ptr<SurfaceSource>> {
            return makeMemorySource(grid, builder);
        };
    }
    inactive_->setMaking(std::move(making));
}

} // namespace isoslider::model
