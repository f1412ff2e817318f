#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <QObject>
#include <QString>
#include <QTimer>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/session/saved_session.h"
#include "ui/model/session/session_slot.h"

class QWidget;

namespace isoslider::model {
class Session;
class SliceModel;
} // namespace isoslider::model

namespace isoslider::widgets {

class ActionRegistry;
class FileDialogs;
class HistogramPlot;
class MessageBar;
class ViewportHost;

/// Saves what is shown, as a file that the user names and by itself while the program runs, and shows it again.
/// Window thread only; everything given must outlive this.
class SessionKeeper : public QObject {
    Q_OBJECT
public:
    /// What was lost is offered on `recoveryBar`, which nothing else uses: no other message takes its place.
    SessionKeeper(model::Session& session, ViewportHost& host, model::SliceModel& slices, const ActionRegistry& actions,
                  FileDialogs& dialogs, MessageBar& messageBar, MessageBar& recoveryBar, QWidget* window);
    ~SessionKeeper() override;

    /// Whose range is kept, too.
    void setPlot(HistogramPlot& plot);
    void askSave();
    void askOpen();
    /// Shows what the file keeps, as far as it can be understood, and states what could not be.
    void open(const QString& path);

    /// From here on, keeps the session in `folder` within `interval` of any change, and removes it when this
    /// ends. Offers those that programs lost there.
    void keepIn(const std::filesystem::path& folder, std::chrono::milliseconds interval = std::chrono::seconds(5));

Q_SIGNALS:
    void opening();

private:
    model::SavedSession capture() const;
    void save(const model::SavedSession& saved, const QString& path);
    /// What is restored, and from where.
    struct Restored {
        model::SavedSession saved;
        QString name; ///< in messages
        QString file; ///< empty: from none that the user has named
    };
    void restore(const Restored& restored, std::vector<std::string> problems);
    void askWhereVolumeIs(const Restored& restored, const std::vector<std::string>& problems);
    void showView();
    void noteChange();
    void autosave();
    void offerLost();
    void tellProblems(const QString& name, const std::vector<std::string>& problems);

    model::Session& session_;
    ViewportHost& host_;
    model::SliceModel& slices_;
    const ActionRegistry& actions_;
    FileDialogs& dialogs_;
    MessageBar& messageBar_;
    MessageBar& recoveryBar_;
    HistogramPlot* plot_ = nullptr;
    QWidget* window_;
    std::optional<Restored> pending_; ///< its view is shown once its volume is
    QString file_; ///< that what is shown was restored from or saved to; empty: none
    std::shared_ptr<model::SessionSlot> slot_;
    std::vector<std::unique_ptr<model::SessionSlot>> lost_; ///< the newest first; the first is on offer
    QTimer timer_;
    model::DatasetGeneration shownDataset_{};
    std::vector<model::Subscription> subscriptions_;
    std::shared_ptr<model::BackgroundJobs> jobs_;
    model::LatestJob<bool> saving_; // last: nothing is reported once it is gone
};

} // namespace isoslider::widgets
