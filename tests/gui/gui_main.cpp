// Runs GoogleTest cases with a real application object, in a home folder of their own. Any Qt
// warning fails the case it appears in.
#include <array>
#include <cstdlib>

#include <QApplication>
#include <QByteArray>
#include <QString>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "ui/render/gl_program.h"

namespace {

/// Said by the platform about the test machine, not by our code.
bool isAboutTheMachine(const QString& message) {
    static constexpr std::array<const char*, 4> kKnown{"XDG_RUNTIME_DIR", "This plugin does not support",
                                                       "QXcbConnection: XCB error", "Unable to query"};
    for (const char* known : kKnown)
        if (message.contains(QLatin1String(known)))
            return true;
    return false;
}

void failOnWarnings(QtMsgType type, const QMessageLogContext&, const QString& message) {
    if (type == QtDebugMsg || type == QtInfoMsg || isAboutTheMachine(message))
        return;
    ADD_FAILURE() << "Qt says: " << message.toStdString();
}

} // namespace

int main(int argc, char** argv) {
    ::testing::InitGoogleTest(&argc, argv);
    if (::testing::GTEST_FLAG(list_tests))
        return RUN_ALL_TESTS();
    const isoslider::test::TemporaryFolder home;
    for (const char* name : {"HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DATA_HOME", "XDG_RUNTIME_DIR"})
        ::setenv(name, home.path().c_str(), 1);
    std::filesystem::permissions(home.path(), std::filesystem::perms::owner_all);
    qInstallMessageHandler(failOnWarnings);
    QApplication application(argc, argv);
    QApplication::setApplicationName(QStringLiteral("isoslider"));
    isoslider::render::initializeResources();
    return RUN_ALL_TESTS();
}
