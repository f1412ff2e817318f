#include <QAction>
#include <QDockWidget>
#include <QMenu>
#include <QMenuBar>
#include <QToolBar>
#include <QToolButton>

#include "ui/model/session/session.h"
#include "ui/widgets/isovalue/histogram_actions.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/opening/open_flow.h"
#include "ui/widgets/opening/recent_files.h"
#include "ui/widgets/opening/start_page.h"
#include "ui/widgets/panels/surfaces_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/cache_dialog.h"
#include "ui/widgets/window/colour_wiring.h"
#include "ui/widgets/window/help_dialogs.h"
#include "ui/widgets/window/main_window.h"
#include "ui/widgets/window/picture_flow.h"
#include "ui/widgets/window/session_keeper.h"
#include "ui/widgets/window/settings_store.h"
#include "ui/widgets/window/topology_questions.h"
#include "ui/widgets/window/undo_history.h"

namespace isoslider::widgets {

void MainWindow::makeMenus() {
    const auto add = [this](QMenu* menu, std::initializer_list<const char*> ids) {
        for (const char* id : ids)
            menu->addAction(actions_->action(id));
    };
    QMenu* file = menuBar()->addMenu(tr("&File"));
    add(file, {"file.open", "file.openFolder", "file.importRaw", "second.open"});
    recentMenu_ = file->addMenu(tr("Open &Recent"));
    QMenu* samples = file->addMenu(tr("Open Sa&mple"));
    add(samples, {"file.sampleBluntFin", "file.sampleShell"});
    add(file, {"file.previewsFirst"});
    file->addSeparator();
    add(file, {"file.openSession", "file.saveSession"});
    file->addSeparator();
    add(file, {"mesh.export", "file.saveImage"});
    file->addSeparator();
    add(file, {"file.close", "file.quit"});

    QMenu* edit = menuBar()->addMenu(tr("&Edit"));
    add(edit, {"edit.undo", "edit.redo"});
    new UndoHistory({session_, host_->viewState(), *slices_, host_->colours()}, *actions_, this);

    QMenu* view = menuBar()->addMenu(tr("&View"));
    add(view, {"view.reset", "view.fit", "view.perspective"});
    QMenu* standard = view->addMenu(tr("&Standard Views"));
    add(standard, {"view.front", "view.back", "view.right", "view.left", "view.top", "view.bottom"});
    view->addSeparator();
    add(view, {"view.changed", "view.edges", "view.levels", "view.box", "view.ticks", "view.axes", "view.cube",
               "view.scaleBar", "view.readout"});
    view->addSeparator();
    add(view, {"view.measure"});
    ColourWiring::addTo(*view->addMenu(tr("Colour B&y")), *actions_);
    QMenu* clipping = view->addMenu(tr("Cl&ipping"));
    add(clipping, {"clip.crop", "clip.resetCrop"});
    clipping->addSeparator();
    add(clipping,
        {"clip.plane", "clip.second", "clip.acrossX", "clip.acrossY", "clip.acrossZ", "clip.facing", "clip.flip"});
    clipping->addSeparator();
    add(clipping, {"clip.noCap", "clip.colourCap", "clip.valueCap"});
    clipping->addSeparator();
    add(clipping, {"pieces.exportShown", "clip.exportClosed"});
    QMenu* background = view->addMenu(tr("Bac&kground"));
    add(background, {"stage.dark", "stage.light", "stage.white", "stage.black"});
    QMenu* light = view->addMenu(tr("Lig&ht"));
    add(light, {"stage.studio", "stage.headlight", "stage.raking"});
    light->addSeparator();
    add(light, {"stage.occlusion"});
    add(view, {"stage.stretch"});
    view->addSeparator();
    QMenu* panels = view->addMenu(tr("Pa&nels"));
    for (QDockWidget* dock : allDocks())
        panels->addAction(dock->toggleViewAction());
    panelsMenu_ = panels;
    add(view, {"view.resetLayout", "view.fullScreen"});

    QMenu* isovalue = menuBar()->addMenu(tr("&Isovalue"));
    add(isovalue, {"isovalue.edit", "isovalue.play"});
    isovalue->addSeparator();
    add(isovalue, {"isovalue.previousEvent", "isovalue.nextEvent", "isovalue.clearEvent", "isovalue.markPassed",
                   "isovalue.coarserWhileMoving"});
    isovalue->addSeparator();
    QMenu* suggested = isovalue->addMenu(tr("Su&ggested Isovalues"));
    suggested->setObjectName(QStringLiteral("suggestionsMenu"));
    add(isovalue, {"isovalue.find", "isovalue.compare", "isovalue.stopComparing"});
    new TopologyQuestions(session_, *actions_, {isovaluePanel_->plot(), *topologyPanel_, *host_, *suggested}, this);
    isovalue->addSeparator();
    HistogramActions::addTo(*isovalue, *actions_);

    QMenu* slices = menuBar()->addMenu(tr("&Slices"));
    add(slices, {"slices.none", "slices.one", "slices.three", "slices.four"});
    slices->addSeparator();
    add(slices->addMenu(tr("Single &Slice")), {"slices.paneX", "slices.paneY", "slices.paneZ", "slices.paneOblique"});
    add(slices->addMenu(tr("In the 3-&D View")),
        {"slices.sceneX", "slices.sceneY", "slices.sceneZ", "slices.sceneOblique"});
    add(slices, {"slices.facing"});
    slices->addSeparator();
    add(slices, {"slices.next", "slices.previous", "slices.centre", "slices.isovalue"});
    slices->addSeparator();
    add(slices, {"slices.automaticWindow", "slices.wholeWindow", "slices.contour", "slices.crosshair"});

    QMenu* pieces = menuBar()->addMenu(tr("&Pieces"));
    add(pieces, {"pieces.colour"});
    pieces->addSeparator();
    add(pieces,
        {"pieces.hide", "pieces.only", "pieces.hideSmaller", "pieces.largest", "pieces.all", "pieces.deselect"});
    pieces->addSeparator();
    add(pieces, {"pieces.exportShown", "pieces.exportSelected"});

    QMenu* surfaces = menuBar()->addMenu(tr("S&urfaces"));
    add(surfaces, {"surfaces.add", "surfaces.remove"});
    surfaces->addSeparator();
    add(surfaces, {"surfaces.next", "surfaces.previous"});
    surfaces->addSeparator();
    add(surfaces, {"isovalue.edit", "surfaces.moreOpaque", "surfaces.lessOpaque"});
    surfaces->addSeparator();
    add(surfaces, {"surfaces.show", "surfaces.rename"});
    surfaces->addMenu(surfacesPanel_->colourMenu());
    surfaces->addSeparator();
    add(surfaces->addMenu(tr("Second &Volume")),
        {"second.open", "second.addSurface", "second.removeSurface", "second.close"});

    QMenu* mesh = menuBar()->addMenu(tr("&Mesh"));
    add(mesh, {"mesh.check", "mesh.export"});
    mesh->addSeparator();
    add(mesh, {"index.build", "index.cache"});

    QMenu* help = menuBar()->addMenu(tr("&Help"));
    add(help, {"help.shortcuts"});
    help->addSeparator();
    add(help, {"help.about"});
}

void MainWindow::makeToolBar() {
    auto* bar = addToolBar(tr("Main Tool Bar"));
    bar->setObjectName(QStringLiteral("mainToolBar"));
    bar->setMovable(false);
    bar->setIconSize(QSize(20, 20));
    bar->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    actions_->action("file.open")->setIconText(tr("Open"));
    actions_->action("mesh.export")->setIconText(tr("Export"));
    actions_->action("mesh.check")->setIconText(tr("Check"));
    actions_->action("view.fit")->setIconText(tr("Fit"));
    actions_->action("view.perspective")->setIconText(tr("Perspective"));
    actions_->action("view.changed")->setIconText(tr("Retriangulated"));
    actions_->action("view.box")->setIconText(tr("Box"));
    actions_->action("view.axes")->setIconText(tr("Axes"));
    bar->addAction(actions_->action("file.open"));
    bar->addAction(actions_->action("mesh.export"));
    bar->addAction(actions_->action("mesh.check"));
    bar->addSeparator();
    for (const char* id : {"view.fit", "view.perspective", "view.changed", "view.box", "view.axes"})
        bar->addAction(actions_->action(id));
    for (auto* button : bar->findChildren<QToolButton*>())
        button->setFocusPolicy(Qt::TabFocus);
    panelsMenu_->addSeparator();
    panelsMenu_->addAction(bar->toggleViewAction());
}

void MainWindow::connectActions() {
    const auto on = [this](const char* id, auto handler) {
        connect(actions_->action(id), &QAction::triggered, this, handler);
    };
    on("file.open", [this] { openFlow_->askFile(); });
    on("file.openFolder", [this] { openFlow_->askFolder(); });
    on("file.importRaw", [this] { openFlow_->askRawFile(); });
    on("file.sampleBluntFin", [this] { openFlow_->openSample(QStringLiteral("bluntfin")); });
    on("file.sampleShell", [this] { openFlow_->openSample(QStringLiteral("shell")); });
    on("second.open", [this] { secondFlow_->askFile(); });
    on("file.openSession", [this] { keeper_->askOpen(); });
    on("file.saveSession", [this] { keeper_->askSave(); });
    on("file.saveImage", [this] { pictureFlow_->ask(); });
    on("file.close", [this] { session_.close(); });
    on("file.quit", [this] { close(); });
    on("mesh.check", [this] {
        meshDock_->show();
        meshDock_->raise();
        session_.checkMesh();
    });
    on("index.build", [this] { session_.buildIndex(); });
    on("index.cache", [this] { (new CacheDialog(session_, settings_, this))->show(); });
    on("view.resetLayout", [this] { resetLayout(); });
    // Adds to the window's state: a maximised window is one again afterwards.
    on("view.fullScreen", [this](bool isFull) { setWindowState(windowState().setFlag(Qt::WindowFullScreen, isFull)); });
    on("help.shortcuts", [this] { showShortcutSheet(*actions_, this); });
    on("help.about", [this] { showAbout(this); });

    QAction* previewsFirst = actions_->action("file.previewsFirst");
    previewsFirst->setChecked(settings_.boolean("files/previewsFirst"));
    connect(previewsFirst, &QAction::toggled, openFlow_, &OpenFlow::setPreviewsFirst);
    for (OpenFlow* flow : {openFlow_, secondFlow_})
        connect(flow, &OpenFlow::previewsFirstChanged, previewsFirst, &QAction::setChecked);

    QAction* perspective = actions_->action("view.perspective");
    connect(perspective, &QAction::toggled, this, [this](bool isOn) { settings_.set("view/perspective", isOn); });
    // Toggled once even when already so: the camera hears of it through the action.
    perspective->setChecked(!settings_.boolean("view/perspective"));
    perspective->toggle();
}

void MainWindow::showRecentFiles() {
    const auto recent = recentFiles_->all();
    recentMenu_->clear();
    int number = 1;
    for (const auto& file : recent) {
        const QString key = number == 10 ? QStringLiteral("1&0") : QStringLiteral("&%1").arg(number);
        ++number;
        QAction* action = recentMenu_->addAction(key + QLatin1Char(' ') + recentTitle(file));
        action->setToolTip(recentTip(file));
        action->setStatusTip(action->toolTip());
        connect(action, &QAction::triggered, this, [this, file] { openFlow_->openRecent(file); });
    }
    recentMenu_->setToolTipsVisible(true);
    recentMenu_->setEnabled(!recent.empty());
    recentMenu_->addSeparator();
    QAction* clear = recentMenu_->addAction(tr("&Clear List"));
    connect(clear, &QAction::triggered, this, [this] {
        recentFiles_->clear();
        showRecentFiles();
    });
    host_->startPage().setRecentFiles(recent);
}

} // namespace isoslider::widgets
