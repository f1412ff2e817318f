#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ui/render/gl_program.h"

namespace isoslider::render {

/// A surface whose drawing can be stopped is drawn in parts of so many indices: software OpenGL takes some 10 ms for
/// one.
constexpr std::size_t kIndicesTogether = 300'000;

/// Draws triangles of the bound arrays: `count` of the bound 32-bit indices from the `first` on.
inline void drawTriangles(Gl& gl, std::size_t first, std::size_t count) {
    // glDrawElements counts in int; larger surfaces go in parts of whole triangles.
    constexpr std::size_t kMostPerCall = std::size_t{std::numeric_limits<GLsizei>::max()} / 3 * 3;
    for (std::size_t begin = first; begin < first + count; begin += kMostPerCall)
        gl.glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(std::min(kMostPerCall, first + count - begin)),
                          GL_UNSIGNED_INT, reinterpret_cast<const void*>(begin * sizeof(std::uint32_t)));
}

} // namespace isoslider::render
