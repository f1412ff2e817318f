#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>

#include <QApplication>
#include <QIcon>
#include <QStandardPaths>
#include <QSurfaceFormat>
#include <QTimer>

#include "app/desktop/command_line.h"
#include "app/desktop/display_guard.h"
#include "app/desktop/preprocess_index_builder.h"
#include "app/desktop/sample_loader.h"
#include "app/desktop/screenshot_runner.h"
#include "core/base/memory_limit.h"
#include "ui/model/session/session.h"
#include "ui/render/gl_program.h"
#include "ui/render/gl_support.h"
#include "ui/widgets/opening/file_dialogs.h"
#include "ui/widgets/window/main_window.h"
#include "ui/widgets/window/session_keeper.h"
#include "ui/widgets/window/settings_store.h"

namespace isoslider::desktop {
namespace {

/// Before any application object: wrong usage and --help must not need a display.
QStringList argumentsOf(int argc, char** argv) {
    QStringList arguments;
    for (int i = 0; i < argc; ++i)
        arguments << QString::fromLocal8Bit(argv[i]);
    return arguments;
}

/// Qt ends a program that finds no display by a signal; this states it in one line. A platform that was
/// asked for by name is Qt's to judge.
bool hasDisplay() {
#if defined(__linux__)
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"})
        if (!qEnvironmentVariableIsEmpty(name))
            return true;
    return false;
#else
    return true;
#endif
}

int print(const ParsedCommandLine& parsed) {
    std::FILE* stream = *parsed.exitCode == ExitCode::Success ? stdout : stderr;
    std::fputs(qPrintable(parsed.output), stream);
    return static_cast<int>(*parsed.exitCode);
}

void setUpApplication() {
    QApplication::setApplicationName(QStringLiteral("isoslider"));
    QApplication::setApplicationDisplayName(QStringLiteral("ISOSLIDER"));
    QApplication::setApplicationVersion(QStringLiteral(ISOSLIDER_VERSION));
    QApplication::setDesktopFileName(QStringLiteral("isoslider"));
    render::initializeResources();
}

model::SessionServices makeServices(const CommandLine& line) {
    model::SessionServices services;
    services.postToMain = [](std::function<void()> function) {
        // The application object is the context: once it is gone, nothing is run.
        if (auto* application = QCoreApplication::instance())
            QMetaObject::invokeMethod(application, std::move(function), Qt::QueuedConnection);
    };
    services.indexBuilder = std::make_shared<PreprocessIndexBuilder>();
    // The self-test wants an answer, not a large picture.
    services.sampleLoader = makeSampleLoader(line.isSelfTest ? GridDims{48, 48, 48} : GridDims{0, 0, 0});
    const QString cache = QStandardPaths::writableLocation(QStandardPaths::GenericCacheLocation);
    services.cacheFolder = std::filesystem::path(cache.toStdU16String()) / "isoslider" / "indexes";
    services.backgroundPriority = model::JobPriority::Low; // what the user does comes first
    services.wholeVolumeBytes = usableMemoryBytes() / 2;
    return services;
}

/// Where running programs keep their sessions.
std::filesystem::path sessionFolder() {
    const QString data = QStandardPaths::writableLocation(QStandardPaths::GenericDataLocation);
    return std::filesystem::path(data.toStdU16String()) / "isoslider" / "sessions";
}

void openFirst(widgets::MainWindow& window, model::Session& session, const CommandLine& line) {
    const bool asksUser = line.screenshot.isEmpty() && !line.isSelfTest;
    model::OpenRequest request;
    request.isovalue = line.isovalue;
    request.readOptions = line.readOptions;
    if (line.isSelfTest)
        request.sampleName = "shell";
    else if (!line.sample.isEmpty())
        request.sampleName = line.sample.toStdString();
    else if (!line.file.isEmpty())
        request.path = std::filesystem::path(line.file.toStdU16String());
    else
        return;
    if (!line.file.isEmpty() && (asksUser || model::isSessionFile(request.path)))
        window.openFile(line.file, line.isovalue, line.readOptions);
    else
        session.open(std::move(request));
    if (!line.furtherFiles.isEmpty())
        window.reportNotOpened(line.furtherFiles);
}

int run(int argc, char** argv, const CommandLine& line) {
    if (!hasDisplay()) {
        std::fputs("isoslider: no display: set DISPLAY or WAYLAND_DISPLAY, or run it under xvfb-run\n", stderr);
        return static_cast<int>(ExitCode::IoFailure);
    }
    std::optional<DisplayGuard> guard(std::in_place);
    QApplication application(argc, argv);
    guard.reset();
    setUpApplication();
    const bool isInteractive = line.screenshot.isEmpty() && !line.isSelfTest;
    widgets::SettingsStore settings;
    widgets::PlatformFileDialogs dialogs;
    model::Session session(makeServices(line));
    widgets::MainWindow window(session, settings, dialogs);
    if (isInteractive && !line.size)
        window.restoreLayout();
    if (line.size)
        window.resize(*line.size);
    window.show();
    if (isInteractive)
        window.sessionKeeper().keepIn(sessionFolder());
    std::unique_ptr<ScreenshotRunner> runner;
    if (!isInteractive)
        runner = std::make_unique<ScreenshotRunner>(window, session, line.screenshot);
    QTimer::singleShot(0, &window, [&] { openFirst(window, session, line); });
    return QApplication::exec();
}

} // namespace
} // namespace isoslider::desktop

int main(int argc, char** argv) {
    using namespace isoslider::desktop;
    std::signal(SIGXFSZ, SIG_IGN); // a file beyond the shell's limit is a failed write like any other
    const auto parsed = parseCommandLine(argumentsOf(argc, argv));
    if (parsed.exitCode)
        return print(parsed);
    return run(argc, argv, parsed.commandLine);
}
