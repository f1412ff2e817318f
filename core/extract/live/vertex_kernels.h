#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/extract/live/brick_points.h"
#include "core/extract/live/edge_record.h"
#include "core/extract/live/vertex_code.h"

namespace isoslider::extract {

inline constexpr std::uint32_t kGroupSize = 16;

/// The records (edge_record.h) of so many vertices on edges, a column per field. Behind the last vertex of a brick
/// there is anything.
template <class Live>
struct alignas(64) VertexGroup {
    Live lower[kGroupSize], upper[kGroupSize]; ///< scalars at the ends of the edge or leaf edge
    std::uint32_t normals[kGroupSize]; ///< NormalCode of the lower end, and in the upper half that of the upper
    std::uint32_t codes[kGroupSize]; ///< VertexCode
};

constexpr std::uint32_t groupCount(std::uint32_t count) { return (count + kGroupSize - 1) / kGroupSize; }

/// Where positions (grid index units) and unit normals go: there is room for `count` of each, at least as many as are
/// asked for. What is behind those may be written to, and holds nothing then.
struct VertexRoom {
    glm::vec3 *positions, *normals;
    std::uint32_t count;

    VertexRoom from(std::uint32_t begin) const { return {positions + begin, normals + begin, count - begin}; }
};

/// Records of `count` vertices on edges, from their codes and the brick's points: BrickPoints of samples of `type`.
/// REQUIRES: Live is what such samples live as.
template <class Live>
void readRecords(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                 EdgeRecord<Live>* records);
/// The same of one vertex.
template <class Live>
EdgeRecord<Live> readRecord(ScalarType type, const PointLine* points, VertexCode code);
/// The same in groups, as many as are needed.
template <class Live>
void gatherVertices(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                    VertexGroup<Live>* groups);

/// vertexOf() of the first `count` vertices of groups, several at a time, equal to the bit.
template <class Live>
void placeVertices(const VertexGroup<Live>* groups, std::uint32_t count, const std::array<std::int32_t, 3>& origin,
                   Live isovalue, const VertexRoom& room);
/// The same from codes and points. REQUIRES: as gatherVertices().
template <class Live>
void placeVertices(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                   const std::array<std::int32_t, 3>& origin, Live isovalue, const VertexRoom& room);

} // namespace isoslider::extract
