#pragma once

#include <cstddef>

#include "ui/render/gl_program.h"

class QOpenGLContext;

namespace isoslider::render {

/// What came before is not the next call's. Ends although a lost context may report errors for ever.
void forgetErrors(Gl& gl);

/// The calls in which a graphics card that is short of memory, or was reset, reports it. A test puts a separate driver
/// in place. REQUIRES for every call: the context is current, or cannot be made so any more.
class GlDriver {
public:
    virtual ~GlDriver() = default;

    virtual GLuint makeBuffer(Gl& gl);
    virtual void freeBuffer(Gl& gl, GLuint buffer);
    /// Gives `buffer`, which stays bound to `target`, fresh storage that holds nothing yet. False if the card has no
    /// memory for it: the buffer is not to be drawn from then.
    virtual bool allocate(Gl& gl, GLenum target, GLuint buffer, std::size_t bytes);
    /// Whether all that the context held is gone, as after a reset of the card. Only a new context helps.
    virtual bool isLost(QOpenGLContext& context);
};

} // namespace isoslider::render
