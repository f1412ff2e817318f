#include "ui/widgets/window/main_window.h"
#include "ui/widgets/window/export_flow.h"
#include "ui/widgets/window/piece_wiring.h"

#include <utility>

#include <QAction>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QFileInfo>
#include <QIcon>
#include <QMimeData>
#include <QScreen>
#include <QStatusBar>
#include <QVBoxLayout>

#include "ui/model/session/session.h"
#include "ui/model/slices/slice_model.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/opening/file_filters.h"
#include "ui/widgets/opening/open_flow.h"
#include "ui/widgets/opening/recent_files.h"
#include "ui/widgets/opening/start_page.h"
#include "ui/widgets/panels/clip_panel.h"
#include "ui/widgets/panels/colour_panel.h"
#include "ui/widgets/panels/counts_panel.h"
#include "ui/widgets/panels/dataset_panel.h"
#include "ui/widgets/panels/jobs_panel.h"
#include "ui/widgets/panels/levels_panel.h"
#include "ui/widgets/panels/mesh_panel.h"
#include "ui/widgets/panels/pieces_panel.h"
#include "ui/widgets/panels/surfaces_panel.h"
#include "ui/widgets/panels/topology_panel.h"
#include "ui/widgets/slices/slice_wiring.h"
#include "ui/widgets/slices/slice_workspace.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/cache_dialog.h"
#include "ui/widgets/window/colour_wiring.h"
#include "ui/widgets/window/compact_layout.h"
#include "ui/widgets/window/crop_wiring.h"
#include "ui/widgets/window/dock_focus.h"
#include "ui/widgets/window/job_status.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/picture_flow.h"
#include "ui/widgets/window/session_keeper.h"
#include "ui/widgets/window/settings_store.h"
#include "ui/widgets/window/stage_wiring.h"
#include "ui/widgets/window/surface_wiring.h"
#include "ui/widgets/window/topology_status.h"
#include "ui/widgets/window/topology_wiring.h"

namespace isoslider::widgets {
namespace {

constexpr int kMostFilesNamed = 3;

/// Of a window that has none from before: as large as is useful, but whole on its screen, below a title bar.
QSize initialSize(const QWidget& window) {
    constexpr QSize kUseful(1600, 1000);
    constexpr int kTitleBar = 40;
    const QSize available = window.screen()->availableSize() - QSize(0, kTitleBar);
    return kUseful.boundedTo(available.expandedTo(QSize(1, 1)));
}

constexpr qsizetype kMostFieldLetters = 48;

/// "flow.nc – speed, frame 3": the file, and what of it is shown where it states more than samples.
QString titleOf(const model::Dataset& dataset) {
    model::RecentFile shown = model::recentOf(dataset);
    shown.options.raw.reset();
    shown.options.resampleDims = {};
    QString chosen = QString::fromStdString(model::choicesText(shown)).simplified();
    if (shown.options.field.empty() && !dataset.fieldName.empty()) { // the file puts it forward by itself
        const QString field =
            QString::fromStdString(dataset.fieldTitle.empty() ? dataset.fieldName : dataset.fieldTitle).simplified();
        chosen = chosen.isEmpty() ? field : field + QStringLiteral(", ") + chosen;
    }
    if (chosen.size() > kMostFieldLetters)
        chosen = chosen.left(kMostFieldLetters / 2) + QStringLiteral("…") + chosen.right(kMostFieldLetters / 2);
    const QString name = QString::fromStdString(dataset.name);
    return (chosen.isEmpty() ? name : name + QStringLiteral(" – ") + chosen) + QStringLiteral(" – ISOSLIDER");
}

constexpr int kLayoutVersion = 4; // goes up when a panel comes or goes
constexpr int kPanelWidth = 450;
constexpr int kHistogramDockHeight = 290;
constexpr QSize kSmallestWindow(320, 240); // smaller than all panels together, see CompactLayout

} // namespace

MainWindow::MainWindow(model::Session& session, SettingsStore& settings, FileDialogs& dialogs, QWidget* parent)
    : QMainWindow(parent),
      session_(session),
      settings_(settings),
      dialogs_(dialogs),
      recentFiles_(std::make_unique<RecentFiles>(settings)),
      actions_(new ActionRegistry(this)),
      openFlow_(new OpenFlow({[&session](model::OpenRequest request) { session.open(std::move(request)); },
                              session.choiceNeeded(), tr("Open Volume"),
                              [this](const QString& path) { keeper_->open(path); }},
                             session.services(), settings, dialogs, this)),
      secondFlow_(new OpenFlow({[&session](const model::OpenRequest& request) { session.secondVolume().open(request); },
                                session.secondVolume().choiceNeeded(),
                                tr("Open Second Volume"),
                                {}},
                               session.services(), settings, dialogs, this)),
      slices_(std::make_unique<model::SliceModel>(session)) {
    setObjectName(QStringLiteral("mainWindow"));
    setWindowTitle(QStringLiteral("ISOSLIDER"));
    setWindowIcon(QIcon(QStringLiteral(":/isoslider/icons/isoslider.svg")));
    setAcceptDrops(true);
    setMinimumSize(kSmallestWindow);
    setDockOptions(AnimatedDocks | AllowNestedDocks | AllowTabbedDocks);
    setCorner(Qt::BottomRightCorner, Qt::BottomDockWidgetArea);
    connect(openFlow_, &OpenFlow::opening, this, [this] { messageBar_->hide(); });
    makeCentre();
    keeper_ = new SessionKeeper(session_, *host_, *slices_, *actions_, dialogs_, *messageBar_, *recoveryBar_, this);
    connect(keeper_, &SessionKeeper::opening, this, [this] { messageBar_->hide(); });
    pictureFlow_ = new PictureFlow(session_, {*host_, settings_, dialogs_, *messageBar_}, this);
    makeDocks();
    makeMenus();
    makeToolBar();
    connectActions();
    new TopologyStatus(session_, *this);
    auto* jobStatus = new JobStatus(session_, this);
    statusBar()->addPermanentWidget(jobStatus);
    connect(jobStatus, &JobStatus::clicked, jobsDock_, [this] {
        jobsDock_->show();
        jobsDock_->raise();
    });
    subscriptions_.push_back(session_.datasetChanged().observe([this] { showDataset(); }));
    subscriptions_.push_back(session_.frameChanged().observe([this] { updateActions(); }));
    subscriptions_.push_back(session_.certificateChanged().observe([this] { updateActions(); }));
    subscriptions_.push_back(
        session_.noticePosted().observe([this](const model::Notice& notice) { messageBar_->showNotice(notice); }));
    CacheDialog::applyLimit(session_, settings_);
    resize(initialSize(*this));
    resetLayout();
    showRecentFiles();
    showDataset();
}

// A field that loses the keyboard applies what was typed: while there is still all that this changes.
MainWindow::~MainWindow() { hide(); }

void MainWindow::makeCentre() {
    auto* centre = new QWidget(this);
    auto* layout = new QVBoxLayout(centre);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->setSpacing(0);
    recoveryBar_ = new MessageBar(centre);
    recoveryBar_->setObjectName(QStringLiteral("recoveryBar"));
    messageBar_ = new MessageBar(centre);
    host_ = new ViewportHost(session_, settings_, *actions_, centre);
    sliceWorkspace_ = new SliceWorkspace(*slices_, host_, centre);
    new SliceWiring({session_, *slices_, *sliceWorkspace_, *host_}, settings_, *actions_, this);
    new CropWiring(session_, *slices_, *host_, this);
    layout->addWidget(recoveryBar_);
    layout->addWidget(messageBar_);
    layout->addWidget(sliceWorkspace_, 1);
    setCentralWidget(centre);
    connect(&host_->startPage(), &StartPage::openRequested, openFlow_, &OpenFlow::openRecent);
}

QDockWidget* MainWindow::addDock(const QString& title, const char* name, QWidget* panel) {
    auto* dock = new QDockWidget(title, this);
    dock->setObjectName(QLatin1String(name));
    dock->setWidget(panel);
    passByWhileCovered(*dock);
    return dock;
}

void MainWindow::makeDocks() {
    isovaluePanel_ = new IsovaluePanel(session_, settings_, *actions_, this);
    keeper_->setPlot(isovaluePanel_->plot());
    datasetDock_ = addDock(tr("Dataset"), "datasetDock", new DatasetPanel(session_, *actions_, this));
    isovalueDock_ = addDock(tr("Isovalue"), "isovalueDock", isovaluePanel_);
    countsDock_ = addDock(tr("Counts"), "countsDock", new CountsPanel(session_, host_->viewState(), this));
    levelsDock_ = addDock(tr("Levels"), "levelsDock", new LevelsPanel(session_, this));
    meshDock_ = addDock(tr("Mesh"), "meshDock", new MeshPanel(session_, host_->viewState(), *actions_, this));
    topologyPanel_ = new TopologyPanel(session_, *actions_, this);
    topologyDock_ = addDock(tr("Topology"), "topologyDock", topologyPanel_);
    auto* piecesPanel = new PiecesPanel(session_, host_->viewState(), *actions_, this);
    piecesDock_ = addDock(tr("Pieces"), "piecesDock", piecesPanel);
    new ExportFlow(session_, {*actions_, settings_, dialogs_, host_->viewState()}, this);
    new PieceWiring(session_, *actions_, *host_, {*piecesDock_, *piecesPanel}, this);
    clipDock_ = addDock(tr("Clip"), "clipDock", new ClipPanel(session_, *host_, *actions_, this));
    new ColourWiring(session_, *actions_, {settings_, dialogs_, *host_}, this);
    colourDock_ = addDock(tr("Colour"), "colourDock", new ColourPanel(*host_, *actions_, this));
    surfacesPanel_ = new SurfacesPanel(session_, *actions_, this);
    surfacesDock_ = addDock(tr("Surfaces"), "surfacesDock", surfacesPanel_);
    new SurfaceWiring(session_, *actions_, {isovaluePanel_->plot(), *surfacesDock_, *surfacesPanel_}, this);
    jobsDock_ = addDock(tr("Jobs"), "jobsDock", new JobsPanel(session_, this));
    new TopologyWiring(session_, settings_, *actions_, {isovaluePanel_->plot(), *topologyPanel_, *host_}, this);
    new StageWiring(session_, settings_, *actions_, {*host_, *messageBar_}, this);
    setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
    compactLayout_ = new CompactLayout(*this,
                                       {datasetDock_, surfacesDock_, colourDock_, clipDock_, countsDock_, topologyDock_,
                                        piecesDock_, meshDock_, levelsDock_, jobsDock_},
                                       *isovalueDock_, isovaluePanel_->plot());
}

std::vector<QDockWidget*> MainWindow::allDocks() const {
    return {datasetDock_,  surfacesDock_, colourDock_, clipDock_,   isovalueDock_, countsDock_,
            topologyDock_, piecesDock_,   meshDock_,   levelsDock_, jobsDock_};
}

void MainWindow::resetLayout() {
    for (QDockWidget* dock : allDocks()) {
        dock->setFloating(false);
        removeDockWidget(dock);
    }
    addDockWidget(Qt::BottomDockWidgetArea, isovalueDock_);
    addDockWidget(Qt::RightDockWidgetArea, datasetDock_);
    addDockWidget(Qt::RightDockWidgetArea, countsDock_);
    for (QDockWidget* dock : {surfacesDock_, colourDock_, clipDock_})
        tabifyDockWidget(datasetDock_, dock);
    QDockWidget* before = countsDock_;
    for (QDockWidget* dock : {topologyDock_, piecesDock_, meshDock_, levelsDock_, jobsDock_})
        tabifyDockWidget(std::exchange(before, dock), dock);
    for (QDockWidget* dock : allDocks())
        dock->show();
    datasetDock_->raise();
    countsDock_->raise();
    compactLayout_->setExtents(
        {{datasetDock_, kPanelWidth}, {countsDock_, kPanelWidth}, {isovalueDock_, kHistogramDockHeight}});
    resizeDocks({datasetDock_, countsDock_}, {292, 430}, Qt::Vertical);
}

void MainWindow::restoreLayout() {
    restoreGeometry(settings_.bytes("window/geometry"));
    restoreState(settings_.bytes("window/state"), kLayoutVersion);
    compactLayout_->restart();
}

void MainWindow::closeEvent(QCloseEvent* event) {
    settings_.set("window/geometry", saveGeometry());
    settings_.set("window/state", saveState(kLayoutVersion));
    QMainWindow::closeEvent(event);
}

void MainWindow::openFile(const QString& path, std::optional<AskedIsovalue> isovalue, const io::ReadOptions& options) {
    if (model::isSessionFile(std::filesystem::path(path.toStdU16String())))
        keeper_->open(path);
    else
        openFlow_->openPath(path, isovalue, options);
}

void MainWindow::showDataset() {
    const auto* dataset = session_.dataset();
    setWindowTitle(dataset == nullptr ? QStringLiteral("ISOSLIDER") : titleOf(*dataset));
    if (dataset != nullptr && !dataset->path.empty() && recentFiles_->remember(model::recentOf(*dataset)))
        showRecentFiles();
    updateActions();
}

void MainWindow::updateActions() {
    const auto* dataset = session_.dataset();
    const bool hasSurface = session_.frame() != nullptr;
    const auto state = session_.indexState();
    for (const char* id : {"isovalue.edit", "file.close", "file.saveSession", "second.open"})
        actions_->action(id)->setEnabled(dataset != nullptr);
    actions_->action("mesh.export")->setEnabled(hasSurface);
    actions_->action("file.saveImage")->setEnabled(hasSurface && host_->viewport() != nullptr);
    actions_->action("mesh.check")->setEnabled(hasSurface && !session_.isCheckingMesh());
    actions_->action("index.build")
        ->setEnabled(state == model::IndexState::Failed || state == model::IndexState::Cancelled);
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    const auto urls = event->mimeData()->urls();
    if (!urls.isEmpty() && urls.first().isLocalFile())
        event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
    const auto urls = event->mimeData()->urls();
    if (urls.isEmpty() || !urls.first().isLocalFile())
        return;
    event->acceptProposedAction();
    openFile(urls.first().toLocalFile());
    QStringList further;
    for (const auto& url : urls.mid(1))
        further << url.fileName();
    if (!further.isEmpty())
        reportNotOpened(further);
}

void MainWindow::reportNotOpened(const QStringList& files) {
    const QString shown = files.mid(0, kMostFilesNamed).join(QStringLiteral(", "));
    const auto more = files.size() - kMostFilesNamed;
    const QString all = more > 0 ? tr("%1 and %2 more").arg(shown).arg(more) : shown;
    messageBar_->showNotice(
        {model::Notice::Severity::Information,
         tr("One file is opened at a time; a folder of slices is opened as a whole, a second volume beside the "
            "first by the menu Surfaces")
             .toStdString(),
         tr("Not opened: %1").arg(all).toStdString()});
}

void MainWindow::changeEvent(QEvent* event) {
    QMainWindow::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && actions_ != nullptr)
        actions_->refreshIcons();
    if (event->type() == QEvent::WindowStateChange && actions_ != nullptr)
        actions_->action("view.fullScreen")->setChecked(isFullScreen());
}

} // namespace isoslider::widgets
