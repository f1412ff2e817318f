#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "core/extract/surface_frame.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/render/sized_buffer.h"

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
    /// Colours and hides vertices, `tints` by place among the pieces, until the next upload(). REQUIRES: the pieces are
    /// of the frame uploaded, or of the bricks it came from. False if they are of another, or the card has no memory
    /// for it: then the surface has no tints.
    bool tint(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints);
    void untint();
    void clear();
    /// Clears, and gives the memory on the card back.
    void freeMemory();
    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon() { vertexArray_ = 0; }

    bool isEmpty() const { return surfaceIndices_ == 0; }
    std::size_t surfaceIndices() const { return surfaceIndices_; }
    std::size_t changedIndices() const { return changedIndices_; }
    std::uint64_t uploadedBytes() const { return uploadedBytes_; }
    /// `isStopped` is asked between parts: false if it answered true.
    bool drawSurface(const std::function<bool()>& isStopped);
    void drawChanged();

private:
    bool uploadArrays(const extract::SurfaceFrame& frame);
    bool fill(GLenum target, SizedBuffer& buffer, const void* data, std::size_t bytes);
    void draw(const SizedBuffer& indices, std::size_t first, std::size_t count);

    Gl& gl_;
    GlDriver& driver_;
    GLuint vertexArray_ = 0;
    SizedBuffer positions_;
    SizedBuffer normals_;
    SizedBuffer indices_;
    SizedBuffer changed_;
    SizedBuffer tints_;
    std::size_t vertices_ = 0;
    std::size_t surfaceIndices_ = 0;
    std::size_t changedIndices_ = 0;
    std::uint64_t uploadedBytes_ = 0;
};

} // namespace isoslider::render
