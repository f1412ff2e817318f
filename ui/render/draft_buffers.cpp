#include "ui/render/draft_buffers.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/worker_team.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/pieces/surface_pieces.h"
#include "ui/render/draw_parts.h"
#include "ui/render/tint_arrays.h"

namespace isoslider::render {
namespace {

using extract::PictureBrick;
using extract::VertexCode;

constexpr GLuint kLevelLocation = 3; // of surface.vert
constexpr std::size_t kBricksTogether = 64;
constexpr std::size_t kAhead = 3; // bricks whose points are asked for
constexpr model::PieceTint kUntinted{0, 0, 0, 255};

float levelAt(const extract::BrickPicture<float>& picture, const PictureBrick& brick, std::uint16_t vertex) {
    const VertexCode code = picture.codes(brick)[vertex];
    return static_cast<float>(extract::isInside(code) ? picture.inner(brick)[code >> 2].level : extract::levelOf(code));
}

} // namespace

DraftBuffers::DraftBuffers(Gl& gl, GlDriver& driver) : gl_(gl), driver_(driver) {
    gl_.glGenVertexArrays(1, &vertexArray_);
    verticesBuffer_.name = driver_.makeBuffer(gl_);
    indicesBuffer_.name = driver_.makeBuffer(gl_);
    gl_.glBindVertexArray(vertexArray_);
    gl_.glBindBuffer(GL_ARRAY_BUFFER, verticesBuffer_.name);
    const auto attribute = [&](GLuint location, GLint count, GLenum type, std::size_t offset) {
        gl_.glEnableVertexAttribArray(location);
        gl_.glVertexAttribPointer(location, count, type, type == GL_UNSIGNED_BYTE, sizeof(Vertex),
                                  reinterpret_cast<const void*>(offset));
    };
    attribute(0, 3, GL_FLOAT, offsetof(Vertex, place));
    attribute(1, 3, GL_FLOAT, offsetof(Vertex, normal));
    attribute(kTintLocation, 4, GL_UNSIGNED_BYTE, offsetof(Vertex, tint));
    attribute(kLevelLocation, 1, GL_FLOAT, offsetof(Vertex, level));
    gl_.glBindVertexArray(0);
}

DraftBuffers::~DraftBuffers() {
    if (vertexArray_ == 0)
        return;
    driver_.freeBuffer(gl_, indicesBuffer_.name);
    driver_.freeBuffer(gl_, verticesBuffer_.name);
    gl_.glDeleteVertexArrays(1, &vertexArray_);
}

bool DraftBuffers::update(const extract::SurfaceFrame& frame, int blockCells, const glm::dmat4& modelToClip,
                          std::span<const glm::dvec4> cuts, std::span<const model::PieceTint> tints) {
    const Picture& picture = *frame.bricks;
    const bool isTinted = !tints.empty() && frame.pieces != nullptr;
    Shown now{frame.isovalue,
              modelToClip,
              {cuts.begin(), cuts.end()},
              isTinted ? frame.pieces : nullptr,
              isTinted ? std::vector(tints.begin(), tints.end()) : std::vector<model::PieceTint>()};
    if (!coarsen(picture, blockCells) && shown_ == now)
        return true;
    shown_.reset();
    listBricksInView(picture.bricks(), modelToClip, cuts, inView_);
    std::sort(inView_.begin(), inView_.end()); // nearest first: what is hidden fails the depth test before it is shaded
    fill(picture, frame.isovalue);
    if (isTinted)
        fillTints(*frame.pieces, tints);
    indexCount_ = 0;
    gl_.glBindVertexArray(vertexArray_);
    const bool isThere =
        send(GL_ARRAY_BUFFER, verticesBuffer_, vertices_.data(), vertices_.size() * sizeof(Vertex)) &&
        send(GL_ELEMENT_ARRAY_BUFFER, indicesBuffer_, indices_.data(), indices_.size() * sizeof(std::uint32_t));
    gl_.glBindVertexArray(0);
    if (!isThere)
        return false;
    indexCount_ = indices_.size();
    shown_ = std::move(now);
    return true;
}

// Whether any brick is another now.
bool DraftBuffers::coarsen(const Picture& picture, int blockCells) {
    const bool isOtherKind = std::exchange(blockCells_, blockCells) != blockCells;
    if (std::exchange(series_, picture.series()) != picture.series() || isOtherKind)
        bricks_.clear();
    const auto now = picture.bricks();
    bool isOther = bricks_.size() != now.size();
    bricks_.resize(now.size());
    std::vector<std::size_t> others;
    for (std::size_t slot = 0; slot < now.size(); ++slot)
        if (bricks_[slot].of != now[slot])
            others.push_back(slot);
    forRanges(others.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
        CoarseSurface coarse;
        for (std::size_t i = begin; i < end; ++i) {
            const PictureBrick& brick = now[others[i]];
            Brick& made = bricks_[others[i]];
            made.of = brick;
            made.vertexCount = 0;
            made.numbers.clear();
            if (brick.indexCount == 0)
                continue;
            coarsenBrick({{picture.codes(brick), brick.vertexCount},
                          picture.inner(brick),
                          {picture.indices(brick), brick.indexCount}},
                         blockCells, coarse);
            made.vertexCount = static_cast<std::uint16_t>(coarse.vertices.size());
            made.numbers.reserve(coarse.vertices.size() + coarse.indices.size());
            made.numbers.assign(coarse.vertices.begin(), coarse.vertices.end());
            made.numbers.insert(made.numbers.end(), coarse.indices.begin(), coarse.indices.end());
        }
    });
    return isOther || !others.empty();
}

void DraftBuffers::fill(const Picture& picture, double isovalue) {
    firstVertex_.assign(1, 0);
    firstIndex_.assign(1, 0);
    for (const BrickInView& seen : inView_) {
        firstVertex_.push_back(firstVertex_.back() + bricks_[seen.slot].vertices().size());
        firstIndex_.push_back(firstIndex_.back() + bricks_[seen.slot].indices().size());
    }
    vertices_.resize(firstVertex_.back());
    indices_.resize(firstIndex_.back());
    forRanges(inView_.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
        std::vector<glm::vec3> places, normals;
        for (std::size_t i = begin; i < end; ++i) {
            const Brick& brick = bricks_[inView_[i].slot];
            const auto which = brick.vertices();
            if (i + kAhead < end) {
                const Brick& ahead = bricks_[inView_[i + kAhead].slot];
                prefetchSome(picture, ahead.of, ahead.vertices());
            }
            places.resize(which.size());
            normals.resize(which.size());
            expandSome(picture, brick.of, which, isovalue, places.data(), normals.data());
            for (std::size_t k = 0; k < which.size(); ++k)
                vertices_[firstVertex_[i] + k] = {places[k], normals[k], kUntinted,
                                                  levelAt(picture, brick.of, which[k])};
            std::transform(brick.indices().begin(), brick.indices().end(), &indices_[firstIndex_[i]],
                           [&](std::uint16_t index) { return static_cast<std::uint32_t>(firstVertex_[i] + index); });
        }
    });
}

void DraftBuffers::fillTints(const extract::SurfacePieces& pieces, std::span<const model::PieceTint> tints) {
    forRanges(inView_.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
        std::vector<model::PieceTint> ofBrick;
        for (std::size_t i = begin; i < end; ++i) {
            const auto which = bricks_[inView_[i].slot].vertices();
            ofBrick.clear();
            addTints(pieces, inView_[i].slot, tints, ofBrick);
            for (std::size_t k = 0; k < which.size(); ++k)
                vertices_[firstVertex_[i] + k].tint = ofBrick[which[k]];
        }
    });
}

bool DraftBuffers::send(GLenum target, SizedBuffer& buffer, const void* data, std::size_t bytes) {
    if (!refill(gl_, driver_, target, buffer, data, bytes))
        return false;
    uploadedBytes_ += bytes;
    return true;
}

void DraftBuffers::clear() {
    bricks_ = {};
    vertices_ = {};
    indices_ = {};
    shown_.reset();
    series_ = 0;
    indexCount_ = 0;
}

void DraftBuffers::draw() {
    gl_.glBindVertexArray(vertexArray_);
    drawTriangles(gl_, 0, indexCount_);
    gl_.glBindVertexArray(0);
}

} // namespace isoslider::render
