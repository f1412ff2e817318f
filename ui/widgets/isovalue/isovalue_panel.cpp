#include "ui/widgets/isovalue/isovalue_panel.h"

#include <array>
#include <utility>

#include <QAction>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFrame>
#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/model/isovalue/deviation_text.h"
#include "ui/model/isovalue/isovalue_words.h"
#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/widgets/common/icon_loader.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/text_colour.h"
#include "ui/widgets/isovalue/curve_overlay.h"
#include "ui/widgets/isovalue/detail_control.h"
#include "ui/widgets/isovalue/histogram_actions.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_edit.h"
#include "ui/widgets/isovalue/isovalue_notes.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

constexpr int kPlayIntervalMs = 16;
constexpr int kMargin = 8;

struct ModeName {
    const char* key;
    model::PlaybackMode mode;
};
constexpr std::array<ModeName, 3> kModes{{{"once", model::PlaybackMode::Once},
                                          {"loop", model::PlaybackMode::Loop},
                                          {"pingpong", model::PlaybackMode::PingPong}}};

} // namespace

IsovaluePanel::IsovaluePanel(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                             QWidget* parent)
    : QWidget(parent),
      session_(session),
      plot_(new HistogramPlot(this)),
      curves_(new CurveOverlay(session, settings, *plot_)),
      notes_(new IsovalueNotes(session, *plot_)),
      edit_(new IsovalueEdit(this)) {
    auto* layout = new QVBoxLayout(this);
    layout->setContentsMargins(kMargin, 6, kMargin, 8);
    layout->setSpacing(6);
    controls_ = makeControls(actions);
    layout->addWidget(new RowScroll(controls_, this));
    layout->addWidget(plot_, 1);
    connectControls(settings, actions);
    datasetSubscription_ = session_.datasetChanged().observe([this] { showDataset(); });
    isovalueSubscription_ = session_.isovalue().observe([this] { showIsovalue(); });
    showDataset();
    showIsovalue();
}

QWidget* IsovaluePanel::makeControls(const ActionRegistry& actions) {
    auto* row = new QWidget(this);
    auto* layout = new QHBoxLayout(row);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(6);
    auto* name = new QLabel(tr("Isovalue"), row);
    name->setBuddy(edit_);
    edit_->setFixedWidth(fontMetrics().horizontalAdvance(QStringLiteral("-0.00000000e+00")) + 16);
    range_ = new QLabel(row);
    makeQuiet(range_);
    mode_ = new QComboBox(row);
    mode_->setAccessibleName(tr("Animation mode"));
    mode_->addItems({tr("Once"), tr("Loop"), tr("Ping-pong")});
    speed_ = new QDoubleSpinBox(row);
    speed_->setAccessibleName(tr("Animation speed"));
    speed_->setRange(0.01, 100.0);
    speed_->setDecimals(2);
    speed_->setSuffix(tr(" %/s"));
    speed_->setToolTip(tr("Speed of the animation: percent of the value range per second"));
    for (QWidget* widget : {static_cast<QWidget*>(name), static_cast<QWidget*>(edit_), static_cast<QWidget*>(range_)})
        layout->addWidget(widget);
    layout->addWidget(makeSeparator(row));
    layout->addWidget(makeToolButton(actions.action("isovalue.play"), Qt::ToolButtonTextBesideIcon, row));
    layout->addWidget(mode_);
    layout->addWidget(speed_);
    layout->addWidget(makeSeparator(row));
    actions.action("isovalue.logCounts")->setIconText(tr("Log"));
    layout->addWidget(makeToolButton(actions.action("isovalue.logCounts"), Qt::ToolButtonTextOnly, row));
    layout->addWidget(curves_->makeButton(row));
    layout->addWidget(makeToolButton(actions.action("isovalue.resetZoom"), Qt::ToolButtonIconOnly, row));
    layout->addWidget(makeSeparator(row));
    detail_ = new DetailControl(session_, row);
    layout->addWidget(detail_);
    layout->addStretch(1);
    readouts_ = new QWidget(row);
    auto* readouts = new QHBoxLayout(readouts_);
    readouts->setContentsMargins(0, 0, 0, 0);
    readouts->setSpacing(6);
    requested_ = addReadout(readouts, tr("Requested"), "requestedReadout", readouts_);
    displayed_ = addReadout(readouts, tr("Displayed"), "displayedReadout", readouts_);
    elapsed_ = addReadout(readouts, tr("Update"), "elapsedReadout", readouts_);
    layout->addWidget(readouts_);
    return row;
}

void IsovaluePanel::connectControls(SettingsStore& settings, const ActionRegistry& actions) {
    auto& isovalue = session_.isovalue();
    connect(plot_, &HistogramPlot::isovalueRequested, this, [&isovalue](double value) { isovalue.request(value); });
    connect(plot_, &HistogramPlot::stepRequested, this, [&isovalue](double step) { isovalue.step(step); });
    connect(plot_, &HistogramPlot::handleHeld, this, [this](bool isHeld) { session_.detail().setMoving(isHeld); });
    QAction* coarser = actions.action("isovalue.coarserWhileMoving");
    coarser->setChecked(settings.boolean("detail/coarserWhileMoving"));
    session_.detail().setCoarserWhileMoving(coarser->isChecked());
    connect(coarser, &QAction::toggled, this, [this, &settings](bool isCoarser) {
        session_.detail().setCoarserWhileMoving(isCoarser);
        settings.set("detail/coarserWhileMoving", isCoarser);
    });
    connect(edit_, &IsovalueEdit::valueCommitted, this, [this, &isovalue](double value) {
        isovalue.request(value);
        notes_->noteTyped(value);
    });
    connect(plot_, &HistogramPlot::viewChanged, this, &IsovaluePanel::applyStepRule);
    connect(edit_, &IsovalueEdit::stepRequested, this, [&isovalue](double step) { isovalue.step(step); });

    new HistogramActions(session_, settings, actions, *plot_);
    optionsSubscription_ = session_.histogramOptions().observe([this] { applyStepRule(); });
    connect(actions.action("isovalue.edit"), &QAction::triggered, this, [this] {
        edit_->setFocus(Qt::ShortcutFocusReason);
        edit_->selectAll();
    });

    const QString modeKey = settings.text("playback/mode");
    for (std::size_t i = 0; i < kModes.size(); ++i)
        if (modeKey == QLatin1String(kModes[i].key))
            mode_->setCurrentIndex(static_cast<int>(i));
    playback_.setMode(kModes[static_cast<std::size_t>(mode_->currentIndex())].mode);
    speed_->setValue(settings.number("playback/percentPerSecond"));
    playback_.setSpeed(speed_->value() / 100.0);
    connect(mode_, &QComboBox::currentIndexChanged, this, [this, &settings](int index) {
        const auto& mode = kModes[static_cast<std::size_t>(index)];
        playback_.setMode(mode.mode);
        settings.set("playback/mode", QString(QLatin1String(mode.key)));
    });
    connect(speed_, &QDoubleSpinBox::valueChanged, this, [this, &settings](double percent) {
        playback_.setSpeed(percent / 100.0);
        settings.set("playback/percentPerSecond", percent);
    });
    play_ = actions.action("isovalue.play");
    playTip_ = play_->toolTip();
    connect(play_, &QAction::toggled, this, &IsovaluePanel::setPlaying);
    playTimer_.setInterval(kPlayIntervalMs);
    playTimer_.setTimerType(Qt::PreciseTimer);
    connect(&playTimer_, &QTimer::timeout, this, &IsovaluePanel::advance);
}

// The axis shows the range, the view what the readouts show: in a narrow window they give way before the controls have
// to be scrolled.
void IsovaluePanel::resizeEvent(QResizeEvent* event) {
    QWidget::resizeEvent(event);
    makeRoomForControls();
}

void IsovaluePanel::makeRoomForControls() {
    const std::array<QWidget*, 5> optional{mode_, speed_, detail_->measure(), readouts_, range_}; // the last goes first
    const auto widthOf = [this](const QWidget* widget) {
        return widget->sizeHint().width() + controls_->layout()->spacing();
    };
    detail_->layout()->activate(); // what it shows may just have changed
    int room = contentsRect().width() - 2 * kMargin - controls_->sizeHint().width();
    for (const QWidget* widget : optional)
        room += widget->isHidden() ? 0 : widthOf(widget);
    for (QWidget* widget : optional) {
        room -= widthOf(widget);
        widget->setVisible(room >= 0);
    }
}

void IsovaluePanel::setPlaying(bool isPlaying) {
    play_->setText(isPlaying ? tr("&Pause") : tr("&Play"));
    play_->setIconText(isPlaying ? tr("Pause") : tr("Play"));
    play_->setIcon(themedIcon(isPlaying ? QStringLiteral("pause") : QStringLiteral("play"), palette()));
    if (isPlaying && session_.isovalue().hasDomain()) {
        playback_.start(plot_->shareOf(session_.isovalue().requested()));
        playedValue_ = session_.isovalue().requested();
        playClock_.start();
        playTimer_.start();
    } else {
        playback_.stop();
        playTimer_.stop();
        if (isPlaying)
            play_->setChecked(false);
    }
}

void IsovaluePanel::advance() {
    auto& isovalue = session_.isovalue();
    const double seconds = static_cast<double>(playClock_.restart()) / 1000.0;
    if (isovalue.isLagging())
        return; // the surface is the clock: a slow one is played slowly, not in jumps
    if (isovalue.requested() != playedValue_) // the user took the handle: go on from there
        playback_.start(plot_->shareOf(isovalue.requested()));
    isovalue.request(plot_->valueAtShare(playback_.advance(seconds)));
    playedValue_ = isovalue.requested();
    if (!playback_.isPlaying() || !isovalue.hasDomain())
        play_->setChecked(false);
}

void IsovaluePanel::showDataset() {
    const auto* dataset = session_.dataset();
    const bool hasDataset = dataset != nullptr;
    edit_->setEnabled(hasDataset);
    edit_->setSpread(hasDataset ? std::optional(dataset->values->spread) : std::nullopt);
    showPlayback();
    if (!hasDataset) {
        range_->setText(tr("no volume"));
        return plot_->clearHistogram();
    }
    range_->setText((session_.isPreview() ? tr("in %1 … %2 of the preview") : tr("in %1 … %2"))
                        .arg(QString::fromStdString(model::isovalueText(dataset->min, dataset->min, dataset->max, 6)),
                             QString::fromStdString(model::isovalueText(dataset->max, dataset->min, dataset->max, 6))));
    static const std::vector<std::uint64_t> kNone;
    plot_->setValues(dataset->values, dataset->index ? dataset->index->activeEdgesPerBin : kNone);
    applyStepRule();
    if (std::exchange(shownDataset_, session_.datasetGeneration()) != session_.datasetGeneration())
        beginVolume();
}

// Of a volume of one value there is nothing to go through.
void IsovaluePanel::showPlayback() {
    const auto* dataset = session_.dataset();
    const bool isPossible = dataset != nullptr && dataset->min < dataset->max;
    for (QWidget* control : {static_cast<QWidget*>(mode_), static_cast<QWidget*>(speed_)})
        control->setEnabled(isPossible);
    if (!isPossible)
        play_->setChecked(false);
    play_->setEnabled(isPossible);
    play_->setToolTip(dataset != nullptr && !isPossible
                          ? tr("All samples have one value: there is nothing to play through")
                          : playTip_);
}

void IsovaluePanel::beginVolume() {
    plot_->showUsualRange(); // a zoom is of one volume, also where the next has the same range
    // The keys move the surface at once. What is being typed is not taken away.
    if (plot_->isVisible() && !edit_->hasFocus())
        plot_->setFocus(Qt::OtherFocusReason);
}

void IsovaluePanel::showIsovalue() {
    const auto& isovalue = session_.isovalue();
    const auto text = [&isovalue](double value) {
        return QString::fromStdString(model::isovalueText(value, isovalue.min(), isovalue.max()));
    };
    if (!isovalue.hasDomain()) {
        edit_->showNothing();
        showTips({});
        for (QLabel* label : {requested_, displayed_, elapsed_})
            setReadout(label, QStringLiteral("–"));
        return;
    }
    edit_->showValue(isovalue.requested());
    if (const auto* dataset = session_.dataset())
        showTips(QString::fromStdString(model::deviationsText(isovalue.requested(), dataset->values->spread)));
    setReadout(requested_, text(isovalue.requested()));
    const bool hasDisplayed = isovalue.hasDisplayed();
    setReadout(displayed_, hasDisplayed ? text(isovalue.displayed()) : QStringLiteral("–"));
    setReadout(elapsed_, hasDisplayed ? QString::fromStdString(model::millisecondsText(isovalue.lastUpdateMs()))
                                      : QStringLiteral("–"));
    makeRoomForControls();
    plot_->setIsovalues(isovalue.requested(), hasDisplayed ? isovalue.displayed() : isovalue.requested());
    applyStepRule(); // on a logarithmic axis, a step depends on where it is made
}

// `inDeviations`: the isovalue; may be empty.
void IsovaluePanel::showTips(const QString& inDeviations) {
    const QString how =
        tr("Isovalue in the volume's units, with a decimal point or comma, or in standard deviations from the mean, as "
           "“2.5 sigma”.\nEnter or leaving the field takes it; up and down step, with Shift 10 times finer.");
    edit_->setToolTip(inDeviations.isEmpty() ? how : how + QStringLiteral("\n") + tr("Now: %1").arg(inDeviations));
    requested_->setToolTip(inDeviations);
}

void IsovaluePanel::applyStepRule() {
    if (session_.isovalue().hasDomain())
        session_.isovalue().setStepRule(plot_->stepRule());
}

} // namespace isoslider::widgets
