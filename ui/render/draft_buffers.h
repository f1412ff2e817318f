#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "core/extract/surface_frame.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/render/brick_draft.h"
#include "ui/render/bricks_in_view.h"
#include "ui/render/sized_buffer.h"

namespace isoslider::render {

/// A coarser surface of a picture's bricks on the GPU, see coarsenBrick(). It is made of the picture itself, a
/// twentieth to a third of its triangles: while a surface moves, nothing else of it is sent.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class DraftBuffers {
public:
    using Picture = extract::BrickPicture<float>;

    DraftBuffers(Gl& gl, GlDriver& driver);
    ~DraftBuffers();
    DraftBuffers(const DraftBuffers&) = delete;
    DraftBuffers& operator=(const DraftBuffers&) = delete;

    /// Sends what of the frame's surface is in view and on the right side of all `cuts`, if that is not there already.
    /// `tints`: of the frame's pieces, by place among them; none where empty. False if the card has no memory for it:
    /// then nothing is drawn. REQUIRES: the frame has bricks; blocks of 2, 4 or 8 cells.
    bool update(const extract::SurfaceFrame& frame, int blockCells, const glm::dmat4& modelToClip,
                std::span<const glm::dvec4> cuts, std::span<const model::PieceTint> tints);
    /// With the program of arrays.
    void draw();
    /// Forgets the surface; its room on the card stays.
    void clear();
    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon() { vertexArray_ = 0; }
    std::uint64_t uploadedBytes() const { return uploadedBytes_; }

private:
    struct Vertex {
        glm::vec3 place; ///< grid index units
        glm::vec3 normal;
        model::PieceTint tint;
        float level; ///< of the leaf edge it lies on
    };
    /// In the version of the brick that it was made from.
    struct Brick {
        extract::PictureBrick of;
        std::uint16_t vertexCount = 0;
        std::vector<std::uint16_t> numbers; ///< of CoarseSurface: vertices, then indices

        std::span<const std::uint16_t> vertices() const { return std::span(numbers).first(vertexCount); }
        std::span<const std::uint16_t> indices() const { return std::span(numbers).subspan(vertexCount); }
    };
    /// What the arrays on the card are of, besides the bricks.
    struct Shown {
        double isovalue;
        glm::dmat4 modelToClip;
        std::vector<glm::dvec4> cuts;
        std::shared_ptr<const extract::SurfacePieces> pieces; ///< null: no tints
        std::vector<model::PieceTint> tints;
        friend bool operator==(const Shown&, const Shown&) = default;
    };

    bool coarsen(const Picture& picture, int blockCells);
    void fill(const Picture& picture, double isovalue);
    void fillTints(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints);
    bool send(GLenum target, SizedBuffer& buffer, const void* data, std::size_t bytes);

    Gl& gl_;
    GlDriver& driver_;
    GLuint vertexArray_ = 0;
    SizedBuffer verticesBuffer_, indicesBuffer_;
    std::uint64_t uploadedBytes_ = 0;
    std::uint64_t series_ = 0; ///< of the picture that the bricks are of; 0 for none
    int blockCells_ = 0;
    std::vector<Brick> bricks_; ///< by slot
    std::optional<Shown> shown_;
    std::size_t indexCount_ = 0;
    // Of the bricks in view, nearest first, where theirs begin.
    std::vector<BrickInView> inView_;
    std::vector<std::size_t> firstVertex_, firstIndex_;
    std::vector<Vertex> vertices_;
    std::vector<std::uint32_t> indices_;
};

} // namespace isoslider::render
