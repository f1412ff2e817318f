#include "ui/render/gl_program.h"

#include <QFile>
#include <QLoggingCategory>
#include <QString>

// Q_INIT_RESOURCE may not be used inside a namespace.
static void initializeIsosliderResources() { Q_INIT_RESOURCE(isoslider); }

namespace isoslider::render {

void initializeResources() { initializeIsosliderResources(); }

namespace {

QByteArray textOf(const QString& name) {
    QFile file(QStringLiteral(":/isoslider/shaders/") + name);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

// The version must stay the first line.
QByteArray sourceOf(const QString& name, const char* define) {
    QByteArray source = textOf(name);
    if (source.contains("scalarColour("))
        source.insert(source.indexOf('\n') + 1, textOf(QStringLiteral("scalar_colour.glsl")));
    if (define != nullptr)
        source.insert(source.indexOf('\n') + 1, QByteArray("#define ") + define + '\n');
    return source;
}

} // namespace

std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* vertex, const char* fragment, const char* define,
                                                  const char* geometry) {
    auto program = std::make_unique<QOpenGLShaderProgram>();
    const bool isBuilt =
        program->addShaderFromSourceCode(QOpenGLShader::Vertex,
                                         sourceOf(QLatin1String(vertex) + QStringLiteral(".vert"), define)) &&
        program->addShaderFromSourceCode(QOpenGLShader::Fragment,
                                         sourceOf(QLatin1String(fragment) + QStringLiteral(".frag"), define)) &&
        (geometry == nullptr ||
         program->addShaderFromSourceCode(QOpenGLShader::Geometry,
                                          sourceOf(QLatin1String(geometry) + QStringLiteral(".geom"), nullptr))) &&
        program->link();
    if (!isBuilt) {
        qWarning("shader %s: %s", vertex, qPrintable(program->log()));
        return nullptr;
    }
    // Samplers of different kinds must not share a unit, whether anything is read from them or not.
    program->bind();
    program->setUniformValue("scalarField", kScalarFieldUnit);
    program->setUniformValue("colourMap", kColourMapUnit);
    program->release();
    return program;
}

} // namespace isoslider::render
