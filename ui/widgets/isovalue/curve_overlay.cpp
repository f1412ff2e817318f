#include "ui/widgets/isovalue/curve_overlay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QAction>
#include <QCoreApplication>
#include <QEvent>
#include <QLabel>
#include <QMenu>
#include <QToolButton>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/topology/curve_scale.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/plot_style.h"
#include "ui/widgets/panels/fact_texts.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

using model::TopologyQuantity;

constexpr int kFrame = 2; // of the plot that has the keyboard
constexpr int kLowestPlot = 110; // below it, there is no room for a legend

struct CurveName {
    const char* key; ///< in the settings
    const char* text;
    const char* legend;
};
constexpr std::array<CurveName, model::kTopologyQuantities> kNames{
    {{"pieces", QT_TRANSLATE_NOOP("CurveOverlay", "&Pieces"), QT_TRANSLATE_NOOP("CurveOverlay", "pieces")},
     {"tunnels", QT_TRANSLATE_NOOP("CurveOverlay", "&Tunnels"), QT_TRANSLATE_NOOP("CurveOverlay", "tunnels")},
     {"area", QT_TRANSLATE_NOOP("CurveOverlay", "&Area"), QT_TRANSLATE_NOOP("CurveOverlay", "area")},
     {"volume", QT_TRANSLATE_NOOP("CurveOverlay", "&Volume Above"), QT_TRANSLATE_NOOP("CurveOverlay", "volume above")},
     {"triangles", QT_TRANSLATE_NOOP("CurveOverlay", "T&riangles"), QT_TRANSLATE_NOOP("CurveOverlay", "triangles")},
     {"gradient", QT_TRANSLATE_NOOP("CurveOverlay", "Mean &Gradient"),
      QT_TRANSLATE_NOOP("CurveOverlay", "mean gradient")}}};

QString translated(const char* text) { return QCoreApplication::translate("CurveOverlay", text); }

const CurveName& nameOf(TopologyQuantity quantity) { return kNames[static_cast<std::size_t>(quantity)]; }

template <class Function>
void forEachQuantity(Function&& function) {
    for (std::size_t i = 0; i < model::kTopologyQuantities; ++i)
        function(static_cast<TopologyQuantity>(i));
}

} // namespace

CurveOverlay::CurveOverlay(model::Session& session, SettingsStore& settings, HistogramPlot& plot)
    : QObject(&plot),
      session_(session),
      plot_(plot),
      axis_(plot.axisRect()->addAxis(QCPAxis::atLeft)),
      legend_(new QLabel(&plot)) {
    axis_->setVisible(false);
    axis_->setRange(0.0, 1.06);
    legend_->setObjectName(QStringLiteral("curveLegend"));
    legend_->setAttribute(Qt::WA_TransparentForMouseEvents);
    legend_->setTextFormat(Qt::RichText);
    legend_->setWordWrap(true);
    legend_->setMargin(3);
    readSettings(settings);
    makeActions();
    plot_.installEventFilter(this);
    applyPalette();
    connect(&plot_, &HistogramPlot::scaleChanged, this, &CurveOverlay::showCurves);
    subscriptions_.push_back(session_.histogramOptions().observe([this, &settings] { showChoices(settings); }));
    subscriptions_.push_back(session_.topology().changed().observe([this] { showCurves(); }));
    subscriptions_.push_back(session_.isovalue().observe([this] { showLegend(); }));
    showCurves();
}

void CurveOverlay::readSettings(const SettingsStore& settings) {
    auto options = session_.histogramOptions().options();
    options.curves.clear();
    for (const QString& name : settings.list("histogram/curves"))
        options.curves.push_back(name.toStdString());
    session_.histogramOptions().setOptions(options);
}

bool CurveOverlay::isChosen(TopologyQuantity quantity) const {
    const auto& chosen = session_.histogramOptions().options().curves;
    return std::find(chosen.begin(), chosen.end(), nameOf(quantity).key) != chosen.end();
}

void CurveOverlay::makeActions() {
    forEachQuantity([&](TopologyQuantity quantity) {
        Curve& curve = curveOf(quantity);
        curve.graph = plot_.addGraph(plot_.xAxis, axis_);
        // Counts change at once, measures little by little.
        if (quantity == TopologyQuantity::Pieces || quantity == TopologyQuantity::Tunnels)
            curve.graph->setLineStyle(QCPGraph::lsStepLeft);
        curve.action = new QAction(translated(nameOf(quantity).text), this);
        curve.action->setObjectName(QStringLiteral("curve.") + QLatin1String(nameOf(quantity).key));
        curve.action->setCheckable(true);
        curve.action->setChecked(isChosen(quantity));
        connect(curve.action, &QAction::triggered, this, &CurveOverlay::choose);
    });
}

void CurveOverlay::choose() {
    auto options = session_.histogramOptions().options();
    options.curves.clear();
    forEachQuantity([&](TopologyQuantity quantity) {
        if (curveOf(quantity).action->isChecked())
            options.curves.emplace_back(nameOf(quantity).key);
    });
    session_.histogramOptions().setOptions(options);
}

void CurveOverlay::showChoices(SettingsStore& settings) {
    QStringList chosen;
    forEachQuantity([&](TopologyQuantity quantity) {
        QAction& action = *curveOf(quantity).action;
        if (isChosen(quantity))
            chosen << QLatin1String(nameOf(quantity).key);
        action.setChecked(isChosen(quantity));
    });
    if (settings.list("histogram/curves") != chosen)
        settings.set("histogram/curves", chosen);
    if (std::exchange(drawn_, chosen) != chosen)
        showCurves();
}

QToolButton* CurveOverlay::makeButton(QWidget* parent) {
    auto* button = new QToolButton(parent);
    button->setObjectName(QStringLiteral("curvesButton"));
    button->setText(tr("Curves") + QStringLiteral("  ")); // the menu's arrow is drawn over the end
    button->setAccessibleName(tr("Curves"));
    button->setToolTip(tr("Curves of the surface's counts and measures over the histogram"));
    button->setAutoRaise(true);
    button->setFocusPolicy(Qt::TabFocus);
    button->setPopupMode(QToolButton::InstantPopup);
    auto* menu = new QMenu(button);
    menu->setToolTipsVisible(true);
    for (const Curve& curve : curves_)
        menu->addAction(curve.action);
    button->setMenu(menu);
    return button;
}

bool CurveOverlay::isShown(TopologyQuantity quantity) const {
    const Curve& curve = curves_[static_cast<std::size_t>(quantity)];
    return curve.action->isChecked() && !curve.graph->data()->isEmpty();
}

void CurveOverlay::showCurves() {
    const auto& topology = session_.topology();
    forEachQuantity([&](TopologyQuantity quantity) {
        Curve& curve = curveOf(quantity);
        const bool isKnown = topology.hasCurve(quantity);
        curve.action->setEnabled(isKnown);
        curve.action->setToolTip(isKnown ? tr("Scaled to its own greatest value") : tr("Not known for this volume"));
        const auto data = isKnown && curve.action->isChecked() ? topology.curve(quantity) : model::TopologyCurve();
        const auto scaled = model::scaled(data.values);
        curve.isLogarithmic = scaled.isLogarithmic;
        QVector<double> places;
        for (const double isovalue : data.isovalues)
            places.append(plot_.scale().placeOf(isovalue));
        curve.graph->setData(places, QVector<double>(scaled.heights.begin(), scaled.heights.end()), true);
    });
    plot_.replot(QCustomPlot::rpQueuedReplot);
    showLegend();
}

QString CurveOverlay::valueText(TopologyQuantity quantity, double value) const {
    const auto* dataset = session_.dataset();
    const std::string unit = dataset != nullptr ? dataset->lengthUnit : std::string();
    const QString number = fromStd(model::estimateText(value));
    switch (quantity) {
        case TopologyQuantity::Area: return inLengthUnit(number, unit, 2);
        case TopologyQuantity::Volume: return inLengthUnit(number, unit, 3);
        case TopologyQuantity::Gradient: return perLengthUnit(number, unit);
        default: break;
    }
    // Of curves, so between two samples: no whole number, and bounded in case of a damaged file.
    return fromStd(model::groupedText(static_cast<std::int64_t>(std::llround(std::clamp(value, -9e18, 9e18)))));
}

void CurveOverlay::showLegend() {
    const auto& isovalue = session_.isovalue();
    QStringList entries;
    forEachQuantity([&](TopologyQuantity quantity) {
        if (!isShown(quantity) || !isovalue.hasDomain())
            return;
        const auto value = session_.topology().valueAt(quantity, isovalue.requested());
        const Curve& curve = curveOf(quantity);
        const QString name = translated(nameOf(quantity).legend) + (curve.isLogarithmic ? tr(" (log)") : QString());
        QString entry = value ? tr("%1: %2").arg(name, valueText(quantity, *value)) : name;
        entry = entry.toHtmlEscaped().replace(QLatin1Char(' '), QStringLiteral("&nbsp;"));
        entries << QStringLiteral("<span style=\"color:%1\">■</span>&nbsp;%2")
                       .arg(curve.graph->pen().color().name(), entry);
    });
    legend_->setText(entries.join(QStringLiteral(" &nbsp; ")));
    placeLegend();
}

// Above the plot, where it covers neither data nor marks. In a low plot it gives way to them.
void CurveOverlay::placeLegend() {
    const int left = plot_.axisRect()->left(), width = std::max(1, plot_.width() - left - kFrame);
    legend_->setWordWrap(false);
    QSize size = legend_->sizeHint();
    if (size.width() > width) {
        legend_->setWordWrap(true);
        size = {width, legend_->heightForWidth(width)};
    }
    // Of the same curves as high as it ever was: the plot does not jump when a number gets longer.
    if (std::exchange(placed_, {drawn_, width}) != std::pair(drawn_, width))
        room_ = 0;
    room_ = std::max(room_, kFrame + size.height());
    const bool isShown = !legend_->text().isEmpty() && plot_.height() - room_ >= kLowestPlot;
    legend_->setGeometry(left, kFrame, size.width(), size.height());
    legend_->setVisible(isShown);
    plot_.setRoomAbove(isShown ? room_ : 0);
}

void CurveOverlay::applyPalette() {
    forEachQuantity(
        [this](TopologyQuantity quantity) { curveOf(quantity).graph->setPen(curvePen(quantity, plot_.palette())); });
}

bool CurveOverlay::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &plot_ && event->type() == QEvent::PaletteChange) {
        applyPalette();
        showLegend();
    } else if (watched == &plot_ && event->type() == QEvent::Resize) {
        QMetaObject::invokeMethod(this, &CurveOverlay::placeLegend,
                                  Qt::QueuedConnection); // once the plot has its new size
    }
    return QObject::eventFilter(watched, event);
}

} // namespace isoslider::widgets
