#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/extract/live/brick_points.h"
#include "core/extract/live/edge_record.h"
#include "core/extract/live/vertex_code.h"

namespace isoslider::extract {

/// Codes are read in whole vectors: behind the last there are others, of any edges, up to a multiple of this.
inline constexpr std::uint32_t kCodesTogether = 16;
/// So many vertices and what they are made from stay in the nearest cache.
inline constexpr std::uint32_t kNearVertices = 256;
static_assert(kNearVertices % kCodesTogether == 0);

/// Records of `count` vertices on edges, from their codes and the brick's points: BrickPoints of samples of `type`.
/// REQUIRES: Live is what such samples live as; what kCodesTogether says.
template <class Live>
void readRecords(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                 EdgeRecord<Live>* records);
/// The same of one vertex.
template <class Live>
EdgeRecord<Live> readRecord(ScalarType type, const PointLine* points, VertexCode code);

/// Positions (grid index units) and unit normals of `count` records on edges, as floats: vertexOf() of each, several at
/// a time, equal to the bit. REQUIRES: none of them is inside a cell.
template <class Live>
void interpolateVertices(const EdgeRecord<Live>* records, std::uint32_t count,
                         const std::array<std::int32_t, 3>& origin, Live isovalue, glm::vec3* positions,
                         glm::vec3* normals);

/// Both in one: the vertices of codes, without records where no leaf edges are among them. REQUIRES: as readRecords().
template <class Live>
void placeVertices(ScalarType type, const PointLine* points, const VertexCode* codes, std::uint32_t count,
                   const std::array<std::int32_t, 3>& origin, Live isovalue, glm::vec3* positions, glm::vec3* normals);

} // namespace isoslider::extract
