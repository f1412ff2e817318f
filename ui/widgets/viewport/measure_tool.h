#pragma once

#include <vector>

#include <QObject>
#include <QPainter>
#include <QWidget>

#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/surface/view_state.h"

class QAction;

namespace isoslider::model {
class Session;
}

namespace isoslider::widgets {

class ViewportWidget;

/// Lengths and the angle between places on the surface, over the view. Lets all pointer events through.
class MeasureView : public QWidget {
    Q_OBJECT
public:
    explicit MeasureView(ViewportWidget& viewport);

    /// `unit`: of length; may be empty.
    void show(model::MeasuredPlaces places, std::string unit);
    /// "12.5 mm" for each pair that follows one another, then "57.3°".
    QStringList texts() const;
    /// Where a place is in the view; none behind the eye.
    std::optional<QPointF> pointOf(const glm::dvec3& place) const;
    /// In a painter of the view's coordinates.
    void paint(QPainter& painter) const;

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    ViewportWidget& viewport_;
    model::MeasuredPlaces places_;
    std::string unit_;
};

/// While its action is on, clicks on the surface are places to measure between; switched off, they are forgotten. They
/// are part of the view's options, so they are saved and undone with them. Everything it is given must outlive it.
class MeasureTool : public QObject {
    Q_OBJECT
public:
    MeasureTool(model::Session& session, model::ViewState& options, ViewportWidget& viewport, QAction& action,
                QObject* parent);

    const MeasureView& view() const { return *view_; }

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void take(QPointF point);
    void setPlaces(model::MeasuredPlaces places);
    void showPlaces();
    void followDataset();

    model::Session& session_;
    model::ViewState& options_;
    ViewportWidget& viewport_;
    QAction& action_;
    MeasureView* view_; // the viewport's
    model::DatasetGeneration dataset_{};
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
