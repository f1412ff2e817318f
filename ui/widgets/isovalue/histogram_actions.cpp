#include "ui/widgets/isovalue/histogram_actions.h"

#include <array>
#include <string>
#include <utility>

#include <QAction>
#include <QActionGroup>
#include <QMenu>

#include "ui/model/session/session.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

using model::HistogramOptions;
using model::ScaleKind;

constexpr double kZoom = 2.0;

constexpr std::array<std::pair<const char*, ScaleKind>, 3> kScales{{{"isovalue.linearValues", ScaleKind::Linear},
                                                                    {"isovalue.logValues", ScaleKind::Log},
                                                                    {"isovalue.symlogValues", ScaleKind::Symlog}}};

struct Switch {
    const char* action;
    const char* setting;
    bool HistogramOptions::*member;
};
constexpr std::array<Switch, 4> kSwitches{
    {{"isovalue.logCounts", "histogram/logCounts", &HistogramOptions::hasLogCounts},
     {"isovalue.clipCounts", "histogram/clipCounts", &HistogramOptions::clipsCounts},
     {"isovalue.snapToSamples", "isovalue/snapsToSamples", &HistogramOptions::snapsToSamples},
     {"isovalue.snap", "isovalue/snapsToEvents", &HistogramOptions::snapsToEvents}}};

} // namespace

HistogramActions::HistogramActions(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                                   HistogramPlot& plot)
    : QObject(&plot), session_(session), settings_(settings), actions_(actions), plot_(plot) {
    readSettings();
    auto* scales = new QActionGroup(this);
    for (const auto& [id, kind] : kScales) {
        QAction* action = actions_.action(id);
        scales->addAction(action);
        connect(action, &QAction::triggered, this,
                [this, kind = kind] { change([kind](HistogramOptions& options) { options.valueScale = kind; }); });
    }
    for (const auto& one : kSwitches)
        connect(actions_.action(one.action), &QAction::toggled, this, [this, member = one.member](bool isOn) {
            change([&](HistogramOptions& options) { options.*member = isOn; });
        });
    connect(actions_.action("isovalue.resetZoom"), &QAction::triggered, &plot_, &HistogramPlot::showUsualRange);
    connect(actions_.action("isovalue.wholeRange"), &QAction::triggered, &plot_, &HistogramPlot::showWholeRange);
    connect(actions_.action("isovalue.showHandle"), &QAction::triggered, &plot_, &HistogramPlot::showHandle);
    connect(actions_.action("isovalue.zoomIn"), &QAction::triggered, &plot_, [this] { plot_.zoom(kZoom); });
    connect(actions_.action("isovalue.zoomOut"), &QAction::triggered, &plot_, [this] { plot_.zoom(1.0 / kZoom); });
    plot_.setContextMenuPolicy(Qt::CustomContextMenu);
    connect(&plot_, &HistogramPlot::customContextMenuRequested, this, &HistogramActions::openMenu);
    subscriptions_.push_back(session_.histogramOptions().observe([this] { showOptions(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { updateActions(); }));
    showOptions();
    updateActions();
}

void HistogramActions::readSettings() {
    HistogramOptions options = session_.histogramOptions().options(); // its curves
    options.valueScale =
        model::scaleFromName(settings_.text("histogram/valueScale").toStdString()).value_or(ScaleKind::Linear);
    for (const auto& one : kSwitches)
        options.*one.member = settings_.boolean(one.setting);
    session_.histogramOptions().setOptions(options);
}

template <class Change>
void HistogramActions::change(Change&& change) {
    auto options = session_.histogramOptions().options();
    change(options);
    session_.histogramOptions().setOptions(options);
}

void HistogramActions::showOptions() {
    const auto options = session_.histogramOptions().options();
    for (const auto& [id, kind] : kScales)
        actions_.action(id)->setChecked(options.valueScale == kind);
    for (const auto& one : kSwitches) {
        actions_.action(one.action)->setChecked(options.*one.member);
        if (settings_.boolean(one.setting) != options.*one.member)
            settings_.set(one.setting, options.*one.member);
    }
    const auto name = model::scaleName(options.valueScale);
    const QString scale = QString::fromUtf8(name.data(), static_cast<qsizetype>(name.size()));
    if (settings_.text("histogram/valueScale") != scale)
        settings_.set("histogram/valueScale", scale);
    plot_.setOptions(options);
    updateActions();
}

void HistogramActions::updateActions() {
    const bool hasDataset = session_.dataset() != nullptr;
    for (const char* id :
         {"isovalue.resetZoom", "isovalue.wholeRange", "isovalue.showHandle", "isovalue.zoomIn", "isovalue.zoomOut"})
        actions_.action(id)->setEnabled(hasDataset);
    // Of logarithms none is too high to be seen.
    actions_.action("isovalue.clipCounts")->setEnabled(!session_.histogramOptions().options().hasLogCounts);
}

void HistogramActions::addTo(QMenu& menu, const ActionRegistry& actions) {
    const auto add = [&actions](QMenu& to, std::initializer_list<const char*> ids) {
        for (const char* id : ids)
            to.addAction(actions.action(id));
    };
    QMenu* scale = menu.addMenu(tr("Value A&xis"));
    add(*scale, {"isovalue.linearValues", "isovalue.logValues", "isovalue.symlogValues"});
    add(menu, {"isovalue.logCounts", "isovalue.clipCounts"});
    menu.addSeparator();
    add(menu, {"isovalue.snap", "isovalue.snapToSamples"});
    menu.addSeparator();
    add(menu,
        {"isovalue.zoomIn", "isovalue.zoomOut", "isovalue.resetZoom", "isovalue.wholeRange", "isovalue.showHandle"});
}

void HistogramActions::openMenu(const QPoint& place) {
    if (!plot_.hasHistogram())
        return;
    auto* menu = new QMenu(&plot_);
    menu->setObjectName(QStringLiteral("histogramMenu"));
    menu->setAttribute(Qt::WA_DeleteOnClose);
    menu->addAction(actions_.action("isovalue.edit"));
    menu->addSeparator();
    addTo(*menu, actions_);
    menu->popup(plot_.mapToGlobal(place));
}

} // namespace isoslider::widgets
