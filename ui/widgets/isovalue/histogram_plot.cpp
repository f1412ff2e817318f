#include "ui/widgets/isovalue/histogram_plot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QRubberBand>

#include "ui/model/isovalue/isovalue_words.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/isovalue/value_steps.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/isovalue/histogram_hints.h"
#include "ui/widgets/isovalue/isovalue_accessible.h"
#include "ui/widgets/isovalue/plot_style.h"

namespace isoslider::widgets {
namespace {

constexpr double kPad = 0.005; // of the axis, beyond each end of the range
constexpr double kSmallestRange = 1e-6; // of the whole
constexpr double kStepsInView = 1000.0;
constexpr double kMostWholeSteps = 65536.0;
constexpr int kPixelsPerColumn = 2;
constexpr int kMostTowers = 4;
constexpr std::size_t kColumnsBetweenTowers = 30;
constexpr double kTooFarApart = 0.05; // of the axis: a line between such points would be made up
constexpr int kMostTicks = 9;
constexpr int kTagHeight = 23; // of the handle's tag, above the axes
constexpr int kLowHeight = 90; // below it, there is room for the curve but not for its scale
constexpr std::size_t kMostStops = 1 << 17;
constexpr double kLeastEdgeBins = 12.0; // a curve of fewer points in view would be made up

} // namespace

HistogramPlot::HistogramPlot(QWidget* parent)
    : QCustomPlot(parent), selection_(new QRubberBand(QRubberBand::Rectangle, this)) {
    installIsovalueAccessibility(); // before assistive technology hears of this: what it is then, it stays
    setObjectName(QStringLiteral("histogramPlot"));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setMinimumSize(120, 40);
    setAccessibleName(tr("Isovalue"));
    setWhatsThis(tr("Drag to move the isosurface; Shift makes the drag finer; Ctrl with the wheel zooms."));
    setUpAxes();
    setUpHandle();
    hints_ = new HistogramHints(*this);
    applyPalette();
    clearHistogram();
}

void HistogramPlot::setUpAxes() {
    plotLayout()->setMargins(QMargins(0, 0, 4, 0));
    axisRect()->setAutoMargins(QCP::msLeft | QCP::msRight | QCP::msBottom);
    axisRect()->setMargins(QMargins(0, kTagHeight, 0, 0));
    axisRect()->setMinimumMargins(QMargins(44, kTagHeight, 44, 0));
    axisRect()->setRangeDrag(Qt::Orientations());
    counts_ = addGraph(xAxis, yAxis);
    counts_->setLineStyle(QCPGraph::lsStepLeft);
    counts_->setAdaptiveSampling(false);
    activeEdges_ = addGraph(xAxis, yAxis2);
    yAxis->setTicker(QSharedPointer<CompactTicker>::create());
    yAxis2->setTicker(QSharedPointer<CompactTicker>::create());
    ticker_ = QSharedPointer<ScaleTicker>::create();
    ticker_->setTickCount(kMostTicks);
    xAxis->setTicker(ticker_);
    connect(xAxis, qOverload<const QCPRange&>(&QCPAxis::rangeChanged), this, &HistogramPlot::clampRange);
}

void HistogramPlot::setUpHandle() {
    // Each has a buffer: when the handle moves, neither the histogram nor the marks are drawn again.
    QString below = QStringLiteral("overlay");
    for (const QString& name : {QStringLiteral("marks"), QStringLiteral("handle")}) {
        addLayer(name, layer(std::exchange(below, name)));
        layer(name)->setMode(QCPLayer::lmBuffered);
    }
    marks_ = new EventMarks(*this, QStringLiteral("marks"));
    hoverLine_ = new QCPItemStraightLine(this);
    displayedLine_ = new QCPItemStraightLine(this);
    requestedLine_ = new QCPItemStraightLine(this);
    tag_ = new QCPItemText(this);
    for (QCPAbstractItem* item :
         {static_cast<QCPAbstractItem*>(hoverLine_), static_cast<QCPAbstractItem*>(displayedLine_),
          static_cast<QCPAbstractItem*>(requestedLine_), static_cast<QCPAbstractItem*>(tag_)})
        item->setLayer(QStringLiteral("handle"));
    hoverLine_->setVisible(false);
    tag_->setClipToAxisRect(false);
    tag_->position->setTypeY(QCPItemPosition::ptAxisRectRatio);
    tag_->setPositionAlignment(Qt::AlignHCenter | Qt::AlignBottom);
    tag_->setPadding(QMargins(6, 1, 6, 2));
    for (int i = 0; i < kMostTowers; ++i) {
        auto* text = clipped_.emplace_back(new QCPItemText(this));
        text->setObjectName(QStringLiteral("clippedCount"));
        text->position->setTypeY(QCPItemPosition::ptAxisRectRatio);
        text->setPadding(QMargins(3, 0, 3, 0));
        text->setVisible(false);
    }
    emptyHint_ = new QCPItemText(this);
    emptyHint_->position->setType(QCPItemPosition::ptViewportRatio);
    emptyHint_->position->setCoords(0.5, 0.5);
}

void HistogramPlot::setRoomAbove(int pixels) {
    if (pixels == roomAbove())
        return;
    QMargins margins = axisRect()->margins();
    margins.setTop(kTagHeight + pixels);
    axisRect()->setMargins(margins);
    replot(QCustomPlot::rpQueuedReplot); // lays out
}

int HistogramPlot::roomAbove() const { return axisRect()->margins().top() - kTagHeight; }

void HistogramPlot::setValues(std::shared_ptr<const ValueDistribution> given,
                              const std::vector<std::uint64_t>& activeEdges) {
    if (hasHistogram_ && given.get() == &view_.values() && activeEdges == activeEdgeCounts_)
        return;
    view_ = model::HistogramView(std::move(given));
    const ValueDistribution& values = view_.values();
    const bool isSameRange = hasHistogram_ && min_ == values.min && max_ == values.max;
    min_ = values.min;
    max_ = values.max;
    hasHistogram_ = true;
    activeEdgeCounts_ = activeEdges;
    sampleValues_.reset();
    if (values.isEachValue && values.cells.size() <= kMostStops) {
        auto stops = std::make_shared<std::vector<double>>();
        for (const ValueCell& cell : values.cells)
            stops->push_back(cell.lower);
        sampleValues_ = std::move(stops);
    }
    for (QCPAxis* axis : {xAxis, yAxis})
        axis->setVisible(true);
    emptyHint_->setVisible(false);
    const auto shown = xAxis->range();
    const auto before = scale_;
    applyScale();
    if (!isSameRange || isAtUsualRange_ || !(before == scale_))
        showUsualRange();
    else
        showPlaces(shown);
}

void HistogramPlot::clearHistogram() {
    hasHistogram_ = false;
    view_ = {};
    outline_ = {};
    min_ = max_ = requested_ = displayed_ = 0.0;
    activeEdgeCounts_.clear();
    sampleValues_.reset();
    counts_->data()->clear();
    activeEdges_->data()->clear();
    markClipped({});
    for (QCPAxis* axis : {xAxis, yAxis, yAxis2})
        axis->setVisible(false);
    emptyHint_->setVisible(true);
    placeHandle();
    hints_->update();
    replot();
}

void HistogramPlot::setIsovalues(double requested, double displayed) {
    requested_ = requested;
    displayed_ = displayed;
    placeHandle();
    layer(QStringLiteral("handle"))->replot();
}

void HistogramPlot::setOptions(const model::HistogramOptions& options) {
    const auto before = std::exchange(options_, options);
    if (!hasHistogram_)
        return;
    if (before.valueScale != options.valueScale) {
        const auto shown = visibleRange();
        applyScale();
        if (isAtUsualRange_)
            return showUsualRange();
        return showPlaces(endsOf({shown.lower, shown.upper}));
    }
    applyOutline();
    replot();
}

void HistogramPlot::applyScale() {
    scale_ = model::ValueScale::fitting(options_.valueScale, view_.values());
    ticker_->setScale(scale_);
    marks_->setScale(scale_);
    QVector<double> places, edges;
    const std::size_t bins = activeEdgeCounts_.size();
    const double gap = kTooFarApart * placesOf(view_.wholeRange()).size();
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const double place =
            scale_.placeOf(std::lerp(min_, max_, static_cast<double>(bin) / static_cast<double>(bins)));
        if (!places.isEmpty() && place - places.last() > gap) {
            places.append((places.last() + place) / 2.0);
            edges.append(std::nan(""));
        }
        places.append(place);
        edges.append(static_cast<double>(activeEdgeCounts_[bin]));
    }
    activeEdges_->setData(places, edges, true);
    Q_EMIT scaleChanged();
}

void HistogramPlot::setEventMarks(std::vector<EventMark> marks, std::function<QString(std::size_t)> describe) {
    marks_->setMarks(std::move(marks));
    describeEvent_ = std::move(describe);
    layer(QStringLiteral("marks"))->replot();
}

void HistogramPlot::setChosenEvent(std::optional<std::size_t> event) {
    marks_->setChosen(event);
    layer(QStringLiteral("marks"))->replot();
}

// What is in view sets the height: closer in, columns hold fewer samples.
void HistogramPlot::applyOutline() {
    if (!hasHistogram_)
        return;
    outline_ = view_.outline(scale_, xAxis->range().lower, xAxis->range().upper,
                             std::max(1, axisRect()->width() / kPixelsPerColumn));
    const auto& outline = outline_;
    QVector<double> places(outline.places.begin(), outline.places.end());
    QVector<double> counts(outline.counts.begin(), outline.counts.end());
    if (!counts.isEmpty())
        counts.append(counts.last());
    counts_->setData(places, counts, true);
    const double most = counts.isEmpty() ? 1.0 : std::max(1.0, *std::max_element(counts.begin(), counts.end()));
    const auto top = model::HistogramView::topOf(outline, options_.clipsCounts);
    const bool isClipped = !options_.hasLogCounts && top.isClipped;
    if (options_.hasLogCounts) {
        yAxis->setScaleType(QCPAxis::stLogarithmic);
        yAxis->setTicker(QSharedPointer<CompactLogTicker>::create());
        yAxis->setRange(0.7, most * 2.0);
    } else {
        yAxis->setScaleType(QCPAxis::stLinear);
        yAxis->setTicker(QSharedPointer<CompactTicker>::create());
        yAxis->setRange(0.0, std::max(1.0, top.height));
    }
    markClipped(isClipped ? outline : model::HistogramView::Outline());
    double mostEdges = 1.0;
    for (const auto count : activeEdgeCounts_)
        mostEdges = std::max(mostEdges, static_cast<double>(count));
    yAxis2->setRange(0.0, mostEdges * 1.08);
    const auto usual = view_.usualRange();
    const double share = (usual.upper - usual.lower) / std::max(max_ - min_, 1e-300);
    const bool showsEdges =
        !activeEdgeCounts_.empty() && share * static_cast<double>(activeEdgeCounts_.size()) >= kLeastEdgeBins;
    yAxis2->setVisible(showsEdges);
    activeEdges_->setVisible(showsEdges);
    applyTickCounts();
}

// Towers that are side by side are one.
void HistogramPlot::markClipped(const model::HistogramView::Outline& outline) {
    struct Tower {
        std::size_t begin, end;
        double count;
    };
    std::vector<Tower> towers;
    for (std::size_t column = 0; column < outline.counts.size(); ++column) {
        if (outline.counts[column] <= yAxis->range().upper)
            continue;
        if (towers.empty() || towers.back().end + kColumnsBetweenTowers < column)
            towers.push_back({column, column + 1, 0.0});
        towers.back().end = column + 1;
        towers.back().count = std::max(towers.back().count, outline.counts[column]);
    }
    std::sort(towers.begin(), towers.end(), [](const Tower& a, const Tower& b) { return a.count > b.count; });
    for (std::size_t i = 0; i < clipped_.size(); ++i) {
        clipped_[i]->setVisible(i < towers.size());
        if (i >= towers.size())
            continue;
        const double begin = outline.places[towers[i].begin], end = outline.places[towers[i].end];
        const bool isLeft = begin < xAxis->range().center();
        const auto count = static_cast<std::uint64_t>(towers[i].count);
        clipped_[i]->setText(
            QString(isLeft ? tr("▲ %1") : tr("%1 ▲")).arg(QString::fromStdString(model::compactText(count))));
        clipped_[i]->setPositionAlignment((isLeft ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignTop);
        clipped_[i]->position->setCoords(isLeft ? end : begin, 0.0);
    }
}

void HistogramPlot::applyTickCounts() {
    const QString hint = tr("The histogram of a volume stands here, with the isovalue handle on it.");
    emptyHint_->setText(fontMetrics().horizontalAdvance(hint) < width() ? hint : tr("Histogram"));
    const int labels = std::clamp(height() / (2 * fontMetrics().height()), 2, 6);
    const bool isLow = height() < kLowHeight;
    for (QCPAxis* axis : {yAxis, yAxis2}) {
        axis->ticker()->setTickCount(labels);
        axis->setTickLabels(!isLow);
    }
    yAxis->setLabel(isLow ? QString() : tr("samples"));
    yAxis2->setLabel(isLow ? QString() : tr("active edges"));
    const int widest = fontMetrics().horizontalAdvance(QStringLiteral("-0000000"));
    ticker_->setTickCount(std::clamp(axisRect()->width() / (2 * widest), 1, kMostTicks));
}

QCPRange HistogramPlot::endsOf(const model::HistogramView::Range& range) const {
    // Half a bin below the least value may be below what a logarithm has.
    const bool isLog = scale_.kind() == model::ScaleKind::Log;
    const double lower = isLog ? std::max(range.lower, std::max(min_ * 0.7, 1e-300)) : range.lower;
    return {scale_.placeOf(lower), scale_.placeOf(std::max(range.upper, lower))};
}

QCPRange HistogramPlot::placesOf(const model::HistogramView::Range& range) const {
    const QCPRange ends = endsOf(range);
    const double low = ends.lower, high = ends.upper;
    // A volume of one value still gets an axis to stand on.
    const double pad = high > low ? kPad * (high - low) : std::max(std::abs(high) * 0.01, 0.5);
    return {low - pad, high + pad};
}

void HistogramPlot::showPlaces(const QCPRange& places) {
    xAxis->setRange(places);
    applyOutline();
    placeHandle();
    hints_->update();
    Q_EMIT viewChanged();
    replot(QCustomPlot::rpQueuedReplot);
}

void HistogramPlot::showUsualRange() {
    isAtUsualRange_ = true;
    if (hasHistogram_)
        showPlaces(placesOf(view_.usualRange()));
}

void HistogramPlot::showWholeRange() {
    isAtUsualRange_ = !view_.hasOutliers();
    if (hasHistogram_)
        showPlaces(placesOf(view_.wholeRange()));
}

void HistogramPlot::showRange(const model::HistogramRange& range) {
    const QCPRange places = endsOf({range.lower, range.upper}); // what was seen, no more
    if (!hasHistogram_ || !(places.size() > 0.0))
        return;
    isAtUsualRange_ = false;
    showPlaces(places);
}

std::optional<model::HistogramRange> HistogramPlot::chosenRange() const {
    if (!hasHistogram_ || isAtUsualRange_)
        return std::nullopt;
    const QCPRange shown = visibleRange();
    return model::HistogramRange{shown.lower, shown.upper};
}

void HistogramPlot::showHandle() {
    const auto whole = placesOf(view_.wholeRange());
    const double place = scale_.placeOf(requested_);
    if (!hasHistogram_ || xAxis->range().contains(place))
        return;
    isAtUsualRange_ = false;
    const double half = xAxis->range().size() / 2.0;
    // Far away, as wide as lets both the usual range and the handle be seen.
    const auto usual = placesOf(view_.usualRange());
    const double away = place < usual.lower ? usual.lower - place : place - usual.upper;
    if (away > 20.0 * half)
        return showPlaces({std::min(usual.lower, place - 0.05 * away), std::max(usual.upper, place + 0.05 * away)});
    const double centre =
        std::clamp(place, std::min(whole.lower + half, whole.center()), std::max(whole.upper - half, whole.center()));
    showPlaces({centre - half, centre + half});
}

void HistogramPlot::clampRange(const QCPRange& range) {
    const auto whole = placesOf(view_.wholeRange());
    if (!hasHistogram_ || !(whole.size() > 0.0) || !(max_ > min_))
        return;
    const double size = std::min(range.size(), whole.size());
    const double lower = std::clamp(range.lower, whole.lower, std::max(whole.lower, whole.upper - size));
    if (range.lower != lower || range.size() != size)
        xAxis->setRange(lower, lower + size);
}

void HistogramPlot::placeHandle() {
    const double place = scale_.placeOf(requested_);
    const bool isLagging = hasHistogram_ && displayed_ != requested_;
    requestedLine_->setVisible(hasHistogram_);
    displayedLine_->setVisible(isLagging);
    tag_->setVisible(hasHistogram_ && xAxis->range().contains(place));
    requestedLine_->point1->setCoords(place, 0.0);
    requestedLine_->point2->setCoords(place, 1.0);
    displayedLine_->point1->setCoords(scale_.placeOf(displayed_), 0.0);
    displayedLine_->point2->setCoords(scale_.placeOf(displayed_), 1.0);
    const QString text = QString::fromStdString(model::isovalueText(requested_, min_, max_));
    tag_->setText(text);
    tag_->position->setCoords(place, -0.01);
    // Near an end the tag leans inwards instead of being cut off.
    const double pixel = hasHistogram_ ? xAxis->coordToPixel(place) : 0.0;
    const double half = fontMetrics().horizontalAdvance(text) / 2.0 + 10.0;
    const Qt::AlignmentFlag lean = pixel - half < 0         ? Qt::AlignLeft
                                   : pixel + half > width() ? Qt::AlignRight
                                                            : Qt::AlignHCenter;
    tag_->setPositionAlignment(lean | Qt::AlignBottom);
    setAccessibleDescription(hasHistogram_ ? text : tr("no volume"));
    announceValue(*this);
    hints_->updateHandle();
}

double HistogramPlot::placePerPixel() const { return xAxis->range().size() / std::max(1, axisRect()->width()); }

double HistogramPlot::resolutionAt(double value) const {
    const double place = scale_.placeOf(value), half = placePerPixel() / 2.0;
    return scale_.valueAt(place + half) - scale_.valueAt(place - half);
}

model::StepRule HistogramPlot::stepRule() const {
    model::StepRule rule;
    if (!hasHistogram_ || !(max_ > min_))
        return rule;
    if (options_.snapsToSamples)
        rule.stops = sampleValues_;
    const QCPRange places = xAxis->range();
    // In view the axis is as close as the user wants it; where the handle is not, so is its step.
    const double at = std::clamp(scale_.placeOf(requested_), places.lower, places.upper);
    const double half = places.size() / kStepsInView / 2.0;
    const double even = scale_.valueAt(at + half) - scale_.valueAt(at - half);
    const bool isWhole = view_.values().spacing == 1.0;
    rule.unit = model::roundStep(isWhole ? std::max(1.0, even * kStepsInView / kMostWholeSteps) : even * 1.4);
    return rule;
}

double HistogramPlot::shareOf(double value) const {
    auto places = placesOf(view_.usualRange());
    const double place = scale_.placeOf(value);
    if (!places.contains(place))
        places = placesOf(view_.wholeRange());
    return std::clamp((place - places.lower) / places.size(), 0.0, 1.0);
}

double HistogramPlot::valueAtShare(double share) const {
    const bool isUsual = placesOf(view_.usualRange()).contains(scale_.placeOf(requested_));
    const auto places = placesOf(isUsual ? view_.usualRange() : view_.wholeRange());
    const double value = scale_.valueAt(places.lower + share * places.size());
    return std::clamp(model::nearestMultiple(value, model::roundStep(resolutionAt(value) / 10.0)), min_, max_);
}

void HistogramPlot::zoomAt(double place, double factor) {
    const QCPRange range = xAxis->range();
    const double whole = placesOf(view_.wholeRange()).size(), usual = placesOf(view_.usualRange()).size();
    if (!hasHistogram_ || (factor > 1.0 && range.size() / factor < std::min(whole, usual) * kSmallestRange))
        return;
    isAtUsualRange_ = false;
    showPlaces({place - (place - range.lower) / factor, place + (range.upper - place) / factor});
}

void HistogramPlot::zoom(double factor) {
    const double handle = scale_.placeOf(requested_);
    zoomAt(xAxis->range().contains(handle) ? handle : xAxis->range().center(), factor);
}

void HistogramPlot::changeEvent(QEvent* event) {
    QCustomPlot::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && counts_ != nullptr) {
        applyPalette();
        replot(QCustomPlot::rpQueuedReplot);
    }
}

void HistogramPlot::resizeEvent(QResizeEvent* event) {
    QCustomPlot::resizeEvent(event);
    applyTickCounts();
    applyOutline();
    placeHandle();
    Q_EMIT viewChanged();
    replot(QCustomPlot::rpQueuedReplot);
}

void HistogramPlot::paintEvent(QPaintEvent* event) {
    QCustomPlot::paintEvent(event);
    if (!hasFocus())
        return;
    QPainter painter(this);
    painter.setPen(QPen(palette().color(QPalette::Highlight), 2.0));
    painter.drawRect(QRectF(rect()).adjusted(1.0, 1.0, -1.0, -1.0));
}

void HistogramPlot::focusInEvent(QFocusEvent* event) {
    QCustomPlot::focusInEvent(event);
    applyFocus();
}

void HistogramPlot::focusOutEvent(QFocusEvent* event) {
    QCustomPlot::focusOutEvent(event);
    applyFocus();
}

void HistogramPlot::applyFocus() {
    tag_->setPen(hasFocus() ? QPen(palette().color(QPalette::Text), 1.0) : Qt::NoPen);
    layer(QStringLiteral("handle"))->replot();
    update();
}

void HistogramPlot::applyPalette() {
    const PlotColours colours = plotColours(palette());
    setBackground(palette().brush(QPalette::Base));
    counts_->setPen(QPen(colours.counts, 1.0));
    counts_->setBrush(colours.countsFill);
    activeEdges_->setPen(QPen(colours.curve, 1.4));
    requestedLine_->setPen(QPen(colours.handle, 2.0));
    displayedLine_->setPen(QPen(colours.handle, 1.0, Qt::DashLine));
    const QColor quiet = quietTextColour(palette(), QPalette::Text, QPalette::Base);
    hoverLine_->setPen(QPen(quiet, 1.0, Qt::DotLine));
    tag_->setBrush(colours.handle);
    tag_->setColor(colours.handleText);
    QColor base = palette().color(QPalette::Base);
    base.setAlpha(200);
    for (QCPItemText* text : clipped_) {
        text->setBrush(base);
        text->setColor(quiet);
    }
    emptyHint_->setColor(quiet);
    for (QCPAxis* axis : {xAxis, yAxis, yAxis2})
        styleAxis(axis, palette());
    yAxis2->setLabelColor(colours.curve);
    yAxis2->setTickLabelColor(colours.curve);
    yAxis2->grid()->setVisible(false);
    hints_->applyPalette();
}

} // namespace isoslider::widgets
