#include "app/desktop/display_guard.h"

#include <cstdio>
#include <cstdlib>

#include <QByteArrayList>
#include <QString>

#include "app/desktop/command_line.h"

namespace isoslider::desktop {
namespace {

// Qt's handler is a bare function; its state is that of the one application object.
QtMessageHandler previousHandler = nullptr;
QByteArrayList heldBack; // what the platform reported it far

void onMessage(QtMsgType type, const QMessageLogContext& context, const QString& message) {
    const bool isAboutTheDisplay = QByteArray(context.category).startsWith("qt.qpa");
    if (type == QtFatalMsg) {
        const QByteArray reason =
            heldBack.isEmpty() ? message.section(QLatin1Char('\n'), 0, 0).toLocal8Bit() : heldBack.first();
        std::fprintf(stderr, "isoslider: no display: %s; set DISPLAY or WAYLAND_DISPLAY, or run it under xvfb-run\n",
                     reason.constData());
        std::fflush(stderr);
        std::_Exit(static_cast<int>(ExitCode::IoFailure)); // nothing has been made that would have to be put away
    }
    if (!isAboutTheDisplay)
        return previousHandler(type, context, message);
    heldBack << message.trimmed().toLocal8Bit();
}

} // namespace

DisplayGuard::DisplayGuard() { previousHandler = qInstallMessageHandler(onMessage); }

DisplayGuard::~DisplayGuard() {
    qInstallMessageHandler(previousHandler);
    for (const auto& line : heldBack)
        std::fprintf(stderr, "%s\n", line.constData());
    heldBack.clear();
}

} // namespace isoslider::desktop
