#pragma once

#include <vector>

#include <QObject>

#include "ui/model/observers.h"
#include "ui/model/surface/view_state.h"

class QPainter;

namespace isoslider::model {
class ColourModel;
class Session;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class BoxTicksView;
class CameraFlight;
class ColourBarView;
class OrientationCube;
class ScaleBarView;
class SurfaceFit;
class ViewportWidget;

/// What helps to find one's way in the 3-D view: the orientation cube, the scale bar, the colour bar, ticks on
/// the box, and the way to the surfaces. Everything it is given must outlive it.
class SceneGuides : public QObject {
    Q_OBJECT
public:
    struct Parts {
        ViewportWidget& viewport;
        model::ViewState& view;
        CameraFlight& flight;
        model::ColourModel& colours;
    };
    SceneGuides(model::Session& session, const Parts& parts, const ActionRegistry& actions, QObject* parent);

    /// As they are on screen, in a painter of the view's coordinates.
    void paint(QPainter& painter) const;
    /// Shows the whole surface, without the pieces that are hidden: as soon as a job has found out where it ends.
    void fitToSurface();

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void showState();
    void showScale();
    void showColours();
    void showTicks();

    model::Session& session_;
    Parts parts_;
    const ActionRegistry& actions_;
    BoxTicksView* ticks_;
    OrientationCube* cube_;
    ScaleBarView* scaleBar_;
    ColourBarView* colourBar_;
    SurfaceFit* fit_;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
