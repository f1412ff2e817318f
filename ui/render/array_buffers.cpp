#include "ui/render/array_buffers.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "ui/render/draw_parts.h"
#include "ui/render/tint_arrays.h"

namespace isoslider::render {

ArrayBuffers::ArrayBuffers(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {
    gl_.glGenVertexArrays(1, &vertexArray_);
    for (SizedBuffer* buffer : {&positions_, &normals_, &indices_, &changed_, &tints_})
        buffer->name = driver_.makeBuffer(gl_);
    gl_.glBindVertexArray(vertexArray_);
    GLuint location = 0;
    for (const SizedBuffer* buffer : {&positions_, &normals_}) {
        gl_.glBindBuffer(GL_ARRAY_BUFFER, buffer->name);
        gl_.glEnableVertexAttribArray(location);
        gl_.glVertexAttribPointer(location++, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
    }
    gl_.glBindVertexArray(0);
}

ArrayBuffers::~ArrayBuffers() {
    if (vertexArray_ == 0)
        return;
    for (const SizedBuffer* buffer : {&positions_, &normals_, &indices_, &changed_, &tints_})
        driver_.freeBuffer(gl_, buffer->name);
    gl_.glDeleteVertexArrays(1, &vertexArray_);
}

bool ArrayBuffers::upload(const extract::SurfaceFrame& frame) {
    clear();
    untint();
    gl_.glBindVertexArray(vertexArray_);
    const bool isThere = uploadArrays(frame);
    gl_.glBindVertexArray(0);
    if (!isThere)
        freeMemory();
    if (!isThere)
        return false;
    vertices_ = frame.positions.size();
    surfaceIndices_ = frame.indices.size();
    changedIndices_ = frame.changedIndices.size();
    return true;
}

bool ArrayBuffers::tint(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints) {
    std::vector<model::PieceTint> colours;
    colours.reserve(vertices_);
    for (std::size_t slot = 0; slot < pieces.slotCount(); ++slot)
        if (pieces.parts(slot) != nullptr)
            addTints(pieces, slot, tints, colours);
    untint();
    if (colours.size() != vertices_)
        return false;
    gl_.glBindVertexArray(vertexArray_);
    const bool isThere = fill(GL_ARRAY_BUFFER, tints_, colours.data(), colours.size() * sizeof(model::PieceTint));
    if (isThere) {
        gl_.glEnableVertexAttribArray(kTintLocation);
        gl_.glVertexAttribPointer(kTintLocation, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(model::PieceTint), nullptr);
    } else {
        tints_.capacityBytes = 0;
    }
    gl_.glBindVertexArray(0);
    return isThere;
}

void ArrayBuffers::untint() {
    gl_.glBindVertexArray(vertexArray_);
    gl_.glDisableVertexAttribArray(kTintLocation);
    gl_.glBindVertexArray(0);
}

bool ArrayBuffers::uploadArrays(const extract::SurfaceFrame& frame) {
    const auto bytesOf = [](const auto& values) { return values.size() * sizeof(values[0]); };
    return fill(GL_ARRAY_BUFFER, positions_, frame.positions.data(), bytesOf(frame.positions)) &&
           fill(GL_ARRAY_BUFFER, normals_, frame.normals.data(), bytesOf(frame.normals)) &&
           fill(GL_ELEMENT_ARRAY_BUFFER, indices_, frame.indices.data(), bytesOf(frame.indices)) &&
           fill(GL_ELEMENT_ARRAY_BUFFER, changed_, frame.changedIndices.data(), bytesOf(frame.changedIndices));
}

void ArrayBuffers::clear() { vertices_ = surfaceIndices_ = changedIndices_ = 0; }

void ArrayBuffers::freeMemory() {
    clear();
    for (SizedBuffer* buffer : {&positions_, &normals_, &indices_, &changed_, &tints_})
        if (std::exchange(buffer->capacityBytes, 0) > 0)
            driver_.allocate(gl_, GL_COPY_WRITE_BUFFER, buffer->name, 0);
}

bool ArrayBuffers::fill(GLenum target, SizedBuffer& buffer, const void* data, std::size_t bytes) {
    if (!refill(gl_, driver_, target, buffer, data, bytes))
        return false;
    uploadedBytes_ += bytes;
    return true;
}

bool ArrayBuffers::drawSurface(const std::function<bool()>& isStopped) {
    const std::size_t together = isStopped ? kIndicesTogether : surfaceIndices_;
    for (std::size_t first = 0; first < surfaceIndices_; first += together) {
        draw(indices_, first, std::min(together, surfaceIndices_ - first));
        if (isStopped && isStopped())
            return false;
    }
    return true;
}

void ArrayBuffers::drawChanged() { draw(changed_, 0, changedIndices_); }

void ArrayBuffers::draw(const SizedBuffer& indices, std::size_t first, std::size_t count) {
    gl_.glBindVertexArray(vertexArray_);
    gl_.glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.name);
    drawTriangles(gl_, first, count);
    gl_.glBindVertexArray(0);
}

} // namespace isoslider::render
