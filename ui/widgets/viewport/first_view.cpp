#include "ui/widgets/viewport/first_view.h"

#include <utility>

#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/surface_fit.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {

FirstView::FirstView(model::Session& session, const model::ViewState& view, ViewportWidget& viewport, QObject* parent)
    : QObject(parent),
      session_(session),
      view_(view),
      viewport_(viewport),
      fit_(new SurfaceFit(session, view, viewport, this)) {}

void FirstView::resetCamera() {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return;
    const GridGeometry shown = model::stretched(dataset->geometry, view_.options().stage.stretch);
    viewport_.changeCamera(
        [&](model::Camera& camera) { camera.reset(render::sceneRadius(shown), model::isPatientSpace(*dataset)); });
}

void FirstView::reset() {
    pose_.reset();
    resetCamera();
}

bool FirstView::isUntouched() const { return pose_ && *pose_ == viewport_.camera().pose(); }

void FirstView::follow() {
    const auto frame = session_.frame();
    if (session_.dataset() == nullptr)
        return;
    if (std::exchange(dataset_, session_.datasetGeneration()) != session_.datasetGeneration()) {
        resetCamera();
        pose_ = viewport_.camera().pose();
        fitted_.reset();
    }
    const bool isFirst = !fitted_ || session_.firstIsovalue().isovalue() == session_.isovalue().requested();
    if (frame == nullptr || !isUntouched() || !isFirst || fitted_ == frame->isovalue)
        return;
    fitted_ = frame->isovalue;
    fit_->find([this, requested = session_.isovalue().requested()](const model::CameraPose& pose) {
        if (!isUntouched() || session_.isovalue().requested() != requested) // the handle has been moved meanwhile
            return;
        viewport_.changeCamera([&](model::Camera& camera) { camera.setPose(pose); });
        pose_ = viewport_.camera().pose();
    });
}

} // namespace isoslider::widgets
