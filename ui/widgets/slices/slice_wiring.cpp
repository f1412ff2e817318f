#include "ui/widgets/slices/slice_wiring.h"

#include <algorithm>
#include <cmath>

#include <QAction>
#include <QActionGroup>
#include <QMenu>

#include <glm/geometric.hpp>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/session/session.h"
#include "ui/model/surface/axis_names.h"
#include "ui/model/surface/shown_surfaces.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/slices/slice_pane.h"
#include "ui/widgets/slices/slice_workspace.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

using model::SliceKind;
using model::SliceLayout;
using model::SliceOptions;

struct LayoutAction {
    const char* action;
    SliceLayout layout;
    const char* setting;
};
constexpr std::array<LayoutAction, 4> kLayouts{{{"slices.none", SliceLayout::None, "none"},
                                                {"slices.one", SliceLayout::One, "one"},
                                                {"slices.three", SliceLayout::Three, "three"},
                                                {"slices.four", SliceLayout::Four, "four"}}};

struct KindActions {
    SliceKind kind;
    const char* pane;
    const char* scene;
};
constexpr std::array<KindActions, 4> kKinds{{{SliceKind::X, "slices.paneX", "slices.sceneX"},
                                             {SliceKind::Y, "slices.paneY", "slices.sceneY"},
                                             {SliceKind::Z, "slices.paneZ", "slices.sceneZ"},
                                             {SliceKind::Oblique, "slices.paneOblique", "slices.sceneOblique"}}};

struct FlagAction {
    const char* action;
    const char* setting;
    bool SliceOptions::*member;
};
constexpr std::array<FlagAction, 2> kFlags{{{"slices.contour", "slices/contour", &SliceOptions::showsContour},
                                            {"slices.crosshair", "slices/crosshair", &SliceOptions::showsCrosshair}}};

glm::vec3 asSeen(const QColor& colour) {
    return {static_cast<float>(colour.redF()), static_cast<float>(colour.greenF()), static_cast<float>(colour.blueF())};
}

/// Where a line of sight meets a slice, as part of the way; beyond 1 where it does not.
double meet(const extract::SlicePlane& plane, const glm::dvec3& from, const glm::dvec3& to, const GridDims& dims) {
    const glm::dvec3 normal = plane.normal();
    const double towards = glm::dot(normal, to - from);
    if (towards == 0.0)
        return 2.0;
    const double way = glm::dot(normal, plane.origin - from) / towards;
    const glm::dvec3 place = from + way * (to - from);
    for (int axis = 0; axis < 3; ++axis)
        if (place[axis] < -1e-6 || place[axis] > static_cast<double>(dims[static_cast<std::size_t>(axis)] - 1) + 1e-6)
            return 2.0;
    return way >= 0.0 ? way : 2.0;
}

} // namespace

SliceWiring::SliceWiring(const Parts& parts, SettingsStore& settings, const ActionRegistry& actions, QObject* parent)
    : QObject(parent), parts_(parts), settings_(settings), actions_(actions) {
    restoreSettings();
    connectLayouts();
    connectScene();
    connectActions();
    connectPanes();
    connectView();
    optionsSubscription_ = parts_.slices.observe([this] {
        showOptions();
        showScene();
    });
    picturesSubscription_ = parts_.slices.observePictures([this] { showScene(); });
    viewSubscription_ = parts_.host.viewState().observe([this] { showStretch(); });
    showOptions();
}

void SliceWiring::restoreSettings() {
    parts_.slices.change([this](SliceOptions& options) {
        for (const auto& entry : kLayouts)
            if (settings_.text("slices/layout") == QLatin1String(entry.setting))
                options.layout = entry.layout;
        for (const auto& entry : kFlags)
            options.*entry.member = settings_.boolean(entry.setting);
    });
}

void SliceWiring::connectLayouts() {
    auto* layouts = new QActionGroup(this);
    for (const auto& entry : kLayouts) {
        QAction* action = layouts->addAction(actions_.action(entry.action));
        connect(action, &QAction::triggered, this, [this, entry] {
            settings_.set("slices/layout", QString(QLatin1String(entry.setting)));
            parts_.slices.change([&](SliceOptions& options) { options.layout = entry.layout; });
        });
    }
    auto* panes = new QActionGroup(this);
    for (const auto& entry : kKinds) {
        QAction* action = panes->addAction(actions_.action(entry.pane));
        connect(action, &QAction::triggered, this, [this, kind = entry.kind] {
            used_ = kind;
            parts_.slices.change([&](SliceOptions& options) {
                options.layout = SliceLayout::One;
                options.onePane = kind;
            });
        });
    }
}

void SliceWiring::connectScene() {
    for (const auto& entry : kKinds)
        connect(actions_.action(entry.scene), &QAction::triggered, this, [this, kind = entry.kind](bool isShown) {
            parts_.slices.change([&](SliceOptions& options) { options.inScene[placeOf(kind)] = isShown; });
        });
    connect(actions_.action("slices.facing"), &QAction::triggered, this, &SliceWiring::faceTheView);
}

void SliceWiring::connectActions() {
    const auto on = [this](const char* id, auto handler) {
        connect(actions_.action(id), &QAction::triggered, this, handler);
    };
    on("slices.next", [this] { parts_.slices.step(currentKind(), 1.0); });
    on("slices.previous", [this] { parts_.slices.step(currentKind(), -1.0); });
    on("slices.centre", [this] { parts_.slices.resetPosition(); });
    on("slices.isovalue", [this] { takeIsovalue(); });
    on("slices.automaticWindow",
       [this] { parts_.slices.change([](SliceOptions& options) { options.window.reset(); }); });
    on("slices.wholeWindow", [this] {
        if (const auto* dataset = parts_.slices.dataset())
            parts_.slices.change([&](SliceOptions& options) {
                options.window = model::ValueWindow{dataset->min, dataset->max};
            });
    });
    for (const auto& entry : kFlags)
        connect(actions_.action(entry.action), &QAction::triggered, this, [this, entry](bool isOn) {
            settings_.set(entry.setting, isOn);
            parts_.slices.change([&](SliceOptions& options) { options.*entry.member = isOn; });
        });
}

void SliceWiring::connectPanes() {
    for (const SliceKind kind : model::kSliceKinds) {
        SlicePane& pane = parts_.workspace.pane(kind);
        connect(&pane, &SlicePane::focused, this, [this, kind] { used_ = kind; });
        connect(&pane, &SlicePane::menuRequested, this, [this, kind](QPointF point) { showMenu(kind, point); });
        connect(&pane, &SlicePane::isovalueStepRequested, this,
                [this](double step) { parts_.session.isovalue().step(step); });
    }
}

void SliceWiring::connectView() {
    auto* viewport = parts_.host.viewport();
    if (viewport == nullptr)
        return;
    connect(viewport, &ViewportWidget::clicked, this, &SliceWiring::moveToPointer);
    connect(viewport, &ViewportWidget::sliceStepRequested, this, [this](double notches) {
        const auto kind = pushedKind();
        if (!kind)
            return;
        notches_ += notches;
        const double whole = std::trunc(notches_);
        notches_ -= whole;
        const auto* dataset = parts_.slices.dataset();
        if (dataset == nullptr || whole == 0.0)
            return;
        const glm::dvec3 ahead = *kind == SliceKind::Oblique
                                     ? parts_.slices.options().orientation * glm::dvec3(0.0, 0.0, 1.0)
                                     : dataset->geometry.direction[gridAxisOf(*kind, dataset->geometry)];
        const bool isTowardsViewer = glm::dot(ahead, parts_.host.viewport()->camera().facingNormal()) > 0.0;
        parts_.slices.step(*kind, isTowardsViewer ? -whole : whole);
    });
}

void SliceWiring::showOptions() {
    const SliceOptions& options = parts_.slices.options();
    const bool hasVolume = parts_.slices.dataset() != nullptr;
    const bool isAnyShown = std::any_of(model::kSliceKinds.begin(), model::kSliceKinds.end(),
                                        [this](SliceKind kind) { return parts_.slices.isShown(kind); });
    for (const auto& entry : kLayouts)
        actions_.action(entry.action)->setChecked(options.layout == entry.layout);
    for (const auto& entry : kKinds) {
        actions_.action(entry.pane)->setChecked(options.onePane == entry.kind);
        actions_.action(entry.scene)->setChecked(options.inScene[placeOf(entry.kind)]);
        actions_.action(entry.scene)->setEnabled(parts_.host.viewport() != nullptr);
    }
    for (const auto& entry : kFlags)
        actions_.action(entry.action)->setChecked(options.*entry.member);
    for (const char* id : {"slices.next", "slices.previous", "slices.centre", "slices.isovalue",
                           "slices.automaticWindow", "slices.wholeWindow"})
        actions_.action(id)->setEnabled(hasVolume && isAnyShown);
    actions_.action("slices.facing")->setEnabled(hasVolume && parts_.host.viewport() != nullptr);
    nameAxes();
}

void SliceWiring::nameAxes() {
    const auto* dataset = parts_.slices.dataset();
    const model::AxisNames names = dataset != nullptr ? model::AxisNames(dataset->geometry) : model::AxisNames();
    for (const auto& entry : kKinds) {
        if (entry.kind == SliceKind::Oblique)
            continue;
        const QString name = fromStd(names.nameOf(names.gridAxisOf(worldAxisOf(entry.kind))));
        nameAction(*actions_.action(entry.pane), tr("Across &%1").arg(name),
                   tr("One slice beside the 3-D view, across %1").arg(name));
        nameAction(*actions_.action(entry.scene), tr("Across &%1").arg(name),
                   tr("The slice across %1 in the 3-D view").arg(name));
    }
}

void SliceWiring::showStretch() {
    for (const SliceKind kind : model::kSliceKinds)
        parts_.workspace.pane(kind).setStretch(parts_.host.viewState().options().stage.stretch);
}

void SliceWiring::showScene() {
    auto* viewport = parts_.host.viewport();
    if (viewport == nullptr)
        return;
    const SliceOptions& options = parts_.slices.options();
    render::SliceScene scene;
    bool isAnyShown = false;
    for (const SliceKind kind : model::kSliceKinds) {
        isAnyShown = isAnyShown || parts_.slices.isShown(kind);
        if (!options.inScene[placeOf(kind)])
            continue;
        if (auto shades = parts_.slices.shades(kind))
            scene.slices.push_back({std::move(shades), parts_.slices.contour(kind), asSeen(sliceColour(kind))});
    }
    if (isAnyShown && options.showsCrosshair && parts_.slices.dataset() != nullptr) {
        scene.crosshair = options.position;
        for (const SliceKind kind : {SliceKind::X, SliceKind::Y, SliceKind::Z})
            scene.axisColours[static_cast<std::size_t>(gridAxisOf(kind, parts_.slices.dataset()->geometry))] =
                asSeen(sliceColour(kind));
    }
    if (scene == scene_) // to draw the view again may take long
        return;
    scene_ = scene;
    viewport->setSlices(std::move(scene));
}

SliceKind SliceWiring::currentKind() const {
    if (parts_.slices.isShown(used_))
        return used_;
    for (const SliceKind kind : {SliceKind::Z, SliceKind::Y, SliceKind::X, SliceKind::Oblique})
        if (parts_.slices.isInPane(kind))
            return kind;
    return pushedKind().value_or(used_);
}

std::optional<SliceKind> SliceWiring::pushedKind() const {
    const SliceOptions& options = parts_.slices.options();
    const auto* dataset = parts_.slices.dataset();
    if (dataset == nullptr || parts_.host.viewport() == nullptr)
        return std::nullopt;
    if (options.inScene[placeOf(SliceKind::Oblique)])
        return SliceKind::Oblique;
    std::optional<SliceKind> most;
    double mostAcross = -1.0;
    for (const SliceKind kind : {SliceKind::X, SliceKind::Y, SliceKind::Z}) {
        const glm::dvec3 direction = dataset->geometry.direction[gridAxisOf(kind, dataset->geometry)];
        const double across = std::abs(glm::dot(direction, parts_.host.viewport()->camera().backward()));
        if (options.inScene[placeOf(kind)] && across > mostAcross) {
            mostAcross = across;
            most = kind;
        }
    }
    return most;
}

void SliceWiring::faceTheView() {
    // Of what is stretched, the slice that is seen from straight above.
    const model::Camera& camera = parts_.host.viewport()->camera();
    const glm::dquat orientation = glm::dquat(camera.backward(), camera.facingNormal()) * camera.orientation();
    used_ = SliceKind::Oblique;
    parts_.slices.change([&](SliceOptions& options) {
        options.orientation = orientation;
        // A pane of it is enough, where there is one.
        const bool isInPane = options.layout == SliceLayout::One && options.onePane == SliceKind::Oblique;
        options.inScene[placeOf(SliceKind::Oblique)] = options.inScene[placeOf(SliceKind::Oblique)] || !isInPane;
    });
}

// The nearest of what is seen there: a slice, or the surface.
void SliceWiring::moveToPointer(QPointF point) {
    const SliceOptions& options = parts_.slices.options();
    const auto* dataset = parts_.slices.dataset();
    const auto frame = parts_.session.pictureOf(parts_.session.surfaces().list().active); // of whose grid the line is
    const auto line = parts_.host.viewport()->lineOfSight(point);
    if (!line || !frame || dataset == nullptr || actions_.action("view.measure")->isChecked() ||
        (options.layout == SliceLayout::None &&
         std::none_of(options.inScene.begin(), options.inScene.end(), [](bool isShown) { return isShown; })))
        return;
    const glm::dvec3 step = frame->geometry.spacing / dataset->geometry.spacing; // the line is in units of a preview
    const glm::dvec3 from = line->first * step, to = line->second * step;
    double nearest = 2.0;
    bool snaps = true;
    for (const SliceKind kind : model::kSliceKinds)
        if (options.inScene[placeOf(kind)])
            if (const double way = meet(parts_.slices.planeOf(kind), from, to, dataset->geometry.dims); way < nearest) {
                nearest = way;
                snaps = kind != SliceKind::Oblique;
            }
    const model::ViewOptions& view = parts_.host.viewState().options();
    const GridGeometry& volume = dataset->geometry;
    const auto shown = model::shownSurfaces(parts_.session, view);
    if (const auto met =
            model::firstShownPlace(shown, view.clipping, volume, model::centredWorldOf(from, volume, volume),
                                   model::centredWorldOf(to, volume, volume))) {
        const double way =
            glm::distance(model::indexOfCentred(met->place, volume, volume), from) / glm::distance(to, from);
        if (way < nearest) {
            nearest = way;
            snaps = true;
        }
    }
    if (nearest <= 1.0)
        parts_.slices.moveTo(from + nearest * (to - from), snaps);
}

void SliceWiring::takeIsovalue() {
    const SliceKind kind = currentKind();
    const auto* dataset = parts_.slices.dataset();
    if (dataset == nullptr || !parts_.slices.isShown(kind))
        return;
    const glm::dvec2 pixel =
        model::pixelOf(parts_.slices.planeOf(kind), parts_.slices.options().position, dataset->geometry);
    if (const auto reading = parts_.slices.reading(kind, pixel.x, pixel.y); reading && reading->value)
        parts_.session.isovalue().request(*reading->value);
}

void SliceWiring::showMenu(SliceKind kind, QPointF point) {
    SlicePane& pane = parts_.workspace.pane(kind);
    auto* menu = new QMenu(&pane);
    menu->setAttribute(Qt::WA_DeleteOnClose);
    menu->setObjectName(QStringLiteral("sliceMenu"));
    const glm::dvec2 pixel = pane.pixelAt(point);
    const auto reading = parts_.slices.reading(kind, pixel.x, pixel.y);
    if (reading && reading->value) {
        QAction* take =
            menu->addAction(tr("Isovalue &Here: %1").arg(QString::fromStdString(model::valueText(*reading->value, 7))));
        take->setObjectName(QStringLiteral("isovalueHere"));
        connect(take, &QAction::triggered, this,
                [this, value = *reading->value] { parts_.session.isovalue().request(value); });
        menu->addSeparator();
    }
    for (const char* action : {"slices.automaticWindow", "slices.wholeWindow"})
        menu->addAction(actions_.action(action));
    menu->addSeparator();
    for (const char* action : {"slices.contour", "slices.crosshair", "slices.centre"})
        menu->addAction(actions_.action(action));
    menu->addSeparator();
    for (const char* action : {"slices.none", "slices.one", "slices.three", "slices.four"})
        menu->addAction(actions_.action(action));
    menu->popup(pane.mapToGlobal(point.toPoint()));
}

} // namespace isoslider::widgets
