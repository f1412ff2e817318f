#pragma once

#include <atomic>
#include <limits>
#include <map>
#include <mutex>

#include <QOpenGLContext>
#include <QPointer>

#include "ui/render/gl_driver.h"

namespace isoslider::test {

/// A graphics card with as much memory as a test gives it, that is reset when a test asks for it. Counts what is on it.
/// Pictures are drawn on another thread; contexts are asked for on the test's.
class FaultyDriver final : public render::GlDriver {
public:
    std::atomic<std::size_t> memoryBytes = std::numeric_limits<std::size_t>::max();
    /// Counting from 1, the allocation that fails, and the next, which may be another try; 0 for none.
    std::atomic<int> refusedCall = 0;
    std::atomic<int> lostContexts = 0; ///< so many contexts more will be found lost

    int allocations() const { return allocations_; }
    int refusals() const { return refusals_; }
    std::size_t buffers() const {
        const std::lock_guard lock(mutex_);
        return sizes_.size();
    }
    std::size_t usedBytes() const {
        const std::lock_guard lock(mutex_);
        return sumOfSizes();
    }

    GLuint makeBuffer(render::Gl& gl) override {
        const GLuint buffer = GlDriver::makeBuffer(gl);
        const std::lock_guard lock(mutex_);
        sizes_[buffer] = 0;
        return buffer;
    }
    void freeBuffer(render::Gl& gl, GLuint buffer) override {
        const std::lock_guard lock(mutex_);
        sizes_.erase(buffer);
        GlDriver::freeBuffer(gl, buffer);
    }
    bool allocate(render::Gl& gl, GLenum target, GLuint buffer, std::size_t bytes) override {
        const std::lock_guard lock(mutex_);
        sizes_[buffer] = 0;
        ++allocations_;
        const bool isRefused = refusedCall > 0 && (allocations_ == refusedCall || allocations_ == refusedCall + 1);
        if (isRefused || sumOfSizes() + bytes > memoryBytes) {
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
    std::size_t sumOfSizes() const {
        std::size_t sum = 0;
        for (const auto& [buffer, size] : sizes_)
            sum += size;
        return sum;
    }

    mutable std::mutex mutex_; // buffers are made on the thread that draws
    std::map<GLuint, std::size_t> sizes_;
    QPointer<QOpenGLContext> lostContext_; // the next context may have its address
    std::atomic<int> allocations_ = 0;
    std::atomic<int> refusals_ = 0;
};

} // namespace isoslider::test
