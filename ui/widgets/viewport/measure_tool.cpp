#include "ui/widgets/viewport/measure_tool.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QAction>
#include <QEvent>
#include <QFontMetricsF>
#include <QLineF>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/shown_surfaces.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/viewport/viewport_widget.h"

namespace isoslider::widgets {
namespace {

constexpr int kFigures = 4;
constexpr double kLineWidth = 1.6, kShadowWidth = 4.0, kDot = 3.5;
constexpr double kPadding = 5.0, kGap = 6.0; // of texts, and from the line to its text
const QColor kInk(255, 209, 102);
const QColor kPlate(20, 22, 26, 190);
const QColor kShadow(20, 22, 26, 170); // around lines, so that they are seen on any surface

QPointF unit(QPointF direction) {
    const double length = std::hypot(direction.x(), direction.y());
    return length > 0.0 ? direction / length : QPointF(0.0, -1.0);
}

// Across a line, away from a third point, or else upwards: where a text is in nobody's way.
QPointF outwardsOf(const QLineF& line, const std::optional<QPointF>& third) {
    const QPointF across = unit({line.dy(), -line.dx()});
    const QPointF away = third ? line.center() - *third : QPointF(0.0, -1.0);
    return QPointF::dotProduct(across, away) < 0.0 ? -across : across;
}

} // namespace

MeasureView::MeasureView(ViewportWidget& viewport) : QWidget(&viewport), viewport_(viewport) {
    setObjectName(QStringLiteral("measureView"));
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
}

void MeasureView::show(model::MeasuredPlaces places, std::string unit) {
    places_ = std::move(places);
    unit_ = std::move(unit);
    setGeometry(viewport_.rect());
    setVisible(!places_.empty());
    setAccessibleName(texts().join(QStringLiteral(", ")));
    update();
}

QStringList MeasureView::texts() const {
    QStringList texts;
    for (std::size_t i = 1; i < places_.size(); ++i)
        texts << inLengthUnit(fromStd(model::valueText(glm::distance(places_[i - 1], places_[i]), kFigures)), unit_);
    if (const auto angle = model::measuredAngle(places_))
        texts << QStringLiteral("%1°").arg(*angle, 0, 'f', 1);
    return texts;
}

std::optional<QPointF> MeasureView::pointOf(const glm::dvec3& place) const {
    const model::Camera& camera = viewport_.camera();
    const double aspect = static_cast<double>(viewport_.width()) / std::max(1, viewport_.height());
    const glm::dvec4 clip = camera.projectionMatrix(aspect) * camera.viewMatrix() * glm::dvec4(place, 1.0);
    if (!(clip.w > 0.0))
        return std::nullopt;
    return QPointF((clip.x / clip.w + 1.0) / 2.0 * viewport_.width(),
                   (1.0 - clip.y / clip.w) / 2.0 * viewport_.height());
}

void MeasureView::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    paint(painter);
}

void MeasureView::paint(QPainter& painter) const {
    std::vector<QPointF> points;
    for (const glm::dvec3& place : places_) {
        const auto point = pointOf(place);
        if (!point)
            return;
        points.push_back(*point);
    }
    painter.setRenderHint(QPainter::Antialiasing);
    for (const auto& [colour, width] : {std::pair(kShadow, kShadowWidth), std::pair(kInk, kLineWidth)}) {
        painter.setPen(QPen(colour, width, Qt::SolidLine, Qt::RoundCap));
        painter.drawPolyline(points.data(), static_cast<int>(points.size()));
    }
    painter.setPen(QPen(kShadow, 1.0));
    painter.setBrush(kInk);
    for (const QPointF& point : points)
        painter.drawEllipse(point, kDot, kDot);
    const QStringList all = texts();
    for (int i = 0; i < all.size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        const bool isAngle = at + 1 == points.size();
        const QPointF middle = isAngle ? points[1] : (points[at] + points[at + 1]) / 2.0;
        const QFontMetricsF metrics(painter.font());
        QRectF plate(0.0, 0.0, metrics.horizontalAdvance(all[i]) + 2.0 * kPadding, metrics.height() + kPadding);
        const QPointF outwards =
            isAngle ? unit(middle - (points[0] + points[2]) / 2.0)
                    : outwardsOf(QLineF(points[at], points[at + 1]),
                                 points.size() == 3 ? std::optional(points[2 * (1 - at)]) : std::nullopt);
        const double reach = (std::abs(outwards.x()) * plate.width() + std::abs(outwards.y()) * plate.height()) / 2.0;
        // Angles beyond the lengths of both sides.
        plate.moveCenter(middle + outwards * (reach + kGap + (isAngle ? plate.height() : 0.0)));
        painter.setPen(Qt::NoPen);
        painter.setBrush(kPlate);
        painter.drawRoundedRect(plate, 5.0, 5.0);
        painter.setPen(kInk);
        painter.drawText(plate, Qt::AlignCenter, all[i]);
    }
}

MeasureTool::MeasureTool(model::Session& session, model::ViewState& options, ViewportWidget& viewport, QAction& action,
                         QObject* parent)
    : QObject(parent),
      session_(session),
      options_(options),
      viewport_(viewport),
      action_(action),
      view_(new MeasureView(viewport)) {
    connect(&action_, &QAction::toggled, this, [this](bool isOn) {
        isOn ? viewport_.setCursor(Qt::CrossCursor) : viewport_.unsetCursor();
        if (!isOn)
            setPlaces({});
    });
    connect(&viewport_, &ViewportWidget::clicked, this, &MeasureTool::take);
    connect(&viewport_, &ViewportWidget::cameraChanged, view_, qOverload<>(&QWidget::update));
    viewport_.installEventFilter(this);
    subscriptions_.push_back(options_.observe([this] { showPlaces(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { followDataset(); }));
    followDataset();
}

void MeasureTool::take(QPointF point) {
    const auto* dataset = session_.dataset();
    const auto frame = session_.pictureOf(session_.surfaces().list().active); // of whose grid the line is
    const auto line = viewport_.lineOfSight(point);
    if (!action_.isChecked() || dataset == nullptr || !frame || !line)
        return;
    const auto inWorld = [&](const glm::dvec3& place) {
        return model::centredWorldOf(place, frame->geometry, dataset->geometry);
    };
    const auto shown = model::shownSurfaces(session_, options_.options());
    if (const auto met = model::firstShownPlace(shown, options_.options().clipping, dataset->geometry,
                                                inWorld(line->first), inWorld(line->second)))
        setPlaces(model::withPlace(options_.options().measured, met->place));
}

void MeasureTool::setPlaces(model::MeasuredPlaces places) {
    auto options = options_.options();
    options.measured = std::move(places);
    options_.setOptions(options);
}

// Places that come back from a session or by an undo can be measured on with, and be forgotten.
void MeasureTool::showPlaces() {
    const auto* dataset = session_.dataset();
    const auto& places = options_.options().measured;
    if (!places.empty())
        action_.setChecked(true);
    view_->show(dataset != nullptr ? places : model::MeasuredPlaces{},
                dataset != nullptr ? dataset->lengthUnit : std::string{});
}

// Places are of one volume.
void MeasureTool::followDataset() {
    action_.setEnabled(session_.dataset() != nullptr);
    if (std::exchange(dataset_, session_.datasetGeneration()) != session_.datasetGeneration())
        action_.setChecked(false);
    showPlaces();
}

bool MeasureTool::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &viewport_ && event->type() == QEvent::Resize)
        view_->setGeometry(viewport_.rect());
    return QObject::eventFilter(watched, event);
}

} // namespace isoslider::widgets
