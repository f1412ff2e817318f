#pragma once

#include <limits>
#include <map>

#include <QOpenGLContext>
#include <QPointer>

#include "ui/render/gl_driver.h"

namespace isoslider::test {

/// A graphics card with as much memory as a test gives it, that is reset when a test asks for it. Counts what is on it.
class FaultyDriver final : public render::GlDriver {
public:
    std::size_t memoryBytes = std::numeric_limits<std::size_t>::max();
    int refusedCall =
        0; ///< counting from 1, the allocation that fails, and the next, which may be another try; 0 for none
    int lostContexts = 0; ///< so many contexts more will be found lost

    int allocations() const { return allocations_; }
    int refusals() const { return refusals_; }
    std::size_t buffers() const { return sizes_.size(); }
    std::size_t usedBytes() const {
        std::size_t sum = 0;
        for (const auto& [buffer, size] : sizes_)
            sum += size;
        return sum;
    }

    GLuint makeBuffer(render::Gl& gl) override {
        const GLuint buffer = GlDriver::makeBuffer(gl);
        sizes_[buffer] = 0;
        return buffer;
    }
    void freeBuffer(render::Gl& gl, GLuint buffer) override {
        sizes_.erase(buffer);
        GlDriver::freeBuffer(gl, buffer);
    }
    bool allocate(render::Gl& gl, GLenum target, GLuint buffer, std::size_t bytes) override {
        sizes_[buffer] = 0;
        ++allocations_;
        const bool isRefused = refusedCall > 0 && (allocations_ == refusedCall || allocations_ == refusedCall + 1);
        if (isRefused || usedBytes() + bytes > memoryBytes) {
            ++refusals_;
            GlDriver::allocate(gl, target, buffer, 0); // what is in it is lost, as on a real card
            return false;
        }
        sizes_[buffer] = bytes;
        return GlDriver::allocate(gl, target, buffer, bytes);
    }
    bool isLost(QOpenGLContext& context) override {
        if (&context == lostContext_)
            return true;
        if (lostContexts == 0)
            return GlDriver::isLost(context);
        --lostContexts;
        lostContext_ = &context;
        return true;
    }

private:
    std::map<GLuint, std::size_t> sizes_;
    QPointer<QOpenGLContext> lostContext_; // the next context may have its address
    int allocations_ = 0;
    int refusals_ = 0;
};

} // namespace isoslider::test
