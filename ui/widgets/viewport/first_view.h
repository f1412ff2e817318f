#pragma once

#include <optional>

#include <QObject>

#include "ui/model/session/dataset.h"
#include "ui/model/surface/camera.h"

namespace isoslider::model {
class Session;
class ViewState;
} // namespace isoslider::model

namespace isoslider::widgets {

class SurfaceFit;
class ViewportWidget;

/// What a volume is looked at with first: the whole box at once, then its first surface as large as it fits, and a
/// better first isovalue's. Once anything else has moved the camera or the handle it stays. Everything it is given must
/// outlive it.
class FirstView : public QObject {
    Q_OBJECT
public:
    FirstView(model::Session& session, const model::ViewState& view, ViewportWidget& viewport, QObject* parent);

    /// There may be another volume or another frame.
    void follow();
    /// Shows the whole box again.
    void reset();

private:
    void resetCamera();
    bool isUntouched() const;

    model::Session& session_;
    const model::ViewState& view_;
    ViewportWidget& viewport_;
    SurfaceFit* fit_;
    model::DatasetGeneration dataset_{};
    std::optional<model::CameraPose> pose_; ///< that was chosen here last
    std::optional<double> fitted_; ///< isovalue of the surface that the view is fitted to
};

} // namespace isoslider::widgets
