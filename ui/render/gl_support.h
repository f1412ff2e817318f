#pragma once

#include <QString>

class QSurfaceFormat;

namespace isoslider::render {

/// OpenGL 3.3 core with depth and 4 samples per pixel, that reports of resets: what the viewport asks for.
QSurfaceFormat viewportFormat();

/// Tries an OpenGL 3.3 core context on a separate surface. Call after the application object is
/// made and before any OpenGL widget, which cannot fail gracefully. The answer is kept.
bool isOpenGlUsable();
/// Whether the processor draws in place of a card: then a window is better not composed by OpenGL. Asks as
/// isOpenGlUsable().
bool isOpenGlSoftware();
/// Why it is not usable, in a sentence without its full stop; empty if it is.
QString openGlProblem();

} // namespace isoslider::render
