#include "ui/widgets/isovalue/event_marks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ui/widgets/isovalue/plot_style.h"

namespace isoslider::widgets {
namespace {

constexpr double kColumnPixels = 3.0;
constexpr double kGlyphRadius = 4.0;
constexpr double kChosenRadius = 5.5;
constexpr double kHitPixels = 5.0;
// Between two marks, by the weaker one: a hundred of the same kind would be a hedge before the histogram.
constexpr double kStrongApart = 10.0, kWeakApart = 30.0;
constexpr int kStemAlpha = 150;
constexpr double kLowest = 9.0; // pixels from the axis to the middle of a symbol
constexpr double kTallest = 0.4; // of the height of the plot: the rest is the handle's alone

QPolygonF polygon(std::initializer_list<QPointF> corners, QPointF centre, double radius) {
    QPolygonF shape;
    for (const QPointF& corner : corners)
        shape << centre + radius * corner;
    return shape;
}

} // namespace

void drawEventGlyph(QPainter& painter, model::EventClass kind, QPointF centre, double radius, const QPalette& palette) {
    painter.setPen(QPen(palette.color(QPalette::Base), 1.0));
    painter.setBrush(eventColour(kind, palette));
    switch (kind) {
        case model::EventClass::PieceComes:
            painter.drawPolygon(polygon({{0.0, -1.15}, {1.1, 0.85}, {-1.1, 0.85}}, centre, radius));
            break;
        case model::EventClass::PieceGoes:
            painter.drawPolygon(polygon({{0.0, 1.15}, {1.1, -0.85}, {-1.1, -0.85}}, centre, radius));
            break;
        case model::EventClass::PiecesJoin: painter.drawEllipse(centre, radius, radius); break;
        case model::EventClass::PieceSplits:
            painter.drawPolygon(polygon({{0.0, -1.25}, {1.1, 0.0}, {0.0, 1.25}, {-1.1, 0.0}}, centre, radius));
            break;
        case model::EventClass::Other:
            painter.drawRect(QRectF(centre.x() - 0.7 * radius, centre.y() - 0.7 * radius, 1.4 * radius, 1.4 * radius));
            break;
    }
}

QPixmap eventGlyph(model::EventClass kind, int size, qreal devicePixelRatio, const QPalette& palette) {
    QPixmap picture(QSize(size, size) * devicePixelRatio);
    picture.setDevicePixelRatio(devicePixelRatio);
    picture.fill(Qt::transparent);
    QPainter painter(&picture);
    painter.setRenderHint(QPainter::Antialiasing);
    drawEventGlyph(painter, kind, QPointF(size / 2.0, size / 2.0), size * 0.36, palette);
    return picture;
}

EventMarks::EventMarks(QCustomPlot& plot, const QString& layer) : QCPLayerable(&plot, layer) {}

void EventMarks::setMarks(std::vector<EventMark> marks) {
    marks_ = std::move(marks);
    isDrawnKnown_ = false;
}

void EventMarks::setScale(const model::ValueScale& scale) {
    scale_ = scale;
    isDrawnKnown_ = false;
}

void EventMarks::setChosen(std::optional<std::size_t> event) {
    chosen_ = event;
    isDrawnKnown_ = false;
}

const std::vector<EventMarks::Drawn>& EventMarks::drawn() const {
    const QCPAxis& axis = *mParentPlot->xAxis;
    const QRect rect = mParentPlot->axisRect()->rect();
    if (isDrawnKnown_ && drawnRange_.lower == axis.range().lower && drawnRange_.upper == axis.range().upper &&
        drawnRect_ == rect)
        return drawn_;
    drawnRange_ = axis.range();
    drawnRect_ = rect;
    isDrawnKnown_ = true;
    drawn_.clear();
    const double tallest = std::max(kLowest, kTallest * rect.height());
    long column = 0;
    const auto isBetter = [this](const EventMark& a, const EventMark& b) {
        const bool isChosen = chosen_ == a.event, wasChosen = chosen_ == b.event;
        return isChosen != wasChosen ? isChosen : a.share > b.share;
    };
    const auto begin = std::lower_bound(marks_.begin(), marks_.end(), scale_.valueAt(drawnRange_.lower),
                                        [](const EventMark& mark, double value) { return mark.isovalue < value; });
    const double last = scale_.valueAt(drawnRange_.upper);
    for (auto mark = begin; mark != marks_.end() && mark->isovalue <= last; ++mark) {
        const double pixel = axis.coordToPixel(scale_.placeOf(mark->isovalue));
        if (!std::isfinite(pixel))
            continue;
        const long own = std::lround(std::floor((pixel - rect.left()) / kColumnPixels));
        // The square root keeps weak ones apart; the ratio is finite, see TopologyModel::greatestPersistence().
        const double height = std::lerp(kLowest, tallest, std::sqrt(std::clamp(mark->share, 0.0, 1.0)));
        const Drawn one{static_cast<std::size_t>(mark - marks_.begin()), pixel, rect.bottom() - height};
        if (drawn_.empty() || own != column)
            drawn_.push_back(one);
        else if (isBetter(*mark, marks_[drawn_.back().mark]))
            drawn_.back() = one;
        column = own;
    }
    thinOut();
    return drawn_;
}

// The strongest first, each where it is far enough from those that are there. At most some hundreds: one a column.
void EventMarks::thinOut() const {
    std::vector<Drawn> order = drawn_;
    const auto isChosen = [this](const Drawn& one) { return chosen_ == marks_[one.mark].event; };
    std::stable_sort(order.begin(), order.end(), [&](const Drawn& a, const Drawn& b) {
        return isChosen(a) != isChosen(b) ? isChosen(a) : shareOf(a) > shareOf(b);
    });
    drawn_.clear();
    for (const Drawn& one : order) {
        const double apart = std::lerp(kWeakApart, kStrongApart, std::sqrt(shareOf(one)));
        if (std::none_of(drawn_.begin(), drawn_.end(),
                         [&](const Drawn& other) { return std::abs(other.pixel - one.pixel) < apart; }))
            drawn_.push_back(one);
    }
    std::sort(drawn_.begin(), drawn_.end(), [](const Drawn& a, const Drawn& b) { return a.pixel < b.pixel; });
}

const EventMark* EventMarks::markNear(double pixel, double reach) const {
    const Drawn* nearest = nullptr;
    for (const Drawn& one : drawn()) {
        const double away = std::abs(one.pixel - pixel);
        if (away <= reach && (nearest == nullptr || away < std::abs(nearest->pixel - pixel)))
            nearest = &one;
    }
    return nearest != nullptr ? &marks_[nearest->mark] : nullptr;
}

// Where several lie below the pointer, the one whose symbol is nearest.
const EventMark* EventMarks::markAt(QPointF place) const {
    const Drawn* nearest = nullptr;
    double least = 0.0;
    for (const Drawn& one : drawn()) {
        const double aside = std::abs(one.pixel - place.x());
        if (aside > kHitPixels || place.y() < one.top - kHitPixels || place.y() > drawnRect_.bottom() + 1)
            continue;
        const double away = aside + 0.1 * std::abs(one.top - place.y());
        if (nearest == nullptr || away < least) {
            nearest = &one;
            least = away;
        }
    }
    return nearest != nullptr ? &marks_[nearest->mark] : nullptr;
}

std::optional<QPointF> EventMarks::placeOf(std::size_t event) const {
    for (const Drawn& one : drawn())
        if (marks_[one.mark].event == event)
            return QPointF(one.pixel, one.top);
    return std::nullopt;
}

std::size_t EventMarks::drawnCount() const { return drawn().size(); }

void EventMarks::applyDefaultAntialiasingHint(QCPPainter* painter) const { painter->setAntialiasing(true); }

QRect EventMarks::clipRect() const { return mParentPlot->axisRect()->rect().adjusted(-8, 0, 8, 2); }

// Symbols of the more persistent ones come first; where a symbol would touch one of them, the line alone remains.
void EventMarks::draw(QCPPainter* painter) {
    const QPalette palette = mParentPlot->palette();
    std::vector<const Drawn*> order;
    for (const Drawn& one : drawn())
        order.push_back(&one);
    const auto rank = [this](const Drawn* one) {
        const EventMark& mark = marks_[one->mark];
        return std::pair(chosen_ == mark.event, mark.share);
    };
    std::sort(order.begin(), order.end(), [&](const Drawn* a, const Drawn* b) { return rank(a) > rank(b); });
    for (auto at = order.rbegin(); at != order.rend(); ++at) {
        const EventMark& mark = marks_[(*at)->mark];
        QColor stem = eventColour(mark.kind, palette);
        stem.setAlpha(chosen_ == mark.event ? 255 : kStemAlpha);
        painter->setPen(QPen(stem, chosen_ == mark.event ? 2.2 : 1.2));
        painter->drawLine(QPointF((*at)->pixel, (*at)->top), QPointF((*at)->pixel, drawnRect_.bottom()));
    }
    std::vector<QPointF> taken;
    for (const Drawn* one : order) {
        const EventMark& mark = marks_[one->mark];
        const QPointF centre(one->pixel, one->top);
        const bool isFree = std::none_of(taken.begin(), taken.end(), [&](QPointF other) {
            return std::abs(other.x() - centre.x()) < 2.0 * kGlyphRadius &&
                   std::abs(other.y() - centre.y()) < 2.2 * kGlyphRadius;
        });
        if (!isFree)
            continue;
        taken.push_back(centre);
        const bool isChosen = chosen_ == mark.event;
        if (isChosen) {
            painter->setPen(QPen(palette.color(QPalette::Text), 1.4));
            painter->setBrush(palette.brush(QPalette::Base));
            painter->drawEllipse(centre, kChosenRadius + 3.0, kChosenRadius + 3.0);
        }
        drawEventGlyph(*painter, mark.kind, centre, isChosen ? kChosenRadius : kGlyphRadius, palette);
    }
}

} // namespace isoslider::widgets
