#include "ui/widgets/viewport/surface_fit.h"

#include <algorithm>
#include <utility>

#include "ui/model/session/session.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {

SurfaceFit::SurfaceFit(model::Session& session, const model::ViewState& view, const ViewportWidget& viewport,
                       QObject* parent)
    : QObject(parent),
      session_(session),
      view_(view),
      viewport_(viewport),
      jobs_(std::make_shared<model::BackgroundJobs>(session.services().postToMain)),
      fitting_(jobs_) {}

void SurfaceFit::find(std::function<void(const model::CameraPose&)> found) {
    const auto frame = session_.frame();
    const auto* dataset = session_.dataset();
    if (frame == nullptr || dataset == nullptr)
        return;
    const model::ViewOptions& options = view_.options();
    const glm::dvec3 stretch = options.stage.stretch;
    const glm::dmat4 toCentred = glm::dmat4(model::stretchMatrix(stretch, dataset->geometry)) *
                                 render::indexToCentredWorld(frame->geometry, dataset->geometry);
    fitting_.start(
        "Fit to surface",
        [frame, stretch, pieces = options.pieces,
         cuts = model::cutsOf(options.clipping, frame->geometry, dataset->geometry)](const JobControl& job) {
            return model::extentOf(*frame, pieces, cuts, job, stretch);
        },
        [this, toCentred, found = std::move(found),
         generation = session_.datasetGeneration()](const Result<std::optional<model::SurfaceExtent>>& result) {
            if (!result.isOk() || !result.value() || session_.datasetGeneration() != generation)
                return;
            const model::SurfaceExtent& extent = *result.value();
            const double aspect = static_cast<double>(viewport_.width()) / std::max(1, viewport_.height());
            found(viewport_.camera().poseAround(glm::dvec3(toCentred * glm::dvec4(extent.middle, 1.0)), extent.radius,
                                                aspect));
        });
}

} // namespace isoslider::widgets
