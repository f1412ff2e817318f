#include "ui/widgets/viewport/orientation_cube.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QFontMetricsF>
#include <QGuiApplication>
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QStyleHints>

namespace isoslider::widgets {
namespace {

constexpr int kSize = 92;
constexpr double kHalfEdge = 25.0; // the corners stay inside, however it is turned
constexpr double kLetters = 0.8; // of half an edge
constexpr double kLeastLegible = 0.2; // CubeSide::facing
// The ground of the view is dark in all themes. The colours of the axes are those of the axes and slices.
const QColor kShadedSide(44, 49, 57);
const QColor kLitSide(80, 88, 100);
const QColor kEdge(196, 203, 213);
const std::array<QColor, 3> kAxisColours{QColor(245, 132, 126), QColor(150, 216, 120), QColor(142, 186, 255)};

/// Only the direction that a side's letter is for.
QString patientWord(model::StandardView side) {
    switch (side) {
        case model::StandardView::Front: return OrientationCube::tr("anterior");
        case model::StandardView::Back: return OrientationCube::tr("posterior");
        case model::StandardView::Right: return OrientationCube::tr("left");
        case model::StandardView::Left: return OrientationCube::tr("right");
        case model::StandardView::Top: return OrientationCube::tr("superior");
        case model::StandardView::Bottom: return OrientationCube::tr("inferior");
    }
    return {};
}

QColor between(const QColor& a, const QColor& b, double part) {
    const auto mix = [part](int from, int to) { return static_cast<int>(std::lround(std::lerp(from, to, part))); };
    return {mix(a.red(), b.red()), mix(a.green(), b.green()), mix(a.blue(), b.blue())};
}

} // namespace

OrientationCube::OrientationCube(QWidget* view) : QWidget(view) {
    setObjectName(QStringLiteral("orientationCube"));
    setAccessibleName(tr("Orientation cube"));
    setAccessibleDescription(tr("A click on a side shows it straight on"));
    setFixedSize(kSize, kSize);
    setMouseTracking(true);
}

void OrientationCube::setOrientation(const glm::dquat& cameraToWorld) {
    cameraToWorld_ = cameraToWorld;
    hover(underMouse() && QGuiApplication::mouseButtons() == Qt::NoButton ? sideAt(mapFromGlobal(QCursor::pos()))
                                                                          : std::nullopt);
    update();
}

void OrientationCube::setPatient(bool isPatient) {
    if (std::exchange(isPatient_, isPatient) != isPatient)
        update();
}

QPointF OrientationCube::pointOf(glm::dvec2 place) const {
    return QRectF(rect()).center() + kHalfEdge * QPointF(place.x, -place.y);
}

std::optional<model::StandardView> OrientationCube::sideAt(QPointF point) const {
    const QPointF away = (point - QRectF(rect()).center()) / kHalfEdge;
    return model::sideAt(cameraToWorld_, {away.x(), -away.y()});
}

void OrientationCube::hover(const std::optional<model::StandardView>& side) {
    if (std::exchange(hovered_, side) == side)
        return;
    const QString name = side ? QString::fromStdString(model::sideName(*side, isPatient_)) : QString();
    setToolTip(!side        ? QString()
               : isPatient_ ? tr("Look at %1 (%2)").arg(name, patientWord(*side))
                            : tr("Look at %1").arg(name));
    side ? setCursor(Qt::PointingHandCursor) : unsetCursor();
    update();
}

void OrientationCube::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    paintSides(painter, hovered_);
}

void OrientationCube::paintSides(QPainter& painter, const std::optional<model::StandardView>& highlighted) const {
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    QFont letters = font();
    letters.setBold(true);
    letters.setPixelSize(static_cast<int>(std::lround(kLetters * kHalfEdge)));
    for (const model::CubeSide& side : model::visibleSides(cameraToWorld_)) {
        const bool isHighlighted = side.side == highlighted;
        painter.setPen(QPen(kEdge, 1.2, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
        painter.setBrush(isHighlighted ? palette().highlight().color() : between(kShadedSide, kLitSide, side.facing));
        painter.drawPolygon(QPolygonF{
            QList<QPointF>{pointOf(side.middle - side.right - side.up), pointOf(side.middle + side.right - side.up),
                           pointOf(side.middle + side.right + side.up), pointOf(side.middle - side.right + side.up)}});
        if (side.facing < kLeastLegible)
            continue;
        // As an outline, which stays sharp when it is drawn in perspective of its side.
        QPainterPath name;
        name.addText(0.0, 0.0, letters, QString::fromStdString(model::sideName(side.side, isPatient_)));
        const QPointF middle = name.boundingRect().center(), place = pointOf(side.middle);
        const QTransform onSide(side.right.x, -side.right.y, -side.up.x, side.up.y, place.x(), place.y());
        painter.fillPath(onSide.map(name.translated(-middle)),
                         isHighlighted ? palette().highlightedText().color()
                                       : kAxisColours[static_cast<std::size_t>(model::axisOf(side.side))]);
    }
    painter.restore();
}

// What is ignored here the view gets.
void OrientationCube::mousePressEvent(QMouseEvent* event) {
    isSecondPress_ = false;
    pressed_ = event->button() == Qt::LeftButton ? sideAt(event->position()) : std::nullopt;
    pressPoint_ = event->position();
    event->ignore();
}

void OrientationCube::mouseMoveEvent(QMouseEvent* event) {
    if (isSecondPress_)
        return;
    if ((event->position() - pressPoint_).manhattanLength() >= QGuiApplication::styleHints()->startDragDistance())
        pressed_.reset();
    hover(event->buttons() == Qt::NoButton ? sideAt(event->position()) : std::nullopt);
    event->ignore();
}

void OrientationCube::mouseReleaseEvent(QMouseEvent* event) {
    const auto side = std::exchange(pressed_, std::nullopt);
    if (std::exchange(isSecondPress_, false))
        return; // else the view would take the end of a double click for a click on what is behind
    if (side && event->button() == Qt::LeftButton)
        Q_EMIT sidePicked(*side);
    else
        event->ignore();
}

void OrientationCube::mouseDoubleClickEvent(QMouseEvent* event) {
    isSecondPress_ = sideAt(event->position()).has_value();
    if (!isSecondPress_)
        event->ignore();
}

void OrientationCube::leaveEvent(QEvent*) { hover(std::nullopt); }

} // namespace isoslider::widgets
