#include "ui/widgets/slices/slice_pane.h"

#include <algorithm>
#include <cmath>

#include <QPainter>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/surface/axis_names.h"
#include "ui/model/surface/stage.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/slices/contour_painter.h"

namespace isoslider::widgets {
namespace {

constexpr int kMargin = 7; // of words
constexpr double kRoom = 6.0; // around the slice
constexpr double kGap = 7.0; // of the crosshair's lines around the place itself
constexpr double kSmoothBelow = 4.0; // points for a sample: more show samples as what they are
const QColor kGround(22, 24, 28);
const QColor kWords(226, 230, 236);
const QColor kPlate(20, 22, 26, 210); // words of little weight are legible on it, whatever is behind
const QColor kPreview(255, 214, 138); // as over the 3-D view
const QColor kContourShadow(12, 10, 8, 190);

QString numberText(double value) { return fromStd(model::valueText(value, 7)); }

/// A grid point by its place in the file; where that order is not the world's, with the names of the grid's axes.
QString gridPlaceText(const glm::dvec3& place, bool isInOrder) {
    QStringList numbers;
    for (int axis = 0; axis < 3; ++axis)
        numbers << (isInOrder ? QString() : QString(QLatin1Char("ijk"[axis])) + QLatin1Char(' ')) +
                       fromStd(model::valueText(place[axis], 5));
    return numbers.join(QStringLiteral(", "));
}

/// Legible on any shade.
void drawWords(QPainter& painter, const QRectF& place, int flags, const QString& words, const QColor& colour) {
    painter.setPen(QColor(0, 0, 0, 210));
    for (const QPointF& shift : {QPointF(1, 1), QPointF(-1, 1), QPointF(1, -1), QPointF(-1, -1)})
        painter.drawText(place.translated(shift), flags, words);
    painter.setPen(colour);
    painter.drawText(place, flags, words);
}

} // namespace

QColor sliceColour(model::SliceKind kind) {
    switch (kind) {
        case model::SliceKind::X: return {235, 98, 92};
        case model::SliceKind::Y: return {126, 200, 92};
        case model::SliceKind::Z: return {104, 160, 250};
        case model::SliceKind::Oblique: return {214, 150, 240};
    }
    return {};
}

SlicePane::SlicePane(model::SliceModel& model, model::SliceKind kind, QWidget* parent)
    : QWidget(parent), model_(model), kind_(kind) {
    setObjectName(QStringLiteral("slicePane") + (kind == model::SliceKind::Oblique
                                                     ? QStringLiteral("Oblique")
                                                     : fromStd(model::worldAxisName(worldAxisOf(kind), false))));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setMinimumSize(80, 60);
    setCursor(Qt::CrossCursor);
    setAttribute(Qt::WA_OpaquePaintEvent);
    setToolTip({});
    optionsSubscription_ = model_.observe([this] { showState(); });
    picturesSubscription_ = model_.observePictures([this] { showState(); });
    showState();
}

void SlicePane::setStretch(const glm::dvec3& stretch) {
    if (std::exchange(stretch_, stretch) != stretch)
        showState();
}

void SlicePane::showState() {
    slice_ = QImage();
    setAccessibleName(tr("Slice, %1").arg(caption()));
    update();
}

std::optional<SlicePane::Mapping> SlicePane::mapping() const {
    if (model_.dataset() == nullptr)
        return std::nullopt;
    Mapping mapping{model_.planeOf(kind_), {}, {}};
    const glm::dvec2 pixel = model::pixelSize(mapping.plane, model::stretched(model_.dataset()->geometry, stretch_));
    const glm::dvec2 count(mapping.plane.width, mapping.plane.height);
    const glm::dvec2 extent = pixel * count;
    const glm::dvec2 room(std::max(1.0, width() - 2.0 * kRoom), std::max(1.0, height() - 2.0 * kRoom));
    if (!(extent.x > 0.0 && extent.y > 0.0))
        return std::nullopt;
    const model::PaneView& view = model_.options().views[placeOf(kind_)];
    const double fit = std::min(room.x / extent.x, room.y / extent.y) * view.zoom;
    mapping.scale = pixel * fit;
    const glm::dvec2 first = 0.5 * glm::dvec2(width(), height()) - (view.middle * count - 0.5) * mapping.scale;
    mapping.first = {first.x, first.y};
    return mapping;
}

QPointF SlicePane::pointOf(const glm::dvec3& place) const {
    const auto map = mapping();
    return map ? map->at(model::pixelOf(map->plane, place, model_.dataset()->geometry)) : QPointF();
}

glm::dvec2 SlicePane::pixelAt(QPointF point) const {
    const auto map = mapping();
    if (!map)
        return glm::dvec2(0.0);
    const QPointF away = point - map->first;
    return {away.x() / map->scale.x, away.y() / map->scale.y};
}

// From all that there is to state down to the least. The letter is of the axis that the number is along: an axis of the
// world has places in space, one of a grid that is turned has the numbers of its grid points.
QStringList SlicePane::captions() const {
    const auto* dataset = model_.dataset();
    if (kind_ == model::SliceKind::Oblique)
        return {tr("Oblique")};
    const int world = worldAxisOf(kind_);
    if (dataset == nullptr)
        return {fromStd(model::worldAxisName(world, false))};
    const GridGeometry& geometry = dataset->geometry;
    const model::AxisNames names(geometry);
    const int axis = names.gridAxisOf(world);
    const QString name = fromStd(names.nameOf(axis));
    const QString index = numberText(model_.options().position[axis]);
    const auto last = geometry.dims[static_cast<std::size_t>(axis)] - 1;
    QStringList texts;
    if (names.areOfWorld()) {
        const glm::dvec4 place = geometry.indexToWorld() * glm::dvec4(model_.options().position, 1.0);
        const QString number = fromStd(model::coordinateText(world, place[world], model_.isPatient(), 5));
        const QString unit = dataset->lengthUnit.empty() ? QString() : QLatin1Char(' ') + fromStd(dataset->lengthUnit);
        const QString where = (model_.isPatient() ? number : tr("%1 = %2").arg(name, number)) + unit;
        texts = {tr("%1 (%2 of %3)").arg(where, index).arg(last), where};
    } else {
        texts = {tr("%1 = %2 of %3").arg(name, index).arg(last), tr("%1 = %2").arg(name, index)};
    }
    if (!model_.isPatient())
        return texts;
    static constexpr std::array<const char*, 3> kPlanes{QT_TR_NOOP("Sagittal"), QT_TR_NOOP("Coronal"),
                                                        QT_TR_NOOP("Axial")};
    const QString plane = tr(kPlanes[static_cast<std::size_t>(world)]) + QStringLiteral("   ");
    return {plane + texts[0], plane + texts[1], texts[1]};
}

QString SlicePane::caption() const { return captions().front(); }

QString SlicePane::shownCaption() const {
    const QStringList texts = captions();
    const QFontMetricsF metrics(font());
    for (const QString& text : texts)
        if (metrics.horizontalAdvance(text) <= width() - 2.0 * kMargin)
            return text;
    return texts.back();
}

QString SlicePane::readout() const {
    if (!pointer_)
        return {};
    const glm::dvec2 pixel = pixelAt(*pointer_);
    const auto reading = model_.reading(kind_, pixel.x, pixel.y);
    if (!reading)
        return {};
    const QString value = reading->value ? numberText(*reading->value) : tr("missing");
    const model::Dataset& dataset = *model_.dataset();
    const QString world = fromStd(model::placeText(reading->world, model_.isPatient(), 5));
    return tr("%1   at (%2)\n%3")
               .arg(value, gridPlaceText(reading->place, model::AxisNames(dataset.geometry).areInOrder()), world) +
           (dataset.lengthUnit.empty() ? QString() : QLatin1Char(' ') + fromStd(dataset.lengthUnit));
}

void SlicePane::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    slice_ = QImage();
}

void SlicePane::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const auto map = mapping();
    if (slice_.isNull()) {
        const double ratio = devicePixelRatioF();
        slice_ = QImage((QSizeF(size()) * ratio).toSize(), QImage::Format_RGB32);
        slice_.setDevicePixelRatio(ratio);
        slice_.fill(kGround);
        if (map)
            paintSlice(*map);
    }
    painter.drawImage(0, 0, slice_);
    if (map && model_.options().showsCrosshair)
        paintCrosshair(painter, *map);
    paintWords(painter);
    if (!model_.problem(kind_).empty())
        paintMessage(painter);
    painter.setRenderHint(QPainter::Antialiasing, false);
    painter.setBrush(Qt::NoBrush);
    painter.setPen(hasFocus() ? QPen(palette().highlight().color(), 2.0) : QPen(QColor(255, 255, 255, 30), 1.0));
    painter.drawRect(hasFocus() ? rect().adjusted(1, 1, -1, -1) : rect().adjusted(0, 0, -1, -1));
}

void SlicePane::paintSlice(const Mapping& map) {
    if (const auto shades = model_.shades(kind_)) {
        const extract::SlicePlane& plane = shades->plane;
        const QImage image(reinterpret_cast<const uchar*>(shades->pixels.data()), plane.width, plane.height,
                           plane.width * 4, QImage::Format_ARGB32);
        // Of an oblique slice that has been turned, the one before stands in until the next is there.
        const glm::dvec2 half(0.5);
        const QRectF place(map.at(-half), map.at(glm::dvec2(map.plane.width, map.plane.height) - half));
        QPainter painter(&slice_);
        painter.setRenderHint(QPainter::SmoothPixmapTransform,
                              std::max(map.scale.x, map.scale.y) * devicePixelRatioF() < kSmoothBelow);
        painter.drawImage(place, image);
    }
    paintContourOf(map);
}

void SlicePane::paintContourOf(const Mapping& map) {
    const auto contour = model_.contour(kind_);
    if (!contour || contour->points.empty())
        return;
    const GridGeometry& geometry = model_.dataset()->geometry;
    const double ratio = devicePixelRatioF();
    // Affine: four places give all the others.
    const QPointF origin = map.at(model::pixelOf(map.plane, glm::dvec3(0.0), geometry)) * ratio;
    std::array<QPointF, 3> ways;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0.0);
        unit[axis] = 1.0;
        ways[static_cast<std::size_t>(axis)] = map.at(model::pixelOf(map.plane, unit, geometry)) * ratio - origin;
    }
    const auto at = [&](const glm::vec3& p) {
        return origin + ways[0] * static_cast<double>(p.x) + ways[1] * static_cast<double>(p.y) +
               ways[2] * static_cast<double>(p.z);
    };
    const QRectF seen = QRectF(slice_.rect()).adjusted(-4, -4, 4, 4);
    std::size_t i = 0;
    for (const model::SliceContour::Part& part : contour->parts) {
        std::vector<QLineF> lines;
        for (; i + 1 < part.pointEnd; i += 2) {
            const QLineF line(at(contour->points[i]), at(contour->points[i + 1]));
            if (QRectF(line.p1(), line.p2()).normalized().adjusted(0, 0, 1, 1).intersects(seen))
                lines.push_back(line);
        }
        // Among very many lines a shadow only darkens the picture.
        constexpr std::size_t kMostWithShadow = 20'000;
        const bool hasShadow = lines.size() <= kMostWithShadow;
        const QColor colour(part.colour[0], part.colour[1], part.colour[2]);
        widgets::paintContour(slice_, lines, {1.5 * ratio, (hasShadow ? 3.6 : 1.5) * ratio, colour, kContourShadow});
    }
}

void SlicePane::paintCrosshair(QPainter& painter, const Mapping& map) const {
    const QPointF place = map.at(model::pixelOf(map.plane, model_.options().position, model_.dataset()->geometry));
    model::SliceKind upright = kind_, level = kind_;
    if (kind_ != model::SliceKind::Oblique) {
        const GridGeometry& geometry = model_.dataset()->geometry;
        const model::SliceAxes axes = model::sliceAxes(geometry, gridAxisOf(kind_, geometry));
        const model::AxisNames names(geometry);
        // The slice across that axis is seen from its edge.
        upright = static_cast<model::SliceKind>(names.worldAxisOf(axes.right));
        level = static_cast<model::SliceKind>(names.worldAxisOf(axes.down));
    }
    const auto line = [&](QPointF from, QPointF to, model::SliceKind kind) {
        QColor colour = sliceColour(kind);
        colour.setAlpha(200);
        painter.setPen(QPen(colour, 1.0));
        painter.drawLine(from, to);
    };
    painter.setRenderHint(QPainter::Antialiasing, false);
    line({place.x(), 0.0}, {place.x(), place.y() - kGap}, upright);
    line({place.x(), place.y() + kGap}, {place.x(), static_cast<double>(height())}, upright);
    line({0.0, place.y()}, {place.x() - kGap, place.y()}, level);
    line({place.x() + kGap, place.y()}, {static_cast<double>(width()), place.y()}, level);
}

void SlicePane::paintWords(QPainter& painter) const {
    const QRectF room = QRectF(rect()).adjusted(kMargin, kMargin - 1, -kMargin, -kMargin);
    QFont small = font();
    small.setPointSizeF(std::max(6.5, font().pointSizeF() * 0.88));
    painter.setFont(font());
    drawWords(painter, room, Qt::AlignLeft | Qt::AlignTop, shownCaption(), sliceColour(kind_));
    if (model_.dataset() == nullptr)
        return;
    if (const auto step = model_.shownStep(kind_); step > 1)
        drawWords(painter, room.adjusted(0, fontMetrics().height(), 0, 0), Qt::AlignLeft | Qt::AlignTop,
                  tr("preview at 1:%1").arg(step), kPreview);
    const model::SliceLabels labels = model_.labels(kind_);
    QFont bold = font();
    bold.setBold(true);
    painter.setFont(bold);
    drawWords(painter, room, Qt::AlignLeft | Qt::AlignVCenter, fromStd(labels.left), kWords);
    drawWords(painter, room, Qt::AlignRight | Qt::AlignVCenter, fromStd(labels.right), kWords);
    // Below the caption where that reaches the middle.
    const double captionEnd = kMargin + fontMetrics().horizontalAdvance(shownCaption()) + 2.0 * kMargin;
    const double down = captionEnd > room.center().x() - kMargin ? fontMetrics().height() : 0.0;
    drawWords(painter, room.adjusted(0, down, 0, 0), Qt::AlignHCenter | Qt::AlignTop, fromStd(labels.top), kWords);
    const QString words = readout();
    const QFontMetricsF metrics(small);
    const QSizeF wordsSize = metrics.boundingRect(QRectF(), 0, words).size();
    // And above what is stated of the pointer's place, likewise.
    const double up = wordsSize.width() + 2.0 * kMargin > 0.5 * room.width() ? wordsSize.height() : 0.0;
    drawWords(painter, room.adjusted(0, 0, 0, -up), Qt::AlignHCenter | Qt::AlignBottom, fromStd(labels.bottom), kWords);
    painter.setFont(small);
    const model::ValueWindow window = model_.window();
    const QString range =
        tr("W %1\nL %2")
            .arg(fromStd(model::valueText(window.width(), 4)), fromStd(model::valueText(window.level(), 4)));
    drawWords(painter, room, Qt::AlignLeft | Qt::AlignBottom, words, kWords);
    // The value is what people look for: the window gives way.
    const double needed = wordsSize.width() + metrics.boundingRect(QRectF(), 0, range).width();
    if (needed + 3 * kMargin >= room.width())
        return;
    const QRectF place = metrics.boundingRect(room, Qt::AlignRight | Qt::AlignBottom, range);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kPlate);
    painter.drawRoundedRect(place.adjusted(-4.0, -2.0, 4.0, 2.0), 3.0, 3.0);
    painter.setPen(kWords);
    painter.drawText(room, Qt::AlignRight | Qt::AlignBottom, range);
}

void SlicePane::paintMessage(QPainter& painter) const {
    painter.setFont(font());
    const QRectF room = QRectF(rect()).adjusted(24, 24, -24, -24);
    drawWords(painter, room, Qt::AlignCenter | Qt::TextWordWrap, fromStd(model_.problem(kind_)), kWords);
}

} // namespace isoslider::widgets
