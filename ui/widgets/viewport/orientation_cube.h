#pragma once

#include <optional>

#include <QWidget>

#include "ui/model/surface/orientation_cube.h"

namespace isoslider::widgets {

/// A cube in the corner of a view that turns with the camera; a click on a side asks for the view of it. All else that
/// the pointer does on it is the view's, which is its parent: a drag orbits there as anywhere.
class OrientationCube : public QWidget {
    Q_OBJECT
public:
    explicit OrientationCube(QWidget* view);

    void setOrientation(const glm::dquat& cameraToWorld);
    /// Whether sides are named by a patient's directions.
    void setPatient(bool isPatient);
    /// As it is on screen, but for the side below the pointer: sharp in a painter of any scale.
    void paint(QPainter& painter) const { paintSides(painter, std::nullopt); }
    /// Below the pointer.
    std::optional<model::StandardView> hovered() const { return hovered_; }
    /// In the widget, with its middle at (0, 0); of places as in model::CubeSide.
    QPointF pointOf(glm::dvec2 place) const;

Q_SIGNALS:
    void sidePicked(model::StandardView side);

protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void leaveEvent(QEvent* event) override;

private:
    std::optional<model::StandardView> sideAt(QPointF point) const;
    void hover(const std::optional<model::StandardView>& side);
    void paintSides(QPainter& painter, const std::optional<model::StandardView>& highlighted) const;

    glm::dquat cameraToWorld_{1.0, 0.0, 0.0, 0.0};
    bool isPatient_ = false;
    std::optional<model::StandardView> hovered_;
    std::optional<model::StandardView> pressed_;
    bool isSecondPress_ = false; ///< of a double click on a side
    QPointF pressPoint_;
};

} // namespace isoslider::widgets
