#pragma once

class QSurfaceFormat;

namespace isoslider::render {

/// OpenGL 3.3 core with depth and 4 samples per pixel: what the viewport asks for.
QSurfaceFormat viewportFormat();

/// Tries an OpenGL 3.3 core context on a surface of its own. Call after the application object is
/// made and before any OpenGL widget, which cannot fail gracefully. The answer is kept.
bool isOpenGlUsable();

} // namespace isoslider::render
