#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <QMainWindow>
#include <QStringList>

#include "core/grid/value_spread.h"
#include "core/volume_io/volume_reader.h"
#include "ui/model/observers.h"

class QDockWidget;
class QMenu;

namespace isoslider::model {
class Session;
class SliceModel;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class CompactLayout;
class FileDialogs;
class IsovaluePanel;
class MessageBar;
class OpenFlow;
class PictureFlow;
class RecentFiles;
class SessionKeeper;
class SettingsStore;
class SliceWorkspace;
class SurfacesPanel;
class TopologyPanel;
class ViewportHost;

/// The program's window: the view in the middle, panels around it, menus and tool bar. Everything it
/// is given must outlive it.
class MainWindow : public QMainWindow {
    Q_OBJECT
public:
    MainWindow(model::Session& session, SettingsStore& settings, FileDialogs& dialogs, QWidget* parent = nullptr);
    ~MainWindow() override;

    /// Opens a volume, a folder, an index or a session file, and remembers it among the recent files once it is open.
    /// Asks what has to be known of it first. `isovalue`: the first one; otherwise a suggested one.
    /// `options`: which volume of the file, as far as it is known.
    void openFile(const QString& path, std::optional<AskedIsovalue> isovalue = std::nullopt,
                  const io::ReadOptions& options = {});
    /// Reports that these were given, and that one volume is shown at a time.
    void reportNotOpened(const QStringList& files);
    /// Place, size and panels as they were when the window was last closed.
    void restoreLayout();
    void resetLayout();

    const ActionRegistry& actions() const { return *actions_; }
    ViewportHost& viewportHost() { return *host_; }
    IsovaluePanel& isovaluePanel() { return *isovaluePanel_; }
    MessageBar& messageBar() { return *messageBar_; }
    SessionKeeper& sessionKeeper() { return *keeper_; }
    model::SliceModel& slices() { return *slices_; }
    SliceWorkspace& sliceWorkspace() { return *sliceWorkspace_; }

protected:
    void closeEvent(QCloseEvent* event) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    void changeEvent(QEvent* event) override;

private:
    void makeCentre();
    void makeDocks();
    void makeMenus();
    void makeToolBar();
    void connectActions();
    /// In the order of the menu of panels.
    std::vector<QDockWidget*> allDocks() const;
    QDockWidget* addDock(const QString& title, const char* name, QWidget* panel);
    void showDataset();
    void showRecentFiles();
    void updateActions();

    model::Session& session_;
    SettingsStore& settings_;
    FileDialogs& dialogs_;
    std::unique_ptr<RecentFiles> recentFiles_;
    ActionRegistry* actions_;
    OpenFlow* openFlow_;
    OpenFlow* secondFlow_; ///< of a second volume
    SessionKeeper* keeper_ = nullptr;
    PictureFlow* pictureFlow_ = nullptr;
    MessageBar* messageBar_ = nullptr;
    MessageBar* recoveryBar_ = nullptr;
    std::unique_ptr<model::SliceModel> slices_;
    ViewportHost* host_ = nullptr;
    SliceWorkspace* sliceWorkspace_ = nullptr;
    IsovaluePanel* isovaluePanel_ = nullptr;
    TopologyPanel* topologyPanel_ = nullptr;
    SurfacesPanel* surfacesPanel_ = nullptr;
    CompactLayout* compactLayout_ = nullptr;
    QMenu* recentMenu_ = nullptr;
    QMenu* panelsMenu_ = nullptr;
    QDockWidget* datasetDock_ = nullptr;
    QDockWidget* isovalueDock_ = nullptr;
    QDockWidget* countsDock_ = nullptr;
    QDockWidget* levelsDock_ = nullptr;
    QDockWidget* meshDock_ = nullptr;
    QDockWidget* topologyDock_ = nullptr;
    QDockWidget* piecesDock_ = nullptr;
    QDockWidget* clipDock_ = nullptr;
    QDockWidget* colourDock_ = nullptr;
    QDockWidget* surfacesDock_ = nullptr;
    QDockWidget* jobsDock_ = nullptr;
    std::vector<model::Subscription> subscriptions_;
};

} // namespace isoslider::widgets
