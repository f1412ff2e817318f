#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "core/extract/live/brick_picture.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/render/bricks_in_view.h"
#include "ui/render/sized_buffer.h"

namespace isoslider::render {

/// The bricks of a surface on the GPU: the arenas of BrickPicture, place by place, and a table that reports the brick
/// of each 32 vertices. Of a picture that follows one of the same series only what is new of each brick is uploaded.
/// Points are in pages, one buffer each, because a shader can look up only so much in one; what grows is the last.
/// REQUIRES for every call but abandon() and the destructor after it: the context it was made in is current.
class BrickBuffers {
public:
    using Picture = extract::BrickPicture<float>;

    BrickBuffers(Gl& gl, GlDriver& driver);
    ~BrickBuffers();
    BrickBuffers(const BrickBuffers&) = delete;
    BrickBuffers& operator=(const BrickBuffers&) = delete;

    /// Whether the card can look up that many places at all.
    bool canHold(const Picture& picture) const;
    /// False if the card has no memory for it: then nothing is drawn, and no memory is kept. REQUIRES:
    /// canHold(picture).
    bool upload(const Picture& picture);
    /// Colours and hides vertices, `tints` by place among the pieces; sends the tints of bricks where any is another
    /// than before. REQUIRES: the pieces are those of the picture uploaded last. False if the card has no memory for
    /// it: then the surface is as without.
    bool tint(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints);
    void untint();
    void clear();
    /// Clears, and gives the memory on the card back.
    void freeMemory();
    /// Forgets everything on the GPU without a call to it: the context is gone.
    void abandon() { vertexArray_ = 0; }

    bool isEmpty() const { return bricks_.empty(); }
    /// Bytes of vertices, indices, points and places sent since the object was made.
    std::uint64_t uploadedBytes() const { return uploadedBytes_; }

    /// Sets what the vertex shader of bricks must know of them; texture units 0 and kBrickUnit to kBrickUnit + 2 are
    /// its.
    void setUniforms(QOpenGLShaderProgram& program) const;
    /// Draws the bricks that `modelToClip` brings into view, but for those wholly outside of one of `cuts`, with a
    /// program that has these uniforms: what is drawn of the others is left to the shader. `isStopped` is asked between
    /// parts: false if it answered true.
    bool drawSurface(const glm::dmat4& modelToClip, std::span<const glm::dvec4> cuts,
                     const std::function<bool()>& isStopped);
    void drawChanged();

private:
    static constexpr std::uint32_t kVerticesPerPlace = 32;
    static constexpr std::uint32_t kLinesPerPage = std::uint32_t{1} << extract::BrickArenas::kPointChunkBits;
    /// Of a brick: x and y of its place, 16 bits each; z; its first line of points, in its page; its first vertex
    /// inside cells.
    using Place = std::array<std::uint32_t, 4>;
    struct Page { ///< of points
        SizedBuffer lines;
        GLuint scalars = 0, normals = 0; ///< textures of it
        bool isFresh = false; ///< holds nothing of what it should
        std::vector<std::uint32_t> versions; ///< by run of points: of those that are there; 0 for none
    };
    /// Elements of an arena that lie one after the other.
    struct Stretch {
        std::uint64_t first;
        std::uint64_t count;
        const void* data;
    };

    bool isMostlyNew(std::span<const extract::PictureBrick> now) const;
    bool makeRoom(const Picture& picture);
    bool makeRoomForPoints(const Picture& picture);
    /// From page `first` on.
    void freePages(std::size_t first);
    static std::size_t pageOf(const extract::PictureBrick& brick) { return brick.firstPointLine / kLinesPerPage; }
    void sendPoints(const Picture& picture);
    bool makeRoom(GLenum target, SizedBuffer& buffer, std::size_t bytes);
    void send(GLenum target, const SizedBuffer& buffer, std::size_t elementBytes, bool isFresh,
              std::vector<Stretch>& stretches);
    void sendBytes(GLenum target, std::uint64_t at, std::size_t bytes, const void* data);
    void sendPlaces(std::vector<std::uint64_t>& pages);
    bool sendChanged(const Picture& picture);
    void listInView(const glm::dmat4& modelToClip, std::span<const glm::dvec4> cuts);
    void clearCalls();
    void addCall(const extract::PictureBrick& brick, std::size_t firstIndex, std::size_t count);
    void drawRange(GLuint indices, std::size_t begin, std::size_t end);
    void bind(int unit, GLuint texture);
    void bindAll(GLuint indices);
    void bindPage(std::size_t page);
    void unbindAll();

    Gl& gl_;
    GlDriver& driver_;
    std::uint64_t mostPlaces_ = 0;
    GLuint vertexArray_ = 0;
    GLuint placesTexture_ = 0;
    GLuint innerTexture_ = 0;
    SizedBuffer codes_, indices_, inner_, places_, changedIndices_, tints_;
    std::vector<Page> pages_;
    ScalarType type_ = ScalarType::F32; ///< of the samples in the pages
    std::uint64_t series_ = 0; ///< of the picture that is there; 0 for none
    std::vector<extract::PictureBrick> bricks_; ///< as they are on the GPU
    /// By slot, of what the tints on the GPU were made from: its version, and its parts' tints.
    struct SentTints {
        std::uint32_t version = 0, firstVertex = 0;
        std::uint64_t hash = 0;
        friend bool operator==(const SentTints&, const SentTints&) = default;
    };
    std::vector<SentTints> sentTints_;
    std::vector<Place> placeTable_;
    std::vector<extract::ChangedTriangles> changed_;
    std::uint64_t uploadedBytes_ = 0;
    bool isFresh_ = false; ///< the buffers hold nothing that must be kept
    std::vector<BrickInView> inView_;
    // Arguments of the draw calls, and the page of each.
    std::vector<std::size_t> callPages_;
    std::vector<GLsizei> counts_;
    std::vector<const void*> offsets_;
    std::vector<GLint> baseVertices_;
};

} // namespace isoslider::render
