#include "ui/render/gl_support.h"

#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLFunctions_3_3_Core>
#include <QOpenGLVersionFunctionsFactory>
#include <QSurfaceFormat>

namespace isoslider::render {
namespace {

bool tryContext() {
    QOpenGLContext context;
    context.setFormat(viewportFormat());
    if (!context.create())
        return false;
    QOffscreenSurface surface;
    surface.setFormat(context.format());
    surface.create();
    if (!surface.isValid() || !context.makeCurrent(&surface))
        return false;
    const bool isUsable = context.format().version() >= qMakePair(3, 3) &&
                          QOpenGLVersionFunctionsFactory::get<QOpenGLFunctions_3_3_Core>(&context) != nullptr;
    context.doneCurrent();
    return isUsable;
}

} // namespace

QSurfaceFormat viewportFormat() {
    QSurfaceFormat format;
    format.setRenderableType(QSurfaceFormat::OpenGL);
    format.setVersion(3, 3);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    format.setSamples(4);
    return format;
}

bool isOpenGlUsable() {
    static const bool isUsable = tryContext();
    return isUsable;
}

} // namespace isoslider::render
