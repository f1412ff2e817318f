#include "ui/widgets/viewport/surface_fit.h"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "ui/model/session/session.h"
#include "ui/model/surface/shown_surfaces.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {
namespace {

using Extent = std::optional<model::SurfaceExtent>;

/// The smallest ball around both.
void include(Extent& all, const model::SurfaceExtent& one) {
    const double apart = all ? glm::distance(all->middle, one.middle) : 0.0;
    if (!all || apart + all->radius <= one.radius) {
        all = one;
    } else if (apart + one.radius > all->radius) {
        const double radius = 0.5 * (apart + all->radius + one.radius);
        all->middle += (one.middle - all->middle) * ((radius - all->radius) / apart);
        all->radius = radius;
    }
}

/// Around the volume's centre, in the space that is shown.
Result<Extent> extentOfAll(std::span<const model::ShownSurface> shown, const model::Clipping& clipping,
                           const glm::dvec3& stretch, const GridGeometry& volume, const JobControl& job) {
    Extent all;
    const glm::dmat4 toShown(model::stretchMatrix(stretch, volume));
    for (const model::ShownSurface& surface : shown) {
        const GridGeometry& grid = surface.frame->geometry;
        const bool isAlong = grid.direction == volume.direction; // else no axis of it is stretched alone
        const auto cuts = model::cutsOf(clipping, grid, volume);
        const auto found =
            model::extentOf(*surface.frame, surface.pieces, cuts, job, isAlong ? stretch : glm::dvec3(1.0));
        if (!found.isOk())
            return found.error();
        if (!found.value())
            continue;
        model::SurfaceExtent extent = *found.value();
        extent.middle = toShown * (render::indexToCentredWorld(grid, volume) * glm::dvec4(extent.middle, 1.0));
        if (!isAlong)
            extent.radius *= std::max({stretch.x, stretch.y, stretch.z});
        include(all, extent);
    }
    return all;
}

} // namespace

SurfaceFit::SurfaceFit(model::Session& session, const model::ViewState& view, const ViewportWidget& viewport,
                       QObject* parent)
    : QObject(parent),
      session_(session),
      view_(view),
      viewport_(viewport),
      jobs_(std::make_shared<model::BackgroundJobs>(session.services().postToMain)),
      fitting_(jobs_) {}

void SurfaceFit::find(std::function<void(const model::CameraPose&)> found) {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr)
        return;
    const model::ViewOptions& options = view_.options();
    fitting_.start(
        "Fit to surfaces",
        [shown = model::shownSurfaces(session_, options), clipping = options.clipping, stretch = options.stage.stretch,
         volume = dataset->geometry](const JobControl& job) {
            return extentOfAll(shown, clipping, stretch, volume, job);
        },
        [this, found = std::move(found),
         generation = session_.datasetGeneration()](const Result<std::optional<model::SurfaceExtent>>& result) {
            if (!result.isOk() || !result.value() || session_.datasetGeneration() != generation)
                return;
            const model::SurfaceExtent& extent = *result.value();
            const double aspect = static_cast<double>(viewport_.width()) / std::max(1, viewport_.height());
            found(viewport_.camera().poseAround(extent.middle, extent.radius, aspect));
        });
}

} // namespace isoslider::widgets
