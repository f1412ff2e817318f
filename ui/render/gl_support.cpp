#include "ui/render/gl_support.h"

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

/// Empty if it works.
QString tryContext() {
    if (isPictureless(QGuiApplication::platformName()))
        return tr("the display (%1) shows none").arg(QGuiApplication::platformName());
    QOpenGLContext context;
    context.setFormat(viewportFormat());
    if (!context.create())
        return tr("the display (%1) gives no OpenGL context").arg(QGuiApplication::platformName());
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    if (!surface.isValid() || !context.makeCurrent(&surface))
        return tr("the OpenGL context of the display (%1) cannot be used").arg(QGuiApplication::platformName());
    const auto version = context.format().version();
    const bool isUsable = version >= qMakePair(3, 3) &&
                          QOpenGLVersionFunctionsFactory::get<QOpenGLFunctions_3_3_Core>(&context) != nullptr;
    const QString problem =
        isUsable ? QString()
                 : tr("%1 has only OpenGL %2.%3").arg(driverName(context)).arg(version.first).arg(version.second);
    context.doneCurrent();
    return problem;
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

QString openGlProblem() {
    static const QString problem = tryContext();
    return problem;
}

bool isOpenGlUsable() { return openGlProblem().isEmpty(); }

} // namespace isoslider::render
