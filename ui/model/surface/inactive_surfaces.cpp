#include "ui/model/surface/inactive_surfaces.h"

#include <algorithm>
#include <utility>

#include "core/base/guarded.h"
#include "core/extract/live/brick_picture.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/surface/coarse_picture.h"

namespace isoslider::model {
namespace {

const ThrownErrors kMakingErrors{"not enough memory for another surface; hide or remove one"};

InactiveSurfaces::Frame separateFrame(const extract::SurfaceFrame& frame) {
    auto separate = std::make_shared<extract::SurfaceFrame>();
    separate->bricks = frame.bricks ? extract::separateCopy(*frame.bricks) : nullptr;
    separate->geometry = frame.geometry;
    separate->isovalue = frame.isovalue;
    separate->positions = frame.positions;
    separate->normals = frame.normals;
    separate->indices = frame.indices;
    separate->findsPieces = frame.findsPieces;
    separate->pieces = frame.pieces;
    separate->mergeBound = frame.mergeBound;
    separate->region = frame.region;
    separate->stats = frame.stats;
    separate->isFromIndex = frame.isFromIndex;
    separate->isWholeExtraction = frame.isWholeExtraction;
    separate->mergedCells = frame.mergedCells;
    return separate;
}

struct WantedPieces {
    bool areWanted = false;
    InactiveSurfaces::Pieces before; ///< whose numbers are kept
    GridGeometry geometry; ///< of those
};

Result<InactiveSurfaces::Frame> makeFrame(const InactiveSurfaces::Making& how, double isovalue,
                                          const WantedPieces& wanted, const JobControl& job) {
    auto source = how.openSource(job);
    if (!source.isOk())
        return std::move(source).error();
    auto frame = std::make_shared<extract::SurfaceFrame>();
    frame->marksChanges = false;
    frame->mergeBound = how.bound;
    frame->findsPieces = wanted.areWanted;
    frame->pieces = wanted.before;
    frame->geometry = wanted.geometry;
    ISO_TRY(source.value()->moveTo(isovalue, job, *frame));
    fitPicture(*frame, how.pictureLimit);
    return InactiveSurfaces::Frame(std::move(frame));
}

} // namespace

bool InactiveSurfaces::Making::isAsGood(const extract::SurfaceFrame& frame) const {
    return frame.geometry == geometry && !frame.region && (frame.isWholeExtraction || frame.mergeBound == bound) &&
           extract::pictureBytes(frame) <= pictureLimit;
}

InactiveSurfaces::InactiveSurfaces(JobRunner& runner, MainThread postToMain, Failed failed)
    : runner_(runner),
      failed_(std::move(failed)),
      background_(std::make_shared<BackgroundJobs>(std::move(postToMain))),
      copying_(background_) {}

void InactiveSurfaces::setMaking(Making making) {
    how_ = std::move(making);
    ++making_;
    for (auto& [id, held] : held_)
        held.failedAt.reset();
    work();
}

void InactiveSurfaces::change(const std::function<void(Making&)>& change) {
    if (!how_)
        return;
    auto how = *how_;
    change(how);
    setMaking(std::move(how));
}

void InactiveSurfaces::clear() {
    if (job_)
        runner_.cancel(job_->id);
    job_.reset();
    ++ticket_;
    copying_.cancel();
    how_.reset();
    list_ = {};
    held_.clear();
    pieces_.clear();
}

void InactiveSurfaces::keep(SurfaceId id, Frame frame) {
    keepPieces(id, *frame);
    held_[id] = Held{std::move(frame), false, 0, {}};
}

void InactiveSurfaces::keepPieces(SurfaceId id, const extract::SurfaceFrame& frame) {
    if (frame.pieces)
        pieces_[id] = {frame.pieces, frame.geometry};
}

InactiveSurfaces::Pieces InactiveSurfaces::piecesOf(SurfaceId id) const {
    const auto found = pieces_.find(id);
    const bool isOfThisGrid = found != pieces_.end() && (!how_ || found->second.geometry == how_->geometry);
    return isOfThisGrid ? found->second.pieces : nullptr;
}

InactiveSurfaces::Frame InactiveSurfaces::find(SurfaceId id) const {
    const auto found = held_.find(id);
    return found != held_.end() ? found->second.frame : nullptr;
}

bool InactiveSurfaces::isWanted(const ListedSurface& surface) const {
    return surface.id != list_.active && surface.isVisible;
}

bool InactiveSurfaces::isThere(const ListedSurface& surface) const {
    const auto found = held_.find(surface.id);
    if (found == held_.end())
        return false;
    const Held& held = found->second;
    if (held.frame && surface.hiddenPieces.hidesAny() && !held.frame->findsPieces)
        return false;
    return held.failedAt == surface.isovalue || (held.frame && held.frame->isovalue == surface.isovalue &&
                                                 (held.madeBy == making_ || how_->isAsGood(*held.frame)));
}

void InactiveSurfaces::follow(const SurfaceList& list) {
    list_ = list;
    std::erase_if(held_,
                  [&](const auto& held) { return list_.find(held.first) == nullptr || held.first == list_.active; });
    work();
}

// One after the other: they would only take the processor from each other, and from the handle. Copies come first, for
// until then the live surface's memory grows.
void InactiveSurfaces::work() {
    if (!how_)
        return;
    if (!copying_.isRunning()) {
        const auto shared = std::find_if(held_.begin(), held_.end(),
                                         [](const auto& held) { return held.second.frame && !held.second.isSeparate; });
        if (shared != held_.end())
            copy(shared->first);
    }
    if (job_) {
        const ListedSurface* surface = list_.find(job_->surface);
        if (surface == nullptr || !isWanted(*surface) || surface->isovalue != job_->isovalue ||
            (surface->hiddenPieces.hidesAny() && !job_->findsPieces))
            runner_.cancel(job_->id);
        return;
    }
    const auto missing =
        std::find_if(list_.surfaces.begin(), list_.surfaces.end(),
                     [this](const ListedSurface& surface) { return isWanted(surface) && !isThere(surface); });
    if (missing != list_.surfaces.end())
        make(*missing);
}

void InactiveSurfaces::copy(SurfaceId id) {
    copying_.start(
        "Keep surface",
        [frame = held_[id].frame](const JobControl&) -> Result<Frame> {
            return guarded(kMakingErrors, [&]() -> Result<Frame> { return separateFrame(*frame); });
        },
        [this, id, of = held_[id].frame.get()](Result<Frame> copied) {
            const auto found = held_.find(id);
            if (found != held_.end() && found->second.frame.get() == of) {
                if (copied.isOk())
                    found->second = Held{std::move(copied).value(), true, 0, {}};
                else
                    held_.erase(found); // it is made instead, or there is no memory for it either
                changed_.notify();
            }
            work();
        });
}

void InactiveSurfaces::make(const ListedSurface& surface) {
    WantedPieces wanted{surface.hiddenPieces.hidesAny(), nullptr, {}};
    if (const auto known = pieces_.find(surface.id); known != pieces_.end() && wanted.areWanted) {
        wanted.before = known->second.pieces;
        wanted.geometry = known->second.geometry;
    }
    const JobId id = runner_.run<Frame>(
        "Extract surface at " + valueText(surface.isovalue, 7),
        [how = *how_, isovalue = surface.isovalue, wanted](const JobControl& job) -> Result<Frame> {
            return guarded(kMakingErrors, [&] { return makeFrame(how, isovalue, wanted, job); });
        },
        [this, ticket = ticket_](Result<Frame> frame) {
            if (ticket == ticket_)
                onMade(std::move(frame));
        });
    job_ = Job{id, surface.id, surface.isovalue, making_, wanted.areWanted};
}

void InactiveSurfaces::onMade(Result<Frame> frame) {
    const Job job = *std::exchange(job_, std::nullopt);
    const ListedSurface* surface = list_.find(job.surface);
    if (surface != nullptr && surface->id != list_.active && surface->isovalue == job.isovalue) {
        if (frame.isOk()) {
            keepPieces(job.surface, *frame.value());
            held_[job.surface] = Held{std::move(frame).value(), true, job.making, {}};
            changed_.notify();
        } else if (!frame.isCancelled()) {
            held_[job.surface] = Held{nullptr, true, job.making, job.isovalue};
            changed_.notify();
            failed_(*surface, frame.error());
        }
    }
    work();
}

} // namespace isoslider::model
