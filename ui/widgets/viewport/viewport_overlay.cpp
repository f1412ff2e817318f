#include "ui/widgets/viewport/viewport_overlay.h"

#include <algorithm>
#include <array>

#include <QPainter>

namespace isoslider::widgets {
namespace {

constexpr int kGlyphSize = 108;

struct Axis {
    QString name;
    QColor colour;
    glm::dvec3 direction;
};

} // namespace

AxesGlyph::AxesGlyph(QWidget* parent) : QWidget(parent) {
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setFixedSize(kGlyphSize, kGlyphSize);
    setAccessibleName(tr("Orientation axes"));
}

void AxesGlyph::setOrientation(const glm::dquat& cameraToWorld) {
    worldToCamera_ = glm::conjugate(cameraToWorld);
    update();
}

void AxesGlyph::setPatient(bool isPatient) {
    isPatient_ = isPatient;
    update();
}

QStringList AxesGlyph::letters() const {
    return (isPatient_ ? QStringLiteral("L P S") : QStringLiteral("X Y Z")).split(QLatin1Char(' '));
}

void AxesGlyph::setOnLight(bool isOnLight) {
    isOnLight_ = isOnLight;
    update();
}

void AxesGlyph::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    paint(painter);
}

void AxesGlyph::paint(QPainter& painter) const {
    const QStringList names = letters();
    std::array<Axis, 3> axes{{{names[0], QColor(235, 98, 92), worldToCamera_ * glm::dvec3(1, 0, 0)},
                              {names[1], QColor(126, 200, 92), worldToCamera_ * glm::dvec3(0, 1, 0)},
                              {names[2], QColor(104, 160, 250), worldToCamera_ * glm::dvec3(0, 0, 1)}}};
    // Far ones first, near ones over them.
    std::sort(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) { return a.direction.z < b.direction.z; });
    painter.setRenderHint(QPainter::Antialiasing);
    const QPointF centre(width() / 2.0, height() / 2.0);
    const double reach = width() * 0.34;
    QFont font = painter.font();
    font.setBold(true);
    painter.setFont(font);
    for (const auto& axis : axes) {
        QColor colour = isOnLight_ ? axis.colour.darker(165) : axis.colour;
        colour.setAlphaF(axis.direction.z < -0.2 ? 0.6 : 1.0);
        const QPointF direction(axis.direction.x, -axis.direction.y);
        const QPointF tip = centre + direction * reach;
        painter.setPen(QPen(colour, 2.4, Qt::SolidLine, Qt::RoundCap));
        painter.drawLine(centre, tip);
        const QPointF label = centre + direction * (reach + 11.0);
        painter.drawText(QRectF(label.x() - 10, label.y() - 10, 20, 20), Qt::AlignCenter, axis.name);
    }
}

ViewReadout::ViewReadout(QWidget* parent, const QColor& colour) : QLabel(parent) {
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setObjectName(QStringLiteral("viewReadout"));
    setMargin(7);
    setAutoFillBackground(false);
    setStyleSheet(QStringLiteral("QLabel { color: %1; background: rgba(20, 22, 26, 190); border-radius: 5px; }")
                      .arg(colour.name()));
}

} // namespace isoslider::widgets
