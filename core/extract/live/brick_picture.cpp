#include "core/extract/live/brick_picture.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "core/base/worker_team.h"
#include "core/extract/live/vertex_kernels.h"

namespace isoslider::extract {
namespace {

/// Of the brick's k-th vertex inside cells.
template <class Live>
void expandInner(const BrickPicture<Live>& picture, const PictureBrick& brick, std::uint32_t k, Live isovalue,
                 glm::vec3& position, glm::vec3& normal) {
    const MeshVertex vertex = vertexOf(EdgeRecord<Live>::inside(picture.inner(brick)[k]), brick.origin(), isovalue);
    position = vertex.position;
    normal = vertex.normal;
}

template <class Live>
void expandBrick(const BrickPicture<Live>& picture, const PictureBrick& brick, Live isovalue, const VertexRoom& room) {
    const auto origin = brick.origin();
    const std::uint32_t onEdges = brick.vertexCount - std::uint32_t{brick.innerCount};
    if (const VertexGroup<Live>* const groups = picture.groups(brick))
        placeVertices(groups, onEdges, origin, isovalue, room);
    else
        placeVertices(picture.type(), picture.points(brick), picture.codes(brick), onEdges, origin, isovalue, room);
    for (std::uint32_t k = 0; k < brick.innerCount; ++k)
        expandInner(picture, brick, k, isovalue, room.positions[onEdges + k], room.normals[onEdges + k]);
}

// Where each brick's vertices begin, and at the end how many there are.
template <class Live>
std::vector<std::uint64_t> firstVertices(const BrickPicture<Live>& picture) {
    std::vector<std::uint64_t> first{0};
    first.reserve(picture.bricks().size() + 1);
    for (const PictureBrick& brick : picture.bricks())
        first.push_back(first.back() + (brick.indexCount > 0 ? brick.vertexCount : 0));
    return first;
}

template <class Live>
void expandFrom(const BrickPicture<Live>& picture, std::span<const std::uint64_t> first, double isovalue,
                std::vector<glm::vec3>& positions, std::vector<glm::vec3>& normals) {
    positions.resize(first.back());
    normals.resize(first.back());
    constexpr std::size_t kAhead = 2; // bricks whose lines are asked for
    const auto bricks = picture.bricks();
    const std::size_t pointBytes = pointLineCount(scalarTypeSizeBytes(picture.type())) * sizeof(PointLine);
    const auto fetchLines = [](const auto* from, std::size_t bytes) {
        for (std::size_t line = 0; line < bytes; line += 64)
            __builtin_prefetch(reinterpret_cast<const char*>(from) + line, 0, 2);
    };
    const auto fetch = [&](const PictureBrick& brick) {
        if (brick.indexCount == 0)
            return;
        if (const auto* const groups = picture.groups(brick)) {
            fetchLines(groups, groupCount(brick.vertexCount) * sizeof(*groups));
            return;
        }
        fetchLines(picture.points(brick), pointBytes);
        fetchLines(picture.codes(brick), brick.vertexCount * sizeof(VertexCode));
    };
    forRanges(bricks.size(), kBricksTogether, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            if (slot + kAhead < bricks.size())
                fetch(bricks[slot + kAhead]);
            if (const PictureBrick& brick = bricks[slot]; brick.indexCount > 0) // what it overwrites comes after it
                expandBrick(picture, brick, static_cast<Live>(isovalue),
                            {&positions[first[slot]], &normals[first[slot]],
                             static_cast<std::uint32_t>(first[end] - first[slot])});
        }
    });
}

// Copies a run to another arena; where it begins there.
template <class Arena, class T>
std::uint32_t copyRun(Arena& to, const T* from, std::uint32_t count) {
    ArenaRun run;
    to.resize(run, count);
    std::memcpy(to.at(run.begin), from, count * sizeof(T));
    return run.begin;
}

} // namespace

template <class Live>
auto BrickPicture<Live>::records(const PictureBrick& brick, std::vector<Record>& room) const
    -> std::span<const Record> {
    room.resize(brick.vertexCount);
    const std::uint32_t onEdges = brick.vertexCount - std::uint32_t{brick.innerCount};
    if (onEdges > 0)
        readRecords(type(), points(brick), codes(brick), onEdges, room.data());
    for (std::uint32_t k = 0; k < brick.innerCount; ++k)
        room[onEdges + k] = Record::inside(inner(brick)[k]);
    return room;
}

template <class Live>
std::shared_ptr<const BrickPicture<Live>> separateCopy(const BrickPicture<Live>& picture) {
    auto arenas = std::make_shared<BrickArenas>(picture.type());
    const std::uint32_t pointLines = pointLineCount(scalarTypeSizeBytes(picture.type()));
    std::vector<PictureBrick> bricks;
    for (PictureBrick brick : picture.bricks()) {
        if (brick.indexCount == 0) { // its slot stays: pieces are listed by slot
            bricks.push_back({.place = brick.place, .version = brick.version});
            continue;
        }
        const PictureBrick its = brick;
        brick.firstVertex = copyRun(arenas->vertices, picture.codes(its), its.vertexCount);
        brick.firstIndex = copyRun(arenas->indices, picture.indices(its), its.indexCount);
        brick.firstInner = its.innerCount > 0 ? copyRun(arenas->inner, picture.inner(its), its.innerCount) : 0;
        brick.firstPointLine = copyRun(arenas->points, picture.points(its), pointLines);
        bricks.push_back(brick);
    }
    auto copy = std::make_shared<BrickPicture<Live>>(arenas, std::make_shared<PictureLeases>(), 0, std::move(bricks));
    copy->vertexEnd_ = arenas->vertices.top();
    copy->indexEnd_ = arenas->indices.top();
    copy->innerEnd_ = arenas->inner.top();
    copy->pointLineEnd_ = arenas->points.top();
    return copy;
}

void placesOf(const BrickPicture<float>& picture, const PictureBrick& brick, double isovalue,
              std::vector<glm::vec3>& places) {
    thread_local std::vector<glm::vec3> normals;
    places.resize(brick.vertexCount);
    normals.resize(brick.vertexCount);
    expandBrick(picture, brick, static_cast<float>(isovalue), {places.data(), normals.data(), brick.vertexCount});
}

void expandSome(const BrickPicture<float>& picture, const PictureBrick& brick, std::span<const std::uint16_t> which,
                double isovalue, glm::vec3* positions, glm::vec3* normals) {
    const auto value = static_cast<float>(isovalue);
    const std::uint32_t onEdges = brick.vertexCount - std::uint32_t{brick.innerCount};
    const VertexCode* const codes = picture.codes(brick);
    constexpr std::uint32_t kTogether = 256;
    std::array<VertexCode, kTogether> some;
    std::size_t at = 0;
    while (at < which.size() && which[at] < onEdges) {
        std::uint32_t count = 0;
        for (; count < kTogether && at + count < which.size() && which[at + count] < onEdges; ++count)
            some[count] = codes[which[at + count]];
        placeVertices(picture.type(), picture.points(brick), some.data(), count, brick.origin(), value,
                      {positions + at, normals + at, count});
        at += count;
    }
    for (; at < which.size(); ++at)
        expandInner(picture, brick, which[at] - onEdges, value, positions[at], normals[at]);
}

void prefetchSome(const BrickPicture<float>& picture, const PictureBrick& brick, std::span<const std::uint16_t> which) {
    const std::uint32_t onEdges = brick.vertexCount - std::uint32_t{brick.innerCount};
    const VertexCode* const codes = picture.codes(brick);
    const auto* const samples = reinterpret_cast<const char*>(picture.points(brick));
    const std::size_t sampleBytes = scalarTypeSizeBytes(picture.type());
    const auto* const normals = samples + kKeptPoints * sampleBytes;
    for (std::size_t at = 0; at < which.size() && which[at] < onEdges; ++at) {
        const auto [lower, upper] = endsOf(codes[which[at]]);
        for (const std::size_t point : {lower, upper}) {
            __builtin_prefetch(samples + point * sampleBytes);
            __builtin_prefetch(normals + point * sizeof(NormalCode));
        }
    }
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
        return frame.bricks->vertexEnd() * sizeof(VertexCode) + frame.bricks->innerEnd() * sizeof(InnerRecord) +
               frame.bricks->pointLineEnd() * sizeof(PointLine) +
               (frame.bricks->indexEnd() + frame.bricks->changedIndices().size()) * sizeof(std::uint16_t);
    return (frame.positions.size() + frame.normals.size()) * sizeof(glm::vec3) +
           (frame.indices.size() + frame.changedIndices.size()) * sizeof(std::uint32_t);
}

template class BrickPicture<float>;
template class BrickPicture<double>;
template std::shared_ptr<const BrickPicture<float>> separateCopy(const BrickPicture<float>&);
template void expandVertices(const BrickPicture<float>&, double, std::vector<glm::vec3>&, std::vector<glm::vec3>&);
template void expandVertices(const BrickPicture<double>&, double, std::vector<glm::vec3>&, std::vector<glm::vec3>&);
template void expandPicture(const BrickPicture<float>&, SurfaceFrame&);
template void expandPicture(const BrickPicture<double>&, SurfaceFrame&);

} // namespace isoslider::extract
