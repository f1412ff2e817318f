#pragma once

#include <memory>
#include <optional>

#include <QImage>
#include <QWidget>

#include <glm/vec2.hpp>

#include "ui/model/observers.h"
#include "ui/model/slices/slice_model.h"

namespace isoslider::widgets {

/// A colour for each kind of slice: that of the axis in the 3-D view.
QColor sliceColour(model::SliceKind kind);

/// One slice: its samples in grey, the contour of the surface, and lines where the other slices cross it.
///
/// A click or a left drag moves the crosshair, the wheel goes through the slices, a right drag changes the window
/// (sideways its width, up and down its level) and a double click takes the automatic one. Shift+wheel zooms about the
/// pointer, the middle button or Shift+left drag moves the picture. Arrow keys move the crosshair by a sample, page
/// keys go through the slices, Home and End to the ends, + and - zoom, 0 shows all of it. `model` must outlive it.
class SlicePane : public QWidget {
    Q_OBJECT
public:
    SlicePane(model::SliceModel& model, model::SliceKind kind, QWidget* parent);

    model::SliceKind kind() const { return kind_; }
    /// How many times as long the volume's axes are drawn; see model::Stage.
    void setStretch(const glm::dvec3& stretch);
    /// Where a place of the volume is in the pane, and the pixel of the slice that a point of the pane is in.
    QPointF pointOf(const glm::dvec3& place) const;
    glm::dvec2 pixelAt(QPointF point) const;
    /// What is stated of the place under the pointer; empty while it is elsewhere.
    QString readout() const;
    QString caption() const;
    /// As much of the caption as the pane has room for; the place and its unit are kept longest.
    QString shownCaption() const;
    QSize sizeHint() const override { return {320, 320}; }

Q_SIGNALS:
    /// The wheel with Ctrl: a step of the isovalue, as in the 3-D view.
    void isovalueStepRequested(double rangeFraction);
    /// A click with the right button that moved nothing, or the menu key.
    void menuRequested(QPointF point);
    void focused();

protected:
    void paintEvent(QPaintEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void leaveEvent(QEvent* event) override;

private:
    /// How pixels of the slice lie in the pane.
    struct Mapping {
        extract::SlicePlane plane;
        QPointF first; ///< the middle of the first pixel
        glm::dvec2 scale{1.0}; ///< points for a pixel of the slice
        QPointF at(glm::dvec2 pixel) const { return first + QPointF(pixel.x * scale.x, pixel.y * scale.y); }
    };
    std::optional<Mapping> mapping() const;
    QStringList captions() const;
    void showState();
    /// Image and contour, which change less often than the lines and words above them.
    void paintSlice(const Mapping& mapping);
    void paintContourOf(const Mapping& mapping);
    void paintCrosshair(QPainter& painter, const Mapping& mapping) const;
    void paintWords(QPainter& painter) const;
    void paintMessage(QPainter& painter) const;

    void moveCrosshair(QPointF point);
    void moveBy(int right, int down);
    void zoom(double factor, QPointF about);
    void pan(QPointF by);
    void changeWindow(QPointF moved);

    model::SliceModel& model_;
    model::SliceKind kind_;
    glm::dvec3 stretch_{1.0};
    QImage slice_; ///< what paintSlice() has painted
    std::optional<QPointF> pointer_;
    QPointF pressPoint_, lastPoint_;
    double farthestFromPress_ = 0.0;
    double notches_ = 0.0; ///< of the wheel, not yet a whole slice
    model::Subscription optionsSubscription_;
    model::Subscription picturesSubscription_;
};

} // namespace isoslider::widgets
