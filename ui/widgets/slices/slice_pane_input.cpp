#include <algorithm>
#include <cmath>

#include <QGuiApplication>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QStyleHints>
#include <QWheelEvent>

#include <glm/geometric.hpp>

#include "ui/model/isovalue/isovalue_model.h"
#include "ui/widgets/slices/slice_pane.h"

namespace isoslider::widgets {
namespace {

constexpr double kZoomPerSliceNotch = 1.2;
constexpr double kPageSlices = 10.0; // with Shift
constexpr double kWindowPerSide = 2.0; // powers of e of the width, and widths of the level, for a drag over the pane

} // namespace

void SlicePane::mousePressEvent(QMouseEvent* event) {
    pressPoint_ = lastPoint_ = event->position();
    farthestFromPress_ = 0.0;
    setFocus(Qt::MouseFocusReason);
    if (event->button() == Qt::LeftButton && !event->modifiers().testFlag(Qt::ShiftModifier))
        moveCrosshair(event->position());
}

void SlicePane::mouseMoveEvent(QMouseEvent* event) {
    const QPointF moved = event->position() - lastPoint_;
    pointer_ = event->position();
    farthestFromPress_ = std::max(farthestFromPress_, (event->position() - pressPoint_).manhattanLength());
    lastPoint_ = event->position();
    const auto buttons = event->buttons();
    if (buttons.testFlag(Qt::MiddleButton) ||
        (buttons.testFlag(Qt::LeftButton) && event->modifiers().testFlag(Qt::ShiftModifier)))
        pan(moved);
    else if (buttons.testFlag(Qt::LeftButton))
        moveCrosshair(event->position());
    else if (buttons.testFlag(Qt::RightButton) &&
             farthestFromPress_ >= QGuiApplication::styleHints()->startDragDistance())
        changeWindow(moved);
    update();
}

void SlicePane::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() == Qt::RightButton && farthestFromPress_ < QGuiApplication::styleHints()->startDragDistance())
        Q_EMIT menuRequested(event->position());
}

void SlicePane::mouseDoubleClickEvent(QMouseEvent* event) {
    mousePressEvent(event);
    model_.change([](model::SliceOptions& options) { options.window.reset(); });
}

void SlicePane::leaveEvent(QEvent* event) {
    QWidget::leaveEvent(event);
    pointer_.reset();
    update();
}

void SlicePane::focusInEvent(QFocusEvent* event) {
    QWidget::focusInEvent(event);
    update();
    Q_EMIT focused();
}

void SlicePane::focusOutEvent(QFocusEvent* event) {
    QWidget::focusOutEvent(event);
    update();
}

void SlicePane::wheelEvent(QWheelEvent* event) {
    const QPoint angle = event->angleDelta();
    const double notches = (angle.y() != 0 ? angle.y() : angle.x()) / 120.0;
    const bool isShift = event->modifiers().testFlag(Qt::ShiftModifier);
    event->accept();
    if (event->modifiers().testFlag(Qt::ControlModifier)) {
        Q_EMIT isovalueStepRequested(notches * model::kFineStep / (isShift ? model::kPrecisionFactor : 1.0));
    } else if (isShift) {
        zoom(std::pow(kZoomPerSliceNotch, notches), event->position());
    } else {
        notches_ += notches; // touch pads give parts of one
        const double whole = std::trunc(notches_);
        notches_ -= whole;
        if (whole != 0.0)
            model_.step(kind_, whole);
    }
}

void SlicePane::keyPressEvent(QKeyEvent* event) {
    switch (event->key()) {
        case Qt::Key_Left: return moveBy(-1, 0);
        case Qt::Key_Right: return moveBy(1, 0);
        case Qt::Key_Up: return moveBy(0, -1);
        case Qt::Key_Down: return moveBy(0, 1);
        case Qt::Key_PageUp:
        case Qt::Key_PageDown: {
            const double way = event->key() == Qt::Key_PageUp ? 1.0 : -1.0;
            return model_.step(kind_, event->modifiers().testFlag(Qt::ShiftModifier) ? kPageSlices * way : way);
        }
        case Qt::Key_Home: return model_.step(kind_, -static_cast<double>(kMaxDim));
        case Qt::Key_End: return model_.step(kind_, static_cast<double>(kMaxDim));
        case Qt::Key_Plus:
        case Qt::Key_Equal: return zoom(kZoomPerSliceNotch, QRectF(rect()).center());
        case Qt::Key_Minus: return zoom(1.0 / kZoomPerSliceNotch, QRectF(rect()).center());
        case Qt::Key_0:
            return model_.change([this](model::SliceOptions& options) { options.views[placeOf(kind_)] = {}; });
        case Qt::Key_Menu: Q_EMIT menuRequested(QRectF(rect()).center()); return;
        default: QWidget::keyPressEvent(event);
    }
}

void SlicePane::moveCrosshair(QPointF point) {
    if (model_.dataset() == nullptr)
        return;
    const glm::dvec2 pixel = pixelAt(point);
    const extract::SlicePlane plane = model_.planeOf(kind_);
    const glm::dvec3 place = plane.at(pixel.x, pixel.y);
    const bool isOblique = kind_ == model::SliceKind::Oblique;
    // Across its axis an axis slice stays where it is, also between grid points.
    glm::dvec3 moved = isOblique ? place : model::snappedPlace(place, model_.dataset()->geometry);
    if (!isOblique) {
        const int axis = gridAxisOf(kind_, model_.dataset()->geometry);
        moved[axis] = model_.options().position[axis];
    }
    model_.moveTo(moved, false);
}

void SlicePane::moveBy(int right, int down) {
    if (model_.dataset() == nullptr)
        return;
    const extract::SlicePlane plane = model_.planeOf(kind_);
    const bool isOblique = kind_ == model::SliceKind::Oblique;
    const auto step = [&](const glm::dvec3& way) { return isOblique ? way : glm::normalize(way); };
    const glm::dvec3 place = model_.options().position + static_cast<double>(right) * step(plane.right) +
                             static_cast<double>(down) * step(plane.down);
    model_.moveTo(place, false);
}

void SlicePane::zoom(double factor, QPointF about) {
    const auto before = mapping();
    if (!before)
        return;
    const glm::dvec2 pixel = pixelAt(about);
    model_.change([&](model::SliceOptions& options) {
        model::PaneView& view = options.views[placeOf(kind_)];
        const double zoom = std::clamp(view.zoom * factor, model::kLeastPaneZoom, model::kMostPaneZoom);
        const glm::dvec2 count(before->plane.width, before->plane.height);
        const glm::dvec2 place = (pixel + 0.5) / count; // stays where it is
        view.middle = place + (view.middle - place) * (view.zoom / zoom);
        view.zoom = zoom;
    });
}

void SlicePane::pan(QPointF by) {
    const auto map = mapping();
    if (!map)
        return;
    model_.change([&](model::SliceOptions& options) {
        const glm::dvec2 whole = map->scale * glm::dvec2(map->plane.width, map->plane.height);
        options.views[placeOf(kind_)].middle -= glm::dvec2(by.x(), by.y()) / whole;
    });
}

// As on a radiologist's screen: to the right less contrast, upwards brighter.
void SlicePane::changeWindow(QPointF moved) {
    const double side = std::max(1, std::min(width(), height()));
    const model::ValueWindow window = model_.window();
    const double width = window.width() * std::exp(moved.x() / side * kWindowPerSide);
    const double level = window.level() + moved.y() / side * kWindowPerSide * 0.5 * window.width();
    model_.change([&](model::SliceOptions& options) {
        options.window = model::ValueWindow{level - 0.5 * width, level + 0.5 * width};
    });
}

} // namespace isoslider::widgets
