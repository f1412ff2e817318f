#include "ui/render/gl_support.h"

#include <algorithm>

#include <QCoreApplication>
#include <QGuiApplication>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions>
#include <QOpenGLFunctions_3_3_Core>
#include <QOpenGLVersionFunctionsFactory>
#include <QSurfaceFormat>

namespace isoslider::render {
namespace {

QString tr(const char* text) { return QCoreApplication::translate("OpenGl", text); }

QString driverName(QOpenGLContext& context) {
    const auto* name = context.functions()->glGetString(GL_RENDERER);
    return name == nullptr ? tr("its driver") : QString::fromLatin1(reinterpret_cast<const char*>(name));
}

/// Platforms without windows that OpenGL can be composed into. Some give contexts all the same, by way of a display.
bool isPictureless(const QString& platform) {
    static const QStringList kPictureless{QStringLiteral("offscreen"), QStringLiteral("minimal"),
                                          QStringLiteral("linuxfb"), QStringLiteral("vnc")};
    return kPictureless.contains(platform);
}

/// As the drivers without a card of Mesa, Windows and Apple name themselves.
bool isSoftware(const QString& driver) {
    static const QStringList kSoftware{QStringLiteral("llvmpipe"),     QStringLiteral("softpipe"),
                                       QStringLiteral("swrast"),       QStringLiteral("software"),
                                       QStringLiteral("basic render"), QStringLiteral("gdi generic")};
    return std::any_of(kSoftware.begin(), kSoftware.end(),
                       [&](const QString& name) { return driver.contains(name, Qt::CaseInsensitive); });
}

struct Trial {
    QString problem; ///< empty if it works
    bool isSoftware = false;
};

Trial tryContext() {
    if (isPictureless(QGuiApplication::platformName()))
        return {tr("the display (%1) shows none").arg(QGuiApplication::platformName())};
    QOpenGLContext context;
    context.setFormat(viewportFormat());
    if (!context.create())
        return {tr("the display (%1) gives no OpenGL context").arg(QGuiApplication::platformName())};
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    if (!surface.isValid() || !context.makeCurrent(&surface))
        return {tr("the OpenGL context of the display (%1) cannot be used").arg(QGuiApplication::platformName())};
    const auto version = context.format().version();
    const bool isUsable = version >= qMakePair(3, 3) &&
                          QOpenGLVersionFunctionsFactory::get<QOpenGLFunctions_3_3_Core>(&context) != nullptr;
    const QString problem =
        isUsable ? QString()
                 : tr("%1 has only OpenGL %2.%3").arg(driverName(context)).arg(version.first).arg(version.second);
    const bool isSoftwareDriver = isSoftware(driverName(context));
    context.doneCurrent();
    return {problem, isSoftwareDriver};
}

const Trial& trial() {
    static const Trial trial = tryContext();
    return trial;
}

} // namespace

QSurfaceFormat viewportFormat() {
    QSurfaceFormat format;
    format.setRenderableType(QSurfaceFormat::OpenGL);
    format.setVersion(3, 3);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    format.setSamples(4);
    format.setOption(QSurfaceFormat::ResetNotification);
    return format;
}

QString openGlProblem() { return trial().problem; }
bool isOpenGlUsable() { return openGlProblem().isEmpty(); }
bool isOpenGlSoftware() { return trial().isSoftware; }

} // namespace isoslider::render
