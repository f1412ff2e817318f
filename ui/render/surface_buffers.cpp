#include "ui/render/surface_buffers.h"

#include <utility>

#include "core/extract/live/brick_picture.h"

namespace isoslider::render {

void SurfaceBuffers::show(std::shared_ptr<const extract::SurfaceFrame> frame, const model::PieceOptions& pieces) {
    const bool isOther = frame != frame_;
    if (isOther) {
        frame_ = std::move(frame);
        isSent_ = false;
        isRefused_ = false;
        if (frame_ == nullptr) {
            arrays_.clear();
            bricks_.clear();
            draft_.clear();
        }
    }
    std::optional<model::PieceOptions> wanted;
    if (frame_ && frame_->pieces && pieces.isWanted())
        wanted = pieces;
    if (!isOther && wanted == wantedTints_)
        return;
    wantedTints_ = std::move(wanted);
    tints_.clear();
    if (wantedTints_)
        tints_ = model::PieceDisplay(*frame_->pieces, frame_->geometry, *wantedTints_).tints();
    areTintsSent_ = false;
}

bool SurfaceBuffers::prepare(int blockCells, const SurfaceView& view) {
    isDraft_ = blockCells > 1;
    if (isDraft_) {
        isRefused_ = !draft_.update(*frame_, blockCells, view.modelToClip, view.cuts, tints_);
        return !isRefused_;
    }
    if (!std::exchange(isSent_, true)) {
        isWholeRefused_ = !upload();
        areTintsSent_ = false;
    }
    isRefused_ = isWholeRefused_;
    if (!std::exchange(areTintsSent_, true)) {
        isTinted_ = !tints_.empty() && sendTints();
        if (!isTinted_) {
            bricks_.untint();
            arrays_.untint();
        }
    }
    return !(bricks_.isEmpty() && arrays_.isEmpty());
}

// One kind at a time: the other's memory may be wanted.
bool SurfaceBuffers::upload() {
    arrays_.clear();
    if (frame_->bricks && bricks_.canHold(*frame_->bricks)) {
        arrays_.freeMemory();
        return bricks_.upload(*frame_->bricks);
    }
    bricks_.freeMemory();
    if (!frame_->bricks)
        return arrays_.upload(*frame_);
    extract::SurfaceFrame frame = *frame_;
    expandPicture(frame);
    return arrays_.upload(frame);
}

bool SurfaceBuffers::sendTints() {
    return (!bricks_.isEmpty() && bricks_.tint(*frame_->pieces, tints_)) ||
           (!arrays_.isEmpty() && arrays_.tint(*frame_->pieces, tints_));
}

void SurfaceBuffers::setUniforms(QOpenGLShaderProgram& program) const {
    if (!isOfBricks())
        return;
    bricks_.setUniforms(program);
    program.setUniformValue("isovalue", static_cast<float>(frame_->isovalue));
}

bool SurfaceBuffers::draw(const SurfaceView& view, const std::function<bool()>& isStopped) {
    if (isOfBricks())
        return bricks_.drawSurface(view.modelToClip, view.cuts, isStopped);
    if (!isDraft_)
        return arrays_.drawSurface(isStopped);
    draft_.draw();
    return true;
}

double SurfaceBuffers::changedShare() const {
    if (isDraft_ || (bricks_.isEmpty() && arrays_.isEmpty()))
        return 0.0;
    const auto [changed, all] = bricks_.isEmpty()
                                    ? std::pair<double, double>(arrays_.changedIndices(), arrays_.surfaceIndices())
                                    : std::pair<double, double>(frame_->bricks->changedIndices().size(),
                                                                3.0 * static_cast<double>(frame_->stats.triangles));
    return changed / all;
}

void SurfaceBuffers::drawChanged() { isOfBricks() ? bricks_.drawChanged() : arrays_.drawChanged(); }

std::uint64_t SurfaceBuffers::refusedBytes() const { return isRefused_ ? extract::pictureBytes(*frame_) : 0; }

std::uint64_t SurfaceBuffers::uploadedBytes() const {
    return arrays_.uploadedBytes() + bricks_.uploadedBytes() + draft_.uploadedBytes();
}

void SurfaceBuffers::abandon() {
    arrays_.abandon();
    bricks_.abandon();
    draft_.abandon();
}

} // namespace isoslider::render
