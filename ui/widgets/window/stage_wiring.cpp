#include "ui/widgets/window/stage_wiring.h"

#include <algorithm>
#include <array>

#include <QAction>
#include <QTimer>

#include "ui/model/session/session.h"
#include "ui/render/scene_renderer.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/settings_store.h"
#include "ui/widgets/window/stretch_dialog.h"

namespace isoslider::widgets {
namespace {

struct BackgroundAction {
    const char* id;
    model::Background background;
};
constexpr std::array<BackgroundAction, 4> kBackgrounds{{{"stage.dark", model::Background::Dark},
                                                        {"stage.light", model::Background::Light},
                                                        {"stage.white", model::Background::White},
                                                        {"stage.black", model::Background::Black}}};
struct LightAction {
    const char* id;
    model::Light light;
};
constexpr std::array<LightAction, 3> kLights{{{"stage.studio", model::Light::Studio},
                                              {"stage.headlight", model::Light::Headlight},
                                              {"stage.raking", model::Light::Raking}}};

/// As the settings name it.
template <class Value, std::size_t count>
Value valueOf(const std::array<const char*, count>& names, const QString& name) {
    const auto* found =
        std::find_if(names.begin(), names.end(), [&](const char* known) { return name == QLatin1String(known); });
    return found == names.end() ? Value{} : static_cast<Value>(found - names.begin());
}

} // namespace

StageWiring::StageWiring(model::Session& session, SettingsStore& settings, const ActionRegistry& actions,
                         const Parts& parts, QObject* parent)
    : QObject(parent), session_(session), settings_(settings), actions_(actions), parts_(parts) {
    change([&](model::Stage& stage) {
        stage.background = valueOf<model::Background>(model::kBackgroundNames, settings.text("view/background"));
        stage.light = valueOf<model::Light>(model::kLightNames, settings.text("view/light"));
        stage.hasOcclusion = settings.boolean("view/occlusion");
    });
    connectActions();
    subscriptions_.push_back(parts_.host.viewState().observe([this] { showOptions(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { followDataset(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] {
        // When a session that is being opened has set its own.
        if (session_.frame() != nullptr && std::exchange(isSuggestionDue_, false))
            QTimer::singleShot(0, this, &StageWiring::suggest);
    }));
    followDataset();
    showOptions();
}

void StageWiring::change(const std::function<void(model::Stage&)>& change) {
    auto options = parts_.host.viewState().options();
    change(options.stage);
    parts_.host.viewState().setOptions(options);
    showOptions(); // an action that changes nothing has been checked or unchecked all the same
}

void StageWiring::connectActions() {
    for (const auto& entry : kBackgrounds)
        connect(actions_.action(entry.id), &QAction::triggered, this, [this, entry] {
            change([&](model::Stage& stage) { stage.background = entry.background; });
            settings_.set("view/background",
                          QString::fromLatin1(model::kBackgroundNames[static_cast<std::size_t>(entry.background)]));
        });
    for (const auto& entry : kLights)
        connect(actions_.action(entry.id), &QAction::triggered, this, [this, entry] {
            change([&](model::Stage& stage) { stage.light = entry.light; });
            settings_.set("view/light", QString::fromLatin1(model::kLightNames[static_cast<std::size_t>(entry.light)]));
        });
    connect(actions_.action("stage.occlusion"), &QAction::triggered, this, [this](bool isOn) {
        change([&](model::Stage& stage) { stage.hasOcclusion = isOn; });
        settings_.set("view/occlusion", isOn);
    });
    actions_.action("stage.occlusion")->setEnabled(parts_.host.viewport() != nullptr);
    connect(actions_.action("stage.stretch"), &QAction::triggered, this, [this] {
        if (dialog_ == nullptr)
            dialog_ = new StretchDialog(session_, parts_.host.viewState(), parts_.host.window());
        dialog_->show();
        dialog_->raise();
        dialog_->activateWindow();
    });
    for (const auto& entry : kBackgrounds)
        actions_.action(entry.id)->setEnabled(parts_.host.viewport() != nullptr);
    for (const auto& entry : kLights)
        actions_.action(entry.id)->setEnabled(parts_.host.viewport() != nullptr);
}

void StageWiring::showOptions() {
    const auto* dataset = session_.dataset();
    auto options = parts_.host.viewState().options();
    options.stage.stretch = model::stretchWithin(options.stage.stretch);
    if (options != parts_.host.viewState().options())
        return parts_.host.viewState().setOptions(options);
    for (const auto& entry : kBackgrounds)
        actions_.action(entry.id)->setChecked(options.stage.background == entry.background);
    for (const auto& entry : kLights)
        actions_.action(entry.id)->setChecked(options.stage.light == entry.light);
    actions_.action("stage.occlusion")->setChecked(options.stage.hasOcclusion);
    auto* viewport = parts_.host.viewport();
    actions_.action("stage.stretch")->setEnabled(viewport != nullptr && dataset != nullptr);
    if (viewport == nullptr || dataset == nullptr)
        return;
    const glm::dmat3 stretch = model::stretchMatrix(options.stage.stretch, dataset->geometry);
    const double radius = render::sceneRadius(model::stretched(dataset->geometry, options.stage.stretch));
    if (stretch != viewport->camera().stretch())
        viewport->changeCamera([&](model::Camera& camera) { camera.setStretch(stretch, radius); });
}

// Lengths are stretched for one volume.
void StageWiring::followDataset() {
    if (std::exchange(dataset_, session_.datasetGeneration()) == session_.datasetGeneration())
        return showOptions();
    isSuggestionDue_ = true;
    change([](model::Stage& stage) { stage.stretch = glm::dvec3(1.0); });
}

void StageWiring::suggest() {
    const auto* dataset = session_.dataset();
    if (dataset == nullptr || parts_.host.viewport() == nullptr || parts_.messageBar.isVisible() ||
        model::isStretched(parts_.host.viewState().options().stage.stretch))
        return;
    const auto suggested = model::suggestedStretch(dataset->geometry);
    if (!suggested)
        return;
    const model::Notice notice{
        model::Notice::Severity::Information, tr("The axes differ much in length").toStdString(),
        tr("Shown stretched (%1), the volume would be easier to look at").arg(textOf(*suggested)).toStdString()};
    parts_.messageBar.showOffer(notice, {{tr("&Stretch"), [this, stretch = *suggested] {
                                              change([&](model::Stage& stage) { stage.stretch = stretch; });
                                          }}});
}

QString StageWiring::textOf(const glm::dvec3& stretch) const {
    const auto* dataset = session_.dataset();
    return QString::fromStdString(
        model::stretchText(stretch, dataset != nullptr ? model::AxisNames(dataset->geometry) : model::AxisNames()));
}

} // namespace isoslider::widgets
