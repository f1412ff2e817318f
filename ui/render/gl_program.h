#pragma once

#include <memory>

#include <QOpenGLFunctions_3_3_Core>
#include <QOpenGLShaderProgram>

namespace isoslider::render {

using Gl = QOpenGLFunctions_3_3_Core;

/// Where programs that colour by values find a field and a map, see shaders/scalar_colour.glsl; the units before are
/// those of records and of layers.
inline constexpr int kScalarFieldUnit = 3, kColourMapUnit = 4;
/// The first of three in which vertices of bricks look up scalars, normals and what lies inside cells.
inline constexpr int kBrickUnit = 5;

/// Compiles and links `<vertex>.vert`, `<fragment>.frag` and, if there is one, `<geometry>.geom` of the built-in
/// shaders; `define`, if any, is defined in the first two. REQUIRES: a current context. Null, with a warning in the
/// log, if the driver refuses.
std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* vertex, const char* fragment,
                                                  const char* define = nullptr, const char* geometry = nullptr);
inline std::unique_ptr<QOpenGLShaderProgram> loadProgram(const char* name) { return loadProgram(name, name); }

/// Makes the built-in shaders, icons and settings findable. Call before anything else here.
void initializeResources();

} // namespace isoslider::render
