#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <QCursor>
#include <QObject>
#include <QPointF>

#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/slices/cap_model.h"
#include "ui/model/surface/view_state.h"
#include "ui/widgets/viewport/clip_handles.h"

class QMouseEvent;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ActionRegistry;
class ViewportWidget;

/// Crop box and clip planes by menu, keys and handles in the view. Both are part of the view's options, so they are
/// saved and undone with them; those of another volume are forgotten. Everything it is given must outlive it.
class ClipTool : public QObject {
    Q_OBJECT
public:
    ClipTool(model::Session& session, model::ViewState& options, ViewportWidget& viewport,
             const ActionRegistry& actions, QObject* parent);

    ClipHandles& handles() { return *handles_; }
    /// Of a clip plane, by its place.
    model::CapModel& cap(std::size_t place) { return caps_[place]; }

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    struct Drag {
        ClipHandle handle;
        model::Clipping before;
        glm::dvec3 from{0.0}; ///< where the handle was
        double at = 0.0; ///< of the pointer along the line that it moves on, when the button was pressed
        glm::dvec3 pivot{0.0}; ///< about which the plane turns
        bool isFar = false; ///< the tip lies on the side away from the viewer
    };

    void connectActions(const ActionRegistry& actions);
    void change(const std::function<void(model::Clipping&)>& change);
    void showOptions();
    void showCaps();
    void followDataset();
    bool press(QMouseEvent* event);
    void hover(const std::optional<ClipHandle>& handle);
    void begin(const ClipHandle& handle, QPointF point);
    void drag(QPointF point);
    std::optional<double> placeAlongWay(const glm::dvec3& from, const glm::dvec3& way, QPointF point) const;
    glm::dvec3 wayOf(const ClipHandle& handle) const;
    glm::dvec3 turnedNormal(QPointF point) const;
    QString textOf(const ClipHandle& handle) const;

    model::Session& session_;
    model::ViewState& options_;
    ViewportWidget& viewport_;
    const ActionRegistry& actions_;
    ClipHandles* handles_; // the viewport's
    std::array<model::CapModel, model::kClipPlanes> caps_; ///< of the planes
    std::optional<Drag> drag_;
    std::optional<ClipHandle> hovered_;
    std::optional<QCursor> cursorBefore_;
    model::DatasetGeneration dataset_{};
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
