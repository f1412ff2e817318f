#pragma once

#include <memory>

#include <QOpenGLFunctions_3_3_Core>
#include <QOpenGLShaderProgram>

namespace isoslider::render {

using Gl = QOpenGLFunctions_3_3_Core;

/// Compiles and links `<vertex>.vert` and `<fragment>.frag` of the built-in shaders.
/// REQUIRES: a current context. Null, with a warning in the log, if the driver refuses.
std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* vertex, const char* fragment);
inline std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* name) { return loadProgram(name, name); }

/// Makes the built-in shaders, icons and settings findable. Call before anything else here.
void initializeResources();

} // namespace isoslider::render
