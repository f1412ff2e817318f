#include "ui/widgets/window/topology_wiring.h"

#include <algorithm>

#include <QAction>

#include "ui/model/session/session.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/panels/topology_panel.h"
#include "ui/widgets/viewport/camera_flight.h"
#include "ui/widgets/viewport/event_marker.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

// From where an event is looked at: near enough for its cells, far enough for what surrounds them.
constexpr double kCloseCells = 45.0;
constexpr double kClosest = 0.45, kFarthest = 0.9; // of the scene's radius

std::vector<EventMark> marksOf(const model::TopologyModel& topology) {
    std::vector<EventMark> marks;
    const double greatest = topology.greatestPersistence();
    for (const std::size_t place : topology.shown()) {
        const auto& event = topology.events()[place];
        const double share = topology.persistenceOf(place) / greatest; // of 0 by 0 it is not a number
        marks.push_back({place, event.isovalue, topology.justPast(place), share > 0.0 ? std::min(share, 1.0) : 0.0,
                         model::classOf(event)});
    }
    return marks;
}

glm::dvec3 placeOf(const topology::TopologyEvent& event) {
    return {event.position[0], event.position[1], event.position[2]};
}

} // namespace

TopologyWiring::TopologyWiring(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                               const Parts& parts, QObject* parent)
    : QObject(parent), session_(session), actions_(actions), plot_(parts.plot), host_(parts.host) {
    connectActions(settings);
    if (auto* viewport = parts.host.viewport()) {
        flight_ = parts.host.flight();
        marker_ = new EventMarker(*viewport);
    }
    connect(&parts.panel, &TopologyPanel::eventPicked, this, [this](std::size_t event) {
        moveTo(event);
        flyTo(event);
    });
    connect(&plot_, &HistogramPlot::eventPressed, this, &TopologyWiring::moveTo);
    subscriptions_.push_back(session_.topology().changed().observe([this] { showEvents(); }));
    subscriptions_.push_back(session_.topology().chosenChanged().observe([this] { showChosen(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { showPassed(); }));
    showEvents();
    showChosen();
}

void TopologyWiring::connectActions(SettingsStore& settings) {
    connect(actions_.action("isovalue.previousEvent"), &QAction::triggered, this, [this] { moveToNext(false); });
    connect(actions_.action("isovalue.nextEvent"), &QAction::triggered, this, [this] { moveToNext(true); });
    connect(actions_.action("isovalue.clearEvent"), &QAction::triggered, this,
            [this] { session_.topology().choose(std::nullopt); });
    QAction* pass = actions_.action("isovalue.markPassed");
    pass->setChecked(settings.boolean("isovalue/marksPassedEvents"));
    connect(pass, &QAction::toggled, this,
            [&settings](bool marksPassed) { settings.set("isovalue/marksPassedEvents", marksPassed); });
}

void TopologyWiring::moveTo(std::size_t event) {
    auto& topology = session_.topology();
    if (event >= topology.events().size())
        return;
    topology.choose(event);
    session_.isovalue().request(topology.justPast(event));
}

void TopologyWiring::flyTo(std::size_t event) {
    const auto* dataset = session_.dataset();
    const auto& events = session_.topology().events();
    if (flight_ == nullptr || dataset == nullptr || event >= events.size())
        return;
    const GridGeometry& geometry = dataset->geometry;
    const GridGeometry shown = model::stretched(geometry, host_.viewState().options().stage.stretch);
    const glm::dvec3 spacing = glm::abs(shown.spacing);
    const double radius = render::sceneRadius(shown);
    const double cell = std::max({spacing.x, spacing.y, spacing.z});
    flight_->flyTo(render::indexToCentredWorld(shown, shown) * glm::dvec4(placeOf(events[event]), 1.0),
                   std::clamp(kCloseCells * cell, kClosest * radius, kFarthest * radius));
}

void TopologyWiring::moveToNext(bool isUpwards) {
    const auto& topology = session_.topology();
    const double isovalue = session_.isovalue().requested();
    if (const auto event = isUpwards ? topology.next(isovalue) : topology.previous(isovalue))
        moveTo(*event);
}

void TopologyWiring::showEvents() {
    const auto& topology = session_.topology();
    const bool hasEvents = !topology.shown().empty();
    actions_.action("isovalue.previousEvent")->setEnabled(hasEvents);
    actions_.action("isovalue.nextEvent")->setEnabled(hasEvents);
    plot_.setEventMarks(marksOf(topology), [&topology](std::size_t event) {
        return event < topology.events().size() ? QString::fromStdString(model::describe(topology.events()[event]))
                                                : QString();
    });
}

void TopologyWiring::showChosen() {
    const auto chosen = session_.topology().chosen();
    actions_.action("isovalue.clearEvent")->setEnabled(chosen.has_value());
    plot_.setChosenEvent(chosen);
    if (marker_ == nullptr)
        return;
    if (chosen)
        marker_->mark(placeOf(session_.topology().events()[*chosen]));
    else
        marker_->clear();
}

// What a slide just changed is pointed out for a moment. The chosen event has its own mark.
void TopologyWiring::showPassed() {
    const auto frame = session_.frame();
    if (frame == nullptr)
        return shown_.reset();
    const Shown now{session_.datasetGeneration(), session_.surfaces().list().active, frame->isovalue};
    const auto before = std::exchange(shown_, now);
    if (session_.firstIsovalue().isovalue())
        return; // it is the program that moves
    if (marker_ == nullptr || !before || before->dataset != now.dataset || before->surface != now.surface ||
        !actions_.action("isovalue.markPassed")->isChecked())
        return;
    const auto& topology = session_.topology();
    if (const auto chosen = topology.chosen(); chosen && now.isovalue == topology.justPast(*chosen))
        return; // it is to this one that the surface has jumped
    const auto event = topology.passed(before->isovalue, now.isovalue);
    if (event && event != topology.chosen())
        marker_->markPassed(placeOf(topology.events()[*event]));
}

} // namespace isoslider::widgets
