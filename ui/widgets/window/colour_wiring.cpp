#include "ui/widgets/window/colour_wiring.h"

#include <QAction>
#include <QDir>
#include <QFileInfo>
#include <QMenu>

#include "ui/model/opening/open_model.h"
#include "ui/model/opening/raw_guess.h"
#include "ui/model/opening/raw_import_model.h"
#include "ui/model/session/session.h"
#include "ui/render/scene_view.h"
#include "ui/widgets/common/texts.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/opening/raw_import_dialog.h"
#include "ui/widgets/opening/volume_dialog.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {
namespace {

constexpr const char* kFolderSetting = "files/openFolder";
constexpr const char* kMapSetting = "view/colourMap";
constexpr const char* kReversedSetting = "view/colourMapReversed";

} // namespace

ColourWiring::ColourWiring(model::Session& session, const ActionRegistry& actions, const Parts& parts, QWidget* window)
    : QObject(window),
      session_(session),
      actions_(actions),
      parts_(parts),
      window_(window),
      colours_(parts.host.colours()),
      jobs_(std::make_shared<model::BackgroundJobs>(session.services().postToMain)) {
    const QString map = parts_.settings.text(kMapSetting);
    colours_.change([&](model::Colouring& colouring) {
        for (const auto& entry : kColourMapActions)
            if (map == QLatin1String(model::colourMapName(entry.map)))
                colouring.map = entry.map;
        colouring.isReversed = parts_.settings.boolean(kReversedSetting);
    });
    connectActions();
    subscriptions_.push_back(colours_.observe([this] { showState(); }));
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showState(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { showState(); }));
    showState();
}

void ColourWiring::addTo(QMenu& menu, const ActionRegistry& actions) {
    menu.setToolTipsVisible(true);
    const auto add = [&](const char* id) { menu.addAction(actions.action(id)); };
    add("colour.one");
    add("pieces.colour");
    for (const auto& entry : kColourKeyActions)
        if (entry.by != model::ColourBy::One)
            add(entry.id);
    menu.addSeparator();
    for (const auto& entry : kColourMapActions)
        add(entry.id);
    add("colour.reverse");
    menu.addSeparator();
    for (const char* id : {"colour.automatic", "colour.fit", "colour.bar"})
        add(id);
}

void ColourWiring::connectActions() {
    const auto on = [this](const char* id, auto handler) {
        connect(actions_.action(id), &QAction::triggered, this, handler);
    };
    for (const auto& entry : kColourKeyActions)
        if (entry.by == model::ColourBy::Field)
            on(entry.id, [this] {
                showState(); // it is not checked before there is one
                askField();
            });
        else
            on(entry.id, [this, by = entry.by] {
                colours_.choose(by);
                showState(); // an action that changes nothing has been unchecked all the same
            });
    for (const auto& entry : kColourMapActions)
        on(entry.id, [this, map = entry.map] {
            colours_.change([map](model::Colouring& colouring) { colouring.map = map; });
            parts_.settings.set(kMapSetting, QString(QLatin1String(model::colourMapName(map))));
            showState();
        });
    on("colour.reverse", [this](bool isReversed) {
        colours_.change([isReversed](model::Colouring& colouring) { colouring.isReversed = isReversed; });
        parts_.settings.set(kReversedSetting, isReversed);
    });
    on("colour.automatic", [this] {
        colours_.change([](model::Colouring& colouring) { colouring.range.reset(); });
        showState();
    });
    on("colour.fit", [this] { colours_.fitToSurface(); });
}

void ColourWiring::askField() {
    parts_.dialogs.askOpen(window_, tr("Colour by Second Field"), parts_.settings.text(kFolderSetting), volumeFilters(),
                           [this](const QString& path) {
                               if (path.isEmpty())
                                   return;
                               parts_.settings.set(kFolderSetting, QFileInfo(path).path());
                               chooseField(path);
                           });
}

// As a volume is opened: with a preview, and what a file of several has to be asked.
void ColourWiring::chooseField(const QString& path) {
    const std::filesystem::path file(QDir::cleanPath(QFileInfo(path).absoluteFilePath()).toStdU16String());
    const auto choose = [this](const QString& chosen, const io::ReadOptions& options) {
        colours_.choose(model::ColourBy::Field,
                        model::FieldFile{std::filesystem::path(chosen.toStdU16String()), options});
    };
    const auto volumes = session_.services().volumes;
    if (model::isHeaderlessSuffix(path.toStdString()) && QFileInfo(path).isFile()) {
        auto* dialog =
            new RawImportDialog(std::make_unique<model::RawImportModel>(
                                    file, static_cast<std::uint64_t>(QFileInfo(path).size()), jobs_, volumes),
                                window_);
        connect(dialog, &RawImportDialog::openRequested, this, choose);
        return dialog->open();
    }
    auto* dialog = new VolumeDialog(std::make_unique<model::OpenModel>(file, jobs_, volumes), window_);
    connect(dialog, &VolumeDialog::openRequested, this, choose);
    dialog->open();
}

void ColourWiring::showState() {
    const model::Colouring& wanted = colours_.wanted();
    const bool hasPieces = parts_.host.viewState().options().pieces.isColoured;
    const bool hasView = parts_.host.viewport() != nullptr;
    const bool hasVolume = hasView && session_.dataset() != nullptr;
    for (const auto& entry : kColourKeyActions) {
        QAction& action = *actions_.action(entry.id);
        action.setEnabled(hasVolume);
        action.setToolTip(action.statusTip());
        action.setChecked(!hasPieces && wanted.by == entry.by);
    }
    const bool hasValues =
        hasVolume && render::isColouredByField(parts_.host.viewState().options()) && wanted.by != model::ColourBy::One;
    for (const auto& entry : kColourMapActions) {
        actions_.action(entry.id)->setEnabled(hasValues); // a map of nothing would change nothing
        actions_.action(entry.id)->setChecked(wanted.map == entry.map);
    }
    actions_.action("colour.bar")->setEnabled(hasValues);
    actions_.action("colour.reverse")->setEnabled(hasValues);
    actions_.action("colour.reverse")->setChecked(wanted.isReversed);
    actions_.action("colour.automatic")->setEnabled(hasValues);
    actions_.action("colour.automatic")->setChecked(!wanted.range);
    actions_.action("colour.fit")
        ->setEnabled(hasValues && session_.frame() != nullptr && colours_.colours().by != model::ColourBy::One);
}

} // namespace isoslider::widgets
