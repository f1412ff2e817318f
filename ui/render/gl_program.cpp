#include "ui/render/gl_program.h"

#include <QLoggingCategory>
#include <QString>

// Q_INIT_RESOURCE may not be used inside a namespace.
static void initializeIsosliderResources() { Q_INIT_RESOURCE(isoslider); }

namespace isoslider::render {

void initializeResources() { initializeIsosliderResources(); }

std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* vertex, const char* fragment) {
    auto program = std::make_unique<QOpenGLShaderProgram>();
    const QString folder = QStringLiteral(":/isoslider/shaders/");
    const bool isBuilt = program->addShaderFromSourceFile(QOpenGLShader::Vertex,
                                                          folder + QLatin1String(vertex) + QStringLiteral(".vert")) &&
                         program->addShaderFromSourceFile(QOpenGLShader::Fragment,
                                                          folder + QLatin1String(fragment) + QStringLiteral(".frag")) &&
                         program->link();
    if (!isBuilt) {
        qWarning("shader %s: %s", vertex, qPrintable(program->log()));
        return nullptr;
    }
    return program;
}

} // namespace isoslider::render
