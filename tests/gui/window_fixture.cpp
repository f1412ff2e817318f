#include "tests/gui/window_fixture.h"

#include <cmath>
#include <fstream>

#include <QAction>
#include <QApplication>
#include <QDropEvent>
#include <QElapsedTimer>
#include <QMimeData>
#include <QPointer>
#include <QTest>
#include <QUrl>

#include "core/volume_io/sources/volume_source.h"
#include "preprocess/build_index.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/sanitizers.h"
#include "ui/widgets/window/action_registry.h"

namespace isoslider::test {

Status HoldableBuilder::build(const std::shared_ptr<const ScalarGrid>& grid, const std::string& sourceName,
                              const io::VolumeInfo& about, const std::filesystem::path& indexPath,
                              const JobControl& job) {
    io::VolumeInfo info;
    info.lengthUnit = about.lengthUnit;
    info.resampling = about.resampling;
    return buildFrom(*io::makeMemorySource(grid, std::move(info)), sourceName, indexPath, job);
}

Status HoldableBuilder::buildFromFile(const std::filesystem::path& volume, const io::ReadOptions& options,
                                      const std::string& sourceName, const std::filesystem::path& indexPath,
                                      const JobControl& job) {
    const auto source = io::openVolume(volume, options);
    return source.isOk() ? buildFrom(*source.value(), sourceName, indexPath, job) : Status{source.error()};
}

Status HoldableBuilder::buildFrom(io::VolumeSource& source, const std::string& sourceName,
                                  const std::filesystem::path& indexPath, const JobControl& job) {
    while (holds && !job.isStopRequested())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (job.isStopRequested())
        return cancelledError();
    preprocess::BuildOptions options;
    options.sourceName = sourceName;
    options.kind = kind;
    auto report = preprocess::buildIndex(source, indexPath, options, job);
    return report.isOk() ? Status{} : Status{report.error()};
}

Result<std::unique_ptr<extract::SlideEngine>> HoldableBuilder::engineInMemory(
    const std::shared_ptr<const ScalarGrid>& grid, const JobControl& job) {
    while (holdsEngine && !job.isStopRequested()) {
        job.report(0.5, "looking at samples");
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return preprocess::makeMemoryEngine(grid, job);
}

std::filesystem::path writeBall(const TemporaryFolder& folder, const char* name, int n) {
    std::string bytes = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
    const std::string size = std::to_string(n);
    bytes.append("DimSize = ").append(size).append(" ").append(size).append(" ").append(size);
    bytes += "\nElementSpacing = 1 1 1\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
    const float middle = static_cast<float>(n - 1) / 2.0f;
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const float value = -std::hypot(static_cast<float>(x) - middle, static_cast<float>(y) - middle,
                                                static_cast<float>(z) - middle);
                bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
            }
    return folder.write(name, bytes);
}

void doubleClick(QWidget& widget, Qt::MouseButton button, Qt::KeyboardModifiers modifiers, QPoint at) {
    const QPointer<QWidget> alive(&widget); // a double click may close what it was made on
    QTest::mouseDClick(&widget, button, modifiers, at);
    QWidget* receiver = alive != nullptr ? alive.data() : QApplication::activeWindow();
    if (receiver != nullptr)
        QTest::mouseRelease(receiver, button, modifiers, at);
}

WindowTest::WindowTest()
    : settings_(std::make_unique<widgets::SettingsStore>(QString::fromStdString((folder_ / "settings.ini").string()))) {
    makeWindow();
}

WindowTest::~WindowTest() {
    // A button that stays down would be held for all tests that follow.
    const Qt::MouseButtons held = QGuiApplication::mouseButtons();
    EXPECT_EQ(held, Qt::NoButton) << "a mouse button is still down";
    for (const auto button : {Qt::LeftButton, Qt::MiddleButton, Qt::RightButton}) {
        if (held.testFlag(button) && window_ != nullptr)
            QTest::mouseRelease(window_.get(), button);
    }
    window_.reset();
    session_.reset();
    QCoreApplication::sendPostedEvents();
}

void WindowTest::makeWindow() {
    window_.reset();
    session_.reset();
    model::SessionServices services;
    services.postToMain = [](std::function<void()> function) {
        QMetaObject::invokeMethod(QCoreApplication::instance(), std::move(function), Qt::QueuedConnection);
    };
    services.indexBuilder = builder_;
    services.volumes = volumes_;
    services.cacheFolder = folder_ / "indexes";
    services.wholeVolumeBytes = wholeVolumeBytes_;
    services.backgroundPriority = backgroundPriority_;
    services.sampleLoader = [](const std::string& name,
                               const JobControl&) -> Result<std::shared_ptr<const ScalarGrid>> {
        return makeError(ErrorCode::NotFound, "no such sample", name);
    };
    session_ = std::make_unique<model::Session>(std::move(services));
    window_ = std::make_unique<widgets::MainWindow>(*session_, *settings_, dialogs_);
    window_->resize(1400, 900);
    window_->show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(window_.get()));
    // Shortcuts and focus need an active window, which a display without a window manager never makes.
    QApplication::setActiveWindow(window_.get());
}

bool WindowTest::waitUntil(const std::function<bool()>& isDone, std::chrono::milliseconds longest) {
    QElapsedTimer clock;
    clock.start();
    constexpr int kSlower = kHasSanitizers ? 5 : 1;
    while (!isDone()) {
        if (clock.elapsed() > kSlower * longest.count())
            return false;
        QTest::qWait(5);
    }
    return true;
}

bool WindowTest::waitUntilSettled() {
    return waitUntil([this] { return session_->isSettled(); });
}

void WindowTest::openBall(int n) {
    window_->openFile(QString::fromStdString(writeBall(folder_, "ball.mha", n).string()));
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr; }));
    if (!builder_->holds) {
        ASSERT_TRUE(waitUntilSettled());
        ASSERT_EQ(session_->indexState(), model::IndexState::Ready);
    }
}

void WindowTest::trigger(const char* actionId) {
    QAction* action = window_->actions().action(actionId);
    ASSERT_TRUE(action->isEnabled()) << actionId;
    action->trigger();
}

void WindowTest::drop(const std::filesystem::path& path) {
    QMimeData data;
    data.setUrls({QUrl::fromLocalFile(QString::fromStdString(path.string()))});
    QDragEnterEvent enter(QPoint(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window_.get(), &enter);
    ASSERT_TRUE(enter.isAccepted());
    QDropEvent event(QPointF(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(window_.get(), &event);
}

void WindowTest::keepPicture(QWidget& widget, const char* name) {
    const QString folder = qEnvironmentVariable("ISOSLIDER_RECORD_FOLDER");
    if (folder.isEmpty())
        return;
    QTest::qWait(50); // layouts and queued paints
    EXPECT_TRUE(widget.grab().save(folder + QStringLiteral("/%1.png").arg(QLatin1String(name))));
}

} // namespace isoslider::test
