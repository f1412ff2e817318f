#include "ui/widgets/window/surface_wiring.h"

#include <algorithm>
#include <cmath>

#include <QAction>
#include <QDockWidget>

#include "ui/model/session/session.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/surface_bars.h"
#include "ui/widgets/panels/surfaces_panel.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::widgets {
namespace {

constexpr double kOpacityStep = 0.1;

} // namespace

SurfaceWiring::SurfaceWiring(model::Session& session, const ActionRegistry& actions, const Parts& parts,
                             QObject* parent)
    : QObject(parent), session_(session), actions_(actions), parts_(parts), bars_(new SurfaceBars(parts.plot)) {
    connectActions();
    connect(bars_, &SurfaceBars::pressed, this, [this](model::SurfaceId id) { session_.surfaces().activate(id); });
    subscription_ = session_.surfaces().observe([this] { showSurfaces(); });
    secondSubscriptions_[0] = session_.secondVolume().changed().observe([this] { showSecond(); });
    secondSubscriptions_[1] = session_.secondVolume().surfaces().observe([this] { showSecond(); });
    showSurfaces();
    showSecond();
}

void SurfaceWiring::connectActions() {
    auto& surfaces = session_.surfaces();
    const auto on = [this](const char* id, auto handler) {
        connect(actions_.action(id), &QAction::triggered, this, handler);
    };
    on("surfaces.add", [this] { session_.addSurface(); });
    on("surfaces.remove", [&surfaces] { surfaces.remove(surfaces.list().active); });
    on("surfaces.next", [&surfaces] { surfaces.activateNext(1); });
    on("surfaces.previous", [&surfaces] { surfaces.activateNext(-1); });
    on("surfaces.show", [&surfaces](bool isShown) {
        surfaces.change(surfaces.list().active,
                        [isShown](model::ListedSurface& surface) { surface.isVisible = isShown; });
    });
    const auto changeOpacity = [&surfaces](double by) {
        surfaces.change(surfaces.list().active, [by](model::ListedSurface& surface) {
            surface.opacity = std::clamp(std::round((surface.opacity + by) * 100.0) / 100.0, model::kLeastOpacity, 1.0);
        });
    };
    on("surfaces.moreOpaque", [changeOpacity] { changeOpacity(kOpacityStep); });
    on("surfaces.lessOpaque", [changeOpacity] { changeOpacity(-kOpacityStep); });
    on("surfaces.rename", [this] {
        parts_.dock.show();
        parts_.dock.raise();
        parts_.panel.editName();
    });
    auto& second = session_.secondVolume();
    on("second.addSurface", [&second] { second.addSurface(); });
    on("second.removeSurface", [&second] { second.surfaces().remove(second.surfaces().list().active); });
    on("second.close", [&second] { second.close(); });
}

void SurfaceWiring::showSecond() {
    const auto& second = session_.secondVolume();
    actions_.action("second.addSurface")->setEnabled(second.surfaces().canAdd());
    actions_.action("second.removeSurface")->setEnabled(second.surfaces().canRemove());
    actions_.action("second.close")->setEnabled(second.dataset() != nullptr || !second.opening().empty());
}

void SurfaceWiring::showSurfaces() {
    const auto& surfaces = session_.surfaces();
    const auto* active = surfaces.active();
    const bool hasOthers = surfaces.canRemove();
    actions_.action("surfaces.add")->setEnabled(surfaces.canAdd());
    for (const char* id : {"surfaces.remove", "surfaces.next", "surfaces.previous"})
        actions_.action(id)->setEnabled(hasOthers);
    for (const char* id : {"surfaces.show", "surfaces.rename"})
        actions_.action(id)->setEnabled(active != nullptr);
    actions_.action("surfaces.moreOpaque")->setEnabled(active != nullptr && active->opacity < 1.0);
    actions_.action("surfaces.lessOpaque")->setEnabled(active != nullptr && active->opacity > model::kLeastOpacity);
    actions_.action("surfaces.show")->setChecked(active != nullptr && active->isVisible);
    bars_->show(surfaces.list());
}

} // namespace isoslider::widgets
