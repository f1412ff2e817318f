#include "core/extract/live/brick_picture.h"

#include <cstring>
#include <utility>

#include "core/base/worker_team.h"
#include "core/extract/live/vertex_kernels.h"

namespace isoslider::extract {
namespace {

// Records inside cells are few, and stand behind those on edges.
template <class Live>
void expandRecords(const EdgeRecord<Live>* records, std::uint32_t count, const std::array<std::int32_t, 3>& origin,
                   Live isovalue, glm::vec3* positions, glm::vec3* normals) {
    std::uint32_t onEdges = count;
    while (onEdges > 0 && records[onEdges - 1].isInside())
        --onEdges;
    interpolateVertices(records, onEdges, origin, isovalue, positions, normals);
    for (std::uint32_t k = onEdges; k < count; ++k) {
        const MeshVertex vertex = vertexOf(records[k], origin, isovalue);
        positions[k] = vertex.position;
        normals[k] = vertex.normal;
    }
}

// Where each brick's vertices begin, and at the end how many there are.
template <class Live>
std::vector<std::uint64_t> firstVertices(const BrickPicture<Live>& picture) {
    std::vector<std::uint64_t> first{0};
    first.reserve(picture.bricks().size() + 1);
    for (const PictureBrick& brick : picture.bricks())
        first.push_back(first.back() + (brick.indexCount > 0 ? brick.recordCount : 0));
    return first;
}

template <class Live>
void expandFrom(const BrickPicture<Live>& picture, std::span<const std::uint64_t> first, double isovalue,
                std::vector<glm::vec3>& positions, std::vector<glm::vec3>& normals) {
    positions.resize(first.back());
    normals.resize(first.back());
    forEachIndex(picture.bricks().size(), kBricksTogether, [&](std::size_t slot) {
        if (const PictureBrick& brick = picture.bricks()[slot]; brick.indexCount > 0)
            expandRecords(picture.records(brick), brick.recordCount, brick.origin(), static_cast<Live>(isovalue),
                          &positions[first[slot]], &normals[first[slot]]);
    });
}

} // namespace

template <class Live>
std::shared_ptr<const BrickPicture<Live>> separateCopy(const BrickPicture<Live>& picture) {
    auto arenas = std::make_shared<BrickArenas<Live>>();
    std::vector<PictureBrick> bricks;
    for (PictureBrick brick : picture.bricks()) {
        if (brick.indexCount == 0) { // its slot stays: pieces are listed by slot
            bricks.push_back({.place = brick.place, .version = brick.version});
            continue;
        }
        ArenaRun vertices, indices;
        arenas->vertices.resize(vertices, brick.recordCount);
        arenas->indices.resize(indices, brick.indexCount);
        std::memcpy(arenas->vertices.at(vertices.begin), picture.records(brick),
                    brick.recordCount * sizeof(EdgeRecord<Live>));
        std::memcpy(arenas->indices.at(indices.begin), picture.indices(brick),
                    brick.indexCount * sizeof(std::uint16_t));
        brick.firstRecord = vertices.begin;
        brick.firstIndex = indices.begin;
        bricks.push_back(brick);
    }
    auto copy = std::make_shared<BrickPicture<Live>>(arenas, std::make_shared<PictureLeases>(), 0, std::move(bricks));
    copy->recordEnd_ = arenas->vertices.top();
    copy->indexEnd_ = arenas->indices.top();
    return copy;
}

template <class Live>
void expandVertices(const BrickPicture<Live>& picture, double isovalue, std::vector<glm::vec3>& positions,
                    std::vector<glm::vec3>& normals) {
    expandFrom(picture, firstVertices(picture), isovalue, positions, normals);
}

template <class Live>
void expandPicture(const BrickPicture<Live>& picture, SurfaceFrame& frame) {
    const auto bricks = picture.bricks();
    const std::vector<std::uint64_t> firstVertex = firstVertices(picture);
    std::vector<std::uint64_t> firstIndex(bricks.size() + 1, 0);
    for (std::size_t slot = 0; slot < bricks.size(); ++slot)
        firstIndex[slot + 1] = firstIndex[slot] + bricks[slot].indexCount;
    expandFrom(picture, firstVertex, frame.isovalue, frame.positions, frame.normals);
    frame.indices.resize(firstIndex.back());
    forEachIndex(bricks.size(), kBricksTogether, [&](std::size_t slot) {
        const PictureBrick& brick = bricks[slot];
        if (brick.indexCount == 0)
            return;
        const std::uint16_t* const local = picture.indices(brick);
        for (std::uint32_t k = 0; k < brick.indexCount; ++k)
            frame.indices[firstIndex[slot] + k] = static_cast<std::uint32_t>(firstVertex[slot] + local[k]);
    });
    frame.changedIndices.clear();
    frame.changedIndices.reserve(picture.changedIndices().size());
    const std::uint16_t* local = picture.changedIndices().data();
    for (const ChangedTriangles& changed : picture.changedTriangles())
        for (std::uint32_t k = 0; k < changed.indexCount; ++k)
            frame.changedIndices.push_back(static_cast<std::uint32_t>(firstVertex[changed.slot] + *local++));
}

void expandPicture(SurfaceFrame& frame) {
    if (const auto picture = std::exchange(frame.bricks, nullptr))
        expandPicture(*picture, frame);
}

std::uint64_t pictureBytes(const SurfaceFrame& frame) {
    if (frame.bricks)
        return frame.bricks->recordEnd() * sizeof(EdgeRecord<float>) +
               (frame.bricks->indexEnd() + frame.bricks->changedIndices().size()) * sizeof(std::uint16_t);
    return (frame.positions.size() + frame.normals.size()) * sizeof(glm::vec3) +
           (frame.indices.size() + frame.changedIndices.size()) * sizeof(std::uint32_t);
}

template std::shared_ptr<const BrickPicture<float>> separateCopy(const BrickPicture<float>&);
template void expandVertices(const BrickPicture<float>&, double, std::vector<glm::vec3>&, std::vector<glm::vec3>&);
template void expandVertices(const BrickPicture<double>&, double, std::vector<glm::vec3>&, std::vector<glm::vec3>&);
template void expandPicture(const BrickPicture<float>&, SurfaceFrame&);
template void expandPicture(const BrickPicture<double>&, SurfaceFrame&);

} // namespace isoslider::extract
