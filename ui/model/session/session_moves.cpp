// The part of Session that has the surface moved: what it asks the worker for, and what comes back.
#include <utility>

#include "ui/model/session/session.h"

namespace isoslider::model {

SlideWorker::Callbacks Session::workerCallbacks() {
    SlideWorker::Callbacks callbacks;
    const std::weak_ptr<FrameSlot> weakSlot = slot_;
    callbacks.onFrame = [this, weakSlot, post = services_.postToMain](auto frame, SourceGeneration generation) {
        const auto slot = weakSlot.lock();
        if (!slot)
            return;
        {
            const std::lock_guard lock(slot->mutex);
            slot->frame = std::move(frame);
            slot->generation = generation;
            if (std::exchange(slot->isPosted, true))
                return;
        }
        post([this, weakSlot] {
            if (!weakSlot.lock())
                return;
            takeFrame();
            // After what the frame's observers post in turn: pictures are asked for so.
            services_.postToMain([this, weakSlot] {
                if (weakSlot.lock())
                    worker_->frameReceived();
            });
        });
    };
    callbacks.waitsForReceipt = true;
    callbacks.onProgress = [this, weakSlot, post = services_.postToMain](double fraction, SourceGeneration generation) {
        post([this, weakSlot, fraction, generation] {
            if (weakSlot.lock() && generation == generation_ && isMoving())
                setMoveProgress(fraction);
        });
    };
    callbacks.onError = [this, weakSlot, post = services_.postToMain](Error error, double isovalue,
                                                                      SourceGeneration generation) {
        post([this, weakSlot, error = std::move(error), isovalue, generation] {
            if (weakSlot.lock())
                onSlideError(error, isovalue, generation);
        });
    };
    return callbacks;
}

void Session::useSource(std::shared_ptr<SurfaceSource> source) {
    mergeCells(); // a percentage is of this volume's range
    worker_->boundTo(wantedRegion());
    setMaking();
    moveProgress_ = 0.0;
    std::optional<double> isovalue; // none: what was stopped stays so
    if (!hasStoppedMove()) {
        failedIsovalue_.reset();
        isovalue = isovalue_.requested();
    }
    generation_ = worker_->setSource(std::move(source), datasetGeneration_, isovalue);
}

void Session::requestMove(double isovalue) {
    failedIsovalue_.reset();
    isMoveStopped_ = false;
    moveProgress_ = 0.0;
    worker_->request(isovalue);
}

void Session::stopMove() {
    if (!isMoving())
        return;
    worker_->cancelMove();
    isPictureComing_ = false;
    failedIsovalue_ = isovalue_.requested();
    isMoveStopped_ = true;
    setMoveProgress(0.0);
    if (indexState_ == IndexState::None)
        startIndexBuild();
    datasetChanged_.notify(); // no surface is waited for any more
}

void Session::moveAgain() {
    if (!dataset_ || !hasMoveFailed())
        return;
    requestMove(isovalue_.requested());
    datasetChanged_.notify();
}

void Session::setMoveProgress(double fraction) {
    moveProgress_ = fraction;
    moveProgressChanged_.notify();
}

void Session::limitPicture(std::uint64_t bytes) {
    pictureLimit_ = bytes;
    worker_->limitPicture(bytes);
    inactive_->change([bytes](InactiveSurfaces::Making& making) { making.pictureLimit = bytes; });
    second_->limitPicture(bytes);
    redraw();
}

// Asks for another picture of the same surface.
void Session::redraw() {
    if (!dataset_)
        return;
    isPictureComing_ = frame_ != nullptr;
    requestMove(isovalue_.requested());
}

void Session::mergeCells() {
    if (!dataset_)
        return;
    worker_->mergeWithin(wantedBound());
    inactive_->change([bound = boundAtRest()](InactiveSurfaces::Making& making) { making.bound = bound; });
}

void Session::findPieces(bool isWanted) {
    worker_->findPieces(isWanted);
    if (isWanted && frame_ && !frame_->findsPieces)
        worker_->request(isovalue_.requested());
}

void Session::lookAt(const std::optional<CropBox>& box) {
    if (lookedAt_ == box)
        return;
    lookedAt_ = box;
    worker_->boundTo(wantedRegion());
    if (frame_ && !isAsWanted(*frame_))
        redraw();
}

// A preview is small, and of another grid.
std::optional<BrickBox> Session::wantedRegion() const {
    if (!lookedAt_ || !dataset_ || isPreview())
        return std::nullopt;
    const CropBox box = cropWithin(lookedAt_, dataset_->geometry.dims);
    const BrickGrid grid(dataset_->geometry.dims);
    const BrickBox region = bricksAround(box.low, box.high, grid);
    return region == BrickBox{{}, {grid.bricks()[0] - 1, grid.bricks()[1] - 1, grid.bricks()[2] - 1}}
               ? std::nullopt
               : std::optional(region);
}

// A move that had begun before something else was wanted goes to its end; the one that was asked for then follows.
bool Session::isAsWanted(const extract::SurfaceFrame& frame) const {
    return frame.isWholeExtraction ||
           (frame.mergeBound == wantedBound() && (frame.findsPieces || frame.region == wantedRegion()));
}

extract::MergeBound Session::wantedBound() const {
    return extract::boundOf(detail_.usedError(), dataset_->min, dataset_->max);
}

void Session::takeFrame() {
    SourceGeneration generation{};
    std::shared_ptr<const extract::SurfaceFrame> frame;
    {
        const std::lock_guard lock(slot_->mutex);
        slot_->isPosted = false;
        frame = std::exchange(slot_->frame, nullptr);
        generation = slot_->generation;
    }
    if (!frame || generation != generation_)
        return;
    frame_ = std::move(frame);
    moveProgress_ = 0.0;
    isMoveStopped_ = false;
    isFrameOfActive_ = true;
    standIn_.reset();
    isPictureComing_ = !isAsWanted(*frame_);
    failedIsovalue_.reset();
    isovalue_.setDisplayed(frame_->isovalue, frame_->stats.updateMs + frame_->stats.interpolateMs);
    frameChanged_.notify();
    // The first picture has both cores for itself; the index comes after it.
    if (indexState_ == IndexState::None)
        startIndexBuild();
    if (frame_->isFromIndex && dataset_->index && !dataset_->values->isExact() && !areValuesCounted_)
        countValues();
    if (frame_->isFromIndex && topology_.state() == TopologyState::None)
        analyseTopology();
}

void Session::onSlideError(const Error& error, double isovalue, SourceGeneration generation) {
    if (generation != generation_)
        return;
    isPictureComing_ = false;
    failedIsovalue_ = isovalue;
    fail("The surface could not be moved", error);
    if (indexState_ == IndexState::None)
        startIndexBuild();
    datasetChanged_.notify(); // no surface is waited for any more
}

bool Session::hasMoveFailed() const { return failedIsovalue_ == isovalue_.requested(); }

bool Session::isMoving() const {
    return dataset_ && !hasMoveFailed() && (!frame_ || isPictureComing_ || isovalue_.isLagging());
}

} // namespace isoslider::model
