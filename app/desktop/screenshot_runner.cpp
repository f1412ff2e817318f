#include "app/desktop/screenshot_runner.h"

#include <cstdio>

#include <QApplication>
#include <QPixmap>

#include "ui/model/session/session.h"
#include "ui/model/slices/slice_model.h"
#include "ui/render/gl_support.h"
#include "ui/widgets/viewport/picture_file.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/main_window.h"

namespace isoslider::desktop {
namespace {

constexpr int kPollMs = 30;

} // namespace

ScreenshotRunner::ScreenshotRunner(widgets::MainWindow& window, model::Session& session, QString path)
    : QObject(&window),
      window_(window),
      session_(session),
      path_(std::move(path)),
      jobs_(session.services().postToMain) {
    noticeSubscription_ = session_.noticePosted().observe([this](const model::Notice& notice) {
        if (notice.severity != model::Notice::Severity::Error)
            return;
        // An index that cannot be built or kept does not take the surface off the screen.
        if (session_.dataset() == nullptr)
            return endWith(notice);
        std::fprintf(stderr, "isoslider: %s\n", notice.detail.c_str());
        exitCode_ = exitCodeOf(notice.code);
    });
    connect(&timer_, &QTimer::timeout, this, &ScreenshotRunner::poll);
    timer_.start(kPollMs);
}

void ScreenshotRunner::poll() {
    if (!session_.isSettled() || !window_.slices().isSettled()) {
        isWaitingForPaint_ = false;
        return;
    }
    if (session_.dataset() != nullptr && !session_.frame()) { // the first move failed, and a notice reported it
        timer_.stop();
        return QApplication::exit(static_cast<int>(exitCode_));
    }
    // Settled values still have to reach the panels and the screen.
    auto* viewport = window_.viewportHost().viewport();
    if (!isWaitingForPaint_) {
        isWaitingForPaint_ = true;
        paintedBefore_ = viewport != nullptr ? viewport->paintedFrames() : 0;
        if (viewport != nullptr)
            viewport->showAgain();
        timer_.start(4 * kPollMs);
        return;
    }
    if (viewport == nullptr || viewport->paintedFrames() > paintedBefore_)
        grab();
}

void ScreenshotRunner::grab() {
    timer_.stop();
    if (const std::string note = session_.noteOnFirstIsovalue(); !note.empty())
        std::fprintf(stderr, "isoslider: %s\n", note.c_str());
    if (path_.isEmpty())
        return end({});
    jobs_.runner().run<bool>(
        "Write the picture",
        [picture = window_.grab().toImage(),
         path = std::filesystem::path(path_.toStdU16String())](const JobControl&) -> Result<bool> {
            ISO_TRY(widgets::writePicture(picture, path));
            return true;
        },
        [this](const Result<bool>& written) { end(written.isOk() ? Status() : Status(written.error())); });
}

void ScreenshotRunner::end(const Status& picture) {
    if (!picture.isOk()) {
        std::fprintf(stderr, "isoslider: %s\n", picture.error().line().c_str());
        return QApplication::exit(static_cast<int>(ExitCode::IoFailure));
    }
    if (!path_.isEmpty() && session_.frame() != nullptr && !render::isOpenGlUsable())
        std::fprintf(stderr, "isoslider: the picture shows no surface because OpenGL 3.3 is missing: %s\n",
                     qPrintable(render::openGlProblem()));
    QApplication::exit(static_cast<int>(exitCode_));
}

void ScreenshotRunner::endWith(const model::Notice& notice) {
    timer_.stop();
    std::fprintf(stderr, "isoslider: %s\n", notice.detail.c_str());
    QApplication::exit(static_cast<int>(exitCodeOf(notice.code)));
}

} // namespace isoslider::desktop
