#include "app/desktop/screenshot_runner.h"

#include <cstdio>

#include <QApplication>
#include <QPixmap>

#include "ui/model/session.h"
#include "ui/render/gl_support.h"
#include "ui/widgets/main_window.h"
#include "ui/widgets/viewport_host.h"
#include "ui/widgets/viewport_widget.h"

namespace isoslider::desktop {
namespace {

constexpr int kPollMs = 30;

} // namespace

ExitCode exitCodeOf(const model::Notice& notice) {
    switch (notice.code) {
        case ErrorCode::NotFound:
        case ErrorCode::IoError:
        case ErrorCode::OutOfSpace: return kIoFailure;
        default: return kRefusedInput;
    }
}

ScreenshotRunner::ScreenshotRunner(widgets::MainWindow& window, model::Session& session, QString path)
    : QObject(&window), window_(window), session_(session), path_(std::move(path)) {
    noticeSubscription_ = session_.noticePosted().observe([this](const model::Notice& notice) {
        if (notice.severity != model::Notice::Severity::Error)
            return;
        // An index that cannot be built or kept does not take the surface off the screen.
        if (session_.dataset() == nullptr)
            return endWith(notice);
        std::fprintf(stderr, "isoslider: %s\n", notice.detail.c_str());
        exitCode_ = exitCodeOf(notice);
    });
    connect(&timer_, &QTimer::timeout, this, &ScreenshotRunner::poll);
    timer_.start(kPollMs);
}

void ScreenshotRunner::poll() {
    if (!session_.isSettled()) {
        isWaitingForPaint_ = false;
        return;
    }
    // Settled values still have to reach the panels and the screen.
    auto* viewport = window_.viewportHost().viewport();
    if (!isWaitingForPaint_) {
        isWaitingForPaint_ = true;
        paintedBefore_ = viewport != nullptr ? viewport->paintedFrames() : 0;
        if (viewport != nullptr)
            viewport->update();
        timer_.start(4 * kPollMs);
        return;
    }
    if (viewport == nullptr || viewport->paintedFrames() > paintedBefore_)
        grab();
}

void ScreenshotRunner::grab() {
    timer_.stop();
    if (!path_.isEmpty() && !window_.grab().save(path_)) {
        std::fprintf(stderr, "isoslider: %s: the picture could not be written; check the folder and the suffix\n", qPrintable(path_));
        return QApplication::exit(kIoFailure);
    }
    if (!path_.isEmpty() && session_.frame() != nullptr && !render::isOpenGlUsable())
        std::fprintf(stderr, "isoslider: the picture shows no surface, for want of OpenGL 3.3: %s\n", qPrintable(render::openGlProblem()));
    QApplication::exit(exitCode_);
}

void ScreenshotRunner::endWith(const model::Notice& notice) {
    timer_.stop();
    std::fprintf(stderr, "isoslider: %s\n", notice.detail.c_str());
    QApplication::exit(exitCodeOf(notice));
}

} // namespace isoslider::desktop
