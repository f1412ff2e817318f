#include "ui/render/gl_program.h"

#include <QLoggingCategory>
#include <QString>

// Q_INIT_RESOURCE may not be used inside a namespace.
static void initializeIsosliderResources() { Q_INIT_RESOURCE(isoslider); }

namespace isoslider::render {

void initializeResources() { initializeIsosliderResources(); }

std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* name) {
    auto program = std::make_unique<QOpenGLShaderProgram>();
    const QString base = QStringLiteral(":/isoslider/shaders/") + QLatin1String(name);
    const bool isBuilt =
        program->addShaderFromSourceFile(QOpenGLShader::Vertex, base + QStringLiteral(".vert")) &&
        program->addShaderFromSourceFile(QOpenGLShader::Fragment, base + QStringLiteral(".frag")) &&
        program->link();
    if (!isBuilt) {
        qWarning("shader %s: %s", name, qPrintable(program->log()));
        return nullptr;
    }
    return program;
}

} // namespace isoslider::render
