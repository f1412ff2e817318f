#pragma once

#include <QObject>
#include <QPointF>

#include "ui/model/observers.h"
#include "ui/model/slices/slice_model.h"
#include "ui/render/slice_scene.h"

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class SettingsStore;
class SliceWorkspace;
class ViewportHost;

/// Slices by menu and keys, in the 3-D view, and in the settings. Everything it is given must outlive it.
class SliceWiring : public QObject {
    Q_OBJECT
public:
    struct Parts {
        model::Session& session;
        model::SliceModel& slices;
        SliceWorkspace& workspace;
        ViewportHost& host;
    };
    SliceWiring(const Parts& parts, SettingsStore& settings, const ActionRegistry& actions, QObject* parent);

private:
    void restoreSettings();
    void connectLayouts();
    void connectScene();
    void connectActions();
    void connectPanes();
    void connectView();
    void showOptions();
    void nameAxes();
    void showScene();
    void showStretch();
    /// The slice that keys and menus go through: that of the pane used last, or else one that is shown.
    model::SliceKind currentKind() const;
    /// The slice in the 3-D view that the wheel pushes: the oblique one, or the one most across the line of sight.
    std::optional<model::SliceKind> pushedKind() const;
    void faceTheView();
    void moveToPointer(QPointF point);
    void takeIsovalue();
    void showMenu(model::SliceKind kind, QPointF point);

    Parts parts_;
    SettingsStore& settings_;
    const ActionRegistry& actions_;
    model::SliceKind used_ = model::SliceKind::Z;
    render::SliceScene scene_; ///< that the view has
    double notches_ = 0.0; ///< of the wheel in the view, not yet a whole slice
    model::Subscription optionsSubscription_;
    model::Subscription picturesSubscription_;
    model::Subscription viewSubscription_;
};

} // namespace isoslider::widgets
