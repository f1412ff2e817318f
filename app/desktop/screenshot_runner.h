#pragma once

#include <QObject>
#include <QString>
#include <QTimer>

#include "app/desktop/command_line.h"
#include "ui/model/jobs/latest_job.h"
#include "ui/model/observers.h"

namespace isoslider::model {
class Session;
struct Notice;
} // namespace isoslider::model
namespace isoslider::widgets {
class MainWindow;
}

namespace isoslider::desktop {

/// Waits until the surface is on screen and the index is ready, writes a picture of the whole window
/// and ends the program. An error on the way is one line on stderr and its exit code; the picture is
/// still taken when there is a surface to show.
class ScreenshotRunner : public QObject {
    Q_OBJECT
public:
    /// An empty path writes nothing: for --self-test.
    ScreenshotRunner(widgets::MainWindow& window, model::Session& session, QString path);

private:
    void poll();
    void grab();
    void end(const Status& picture);
    void endWith(const model::Notice& notice);

    widgets::MainWindow& window_;
    model::Session& session_;
    QString path_;
    QTimer timer_;
    std::uint64_t paintedBefore_ = 0;
    bool isWaitingForPaint_ = false;
    ExitCode exitCode_ = ExitCode::Success;
    model::Subscription noticeSubscription_;
    model::BackgroundJobs jobs_; // last: stops before the rest goes
};

/// The exit code for a failure of this kind.
ExitCode exitCodeOf(const model::Notice& notice);

} // namespace isoslider::desktop
