#include <QAction>
#include <QDockWidget>
#include <QMenu>
#include <QMenuBar>
#include <QToolBar>

#include "ui/model/session/session.h"
#include "ui/widgets/opening/open_flow.h"
#include "ui/widgets/opening/recent_files.h"
#include "ui/widgets/opening/start_page.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/help_dialogs.h"
#include "ui/widgets/window/main_window.h"
#include "ui/widgets/window/session_keeper.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::widgets {

void MainWindow::makeMenus() {
    const auto add = [this](QMenu* menu, std::initializer_list<const char*> ids) {
        for (const char* id : ids)
            menu->addAction(actions_->action(id));
    };
    QMenu* file = menuBar()->addMenu(tr("&File"));
    add(file, {"file.open", "file.openFolder", "file.importRaw"});
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

    QMenu* view = menuBar()->addMenu(tr("&View"));
    add(view, {"view.reset", "view.perspective"});
    QMenu* standard = view->addMenu(tr("&Standard Views"));
    add(standard, {"view.front", "view.back", "view.right", "view.left", "view.top", "view.bottom"});
    view->addSeparator();
    add(view, {"view.changed", "view.edges", "view.levels", "view.box", "view.axes", "view.readout"});
    view->addSeparator();
    QMenu* panels = view->addMenu(tr("Pa&nels"));
    for (QDockWidget* dock : {datasetDock_, isovalueDock_, levelsDock_, meshDock_, topologyDock_, jobsDock_})
        panels->addAction(dock->toggleViewAction());
    panelsMenu_ = panels;
    add(view, {"view.resetLayout", "view.fullScreen"});

    QMenu* isovalue = menuBar()->addMenu(tr("&Isovalue"));
    add(isovalue, {"isovalue.edit", "isovalue.play"});
    isovalue->addSeparator();
    add(isovalue, {"isovalue.previousEvent", "isovalue.nextEvent", "isovalue.snap", "isovalue.clearEvent"});
    isovalue->addSeparator();
    add(isovalue, {"isovalue.logCounts", "isovalue.coarserWhileMoving", "isovalue.resetZoom"});

    QMenu* mesh = menuBar()->addMenu(tr("&Mesh"));
    add(mesh, {"mesh.check", "mesh.export"});
    mesh->addSeparator();
    add(mesh, {"index.build"});

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
    actions_->action("view.reset")->setIconText(tr("Fit"));
    actions_->action("view.perspective")->setIconText(tr("Perspective"));
    actions_->action("view.changed")->setIconText(tr("Highlight"));
    actions_->action("view.box")->setIconText(tr("Box"));
    actions_->action("view.axes")->setIconText(tr("Axes"));
    bar->addAction(actions_->action("file.open"));
    bar->addAction(actions_->action("mesh.export"));
    bar->addAction(actions_->action("mesh.check"));
    bar->addSeparator();
    for (const char* id : {"view.reset", "view.perspective", "view.changed", "view.box", "view.axes"})
        bar->addAction(actions_->action(id));
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
    on("file.openSession", [this] { keeper_->askOpen(); });
    on("file.saveSession", [this] { keeper_->askSave(); });
    on("file.saveImage", [this] { askSaveImage(); });
    on("file.close", [this] { session_.close(); });
    on("file.quit", [this] { close(); });
    on("mesh.check", [this] {
        meshDock_->show();
        meshDock_->raise();
        session_.checkMesh();
    });
    on("mesh.export", [this] { askExport(); });
    on("index.build", [this] { session_.buildIndex(); });
    on("view.resetLayout", [this] { resetLayout(); });
    // Adds to the window's state: a maximised window is one again afterwards.
    on("view.fullScreen", [this](bool isFull) { setWindowState(windowState().setFlag(Qt::WindowFullScreen, isFull)); });
    on("help.shortcuts", [this] { showShortcutSheet(*actions_, this); });
    on("help.about", [this] { showAbout(this); });

    QAction* previewsFirst = actions_->action("file.previewsFirst");
    previewsFirst->setChecked(settings_.boolean("files/previewsFirst"));
    connect(previewsFirst, &QAction::toggled, openFlow_, &OpenFlow::setPreviewsFirst);
    connect(openFlow_, &OpenFlow::previewsFirstChanged, previewsFirst, &QAction::setChecked);

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
