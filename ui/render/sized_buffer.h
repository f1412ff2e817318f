#pragma once

#include <cstddef>

#include "ui/render/gl_driver.h"

namespace isoslider::render {

/// A buffer on the card and its room.
struct SizedBuffer {
    GLuint name = 0;
    std::size_t capacityBytes = 0;
};

/// Replaces all that is in the buffer, which stays bound to `target`; the room grows where it must, and never shrinks.
/// False if the card has no memory for it: the buffer is not to be drawn from then.
inline bool refill(Gl& gl, GlDriver& driver, GLenum target, SizedBuffer& buffer, const void* data, std::size_t bytes) {
    if (bytes > buffer.capacityBytes) // room to grow, so that a slide seldom allocates
        buffer.capacityBytes = bytes + bytes / 4;
    // A fresh store each time: the driver need not wait for the draw that reads the old one.
    if (!driver.allocate(gl, target, buffer.name, buffer.capacityBytes)) {
        if (buffer.capacityBytes == bytes)
            return false;
        buffer.capacityBytes = bytes; // there may be room for it, if not to grow
        if (!driver.allocate(gl, target, buffer.name, bytes))
            return false;
    }
    if (bytes > 0)
        gl.glBufferSubData(target, 0, static_cast<GLsizeiptr>(bytes), data);
    return true;
}

} // namespace isoslider::render
