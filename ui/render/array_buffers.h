#pragma once

#include <cstddef>

#include "core/extract/surface_frame.h"
#include "ui/render/gl_driver.h"

namespace isoslider::render {

/// The arrays of one surface on the GPU. Buffers grow and are filled again, never shrunk while in use.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class ArrayBuffers {
public:
    ArrayBuffers(Gl& gl, GlDriver& driver);
    ~ArrayBuffers();
    ArrayBuffers(const ArrayBuffers&) = delete;
    ArrayBuffers& operator=(const ArrayBuffers&) = delete;

    /// False if the card has no memory for it: then nothing is drawn, and no memory is kept.
    bool upload(const extract::SurfaceFrame& frame);
    void clear();
    /// Clears, and gives the memory on the card back.
    void freeMemory();
    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon() { vertexArray_ = 0; }

    bool isEmpty() const { return surfaceIndices_ == 0; }
    std::size_t surfaceIndices() const { return surfaceIndices_; }
    std::size_t changedIndices() const { return changedIndices_; }
    std::uint64_t uploadedBytes() const { return uploadedBytes_; }
    void drawSurface();
    void drawChanged();

private:
    struct Buffer {
        GLuint name = 0;
        std::size_t capacityBytes = 0;
    };
    bool uploadArrays(const extract::SurfaceFrame& frame);
    bool fill(GLenum target, Buffer& buffer, const void* data, std::size_t bytes);
    void draw(const Buffer& indices, std::size_t count);

    Gl& gl_;
    GlDriver& driver_;
    GLuint vertexArray_ = 0;
    Buffer positions_;
    Buffer normals_;
    Buffer indices_;
    Buffer changed_;
    std::size_t surfaceIndices_ = 0;
    std::size_t changedIndices_ = 0;
    std::uint64_t uploadedBytes_ = 0;
};

} // namespace isoslider::render
