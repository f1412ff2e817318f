#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <QObject>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/surface_extent.h"

namespace isoslider::model {
class Session;
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

class ViewportWidget;

/// Finds where a view's camera must stand to show what is shown of all surfaces as large as it fits, from the
/// direction that it has. Everything it is given must outlive it.
class SurfaceFit : public QObject {
    Q_OBJECT
public:
    SurfaceFit(model::Session& session, const model::ViewState& view, const ViewportWidget& viewport, QObject* parent);

    /// `found` is called later, on this thread; not where nothing is shown, once another volume is open, or if this is
    /// called again before.
    void find(std::function<void(const model::CameraPose&)> found);

private:
    model::Session& session_;
    const model::ViewState& view_;
    const ViewportWidget& viewport_;
    std::shared_ptr<model::BackgroundJobs> jobs_;
    model::LatestJob<std::optional<model::SurfaceExtent>> fitting_; // last: nothing is reported once it is gone
};

} // namespace isoslider::widgets
