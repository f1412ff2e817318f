#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/extract/live/edge_record.h"

namespace isoslider::extract {

/// Positions (grid index units) and unit normals of `count` records on edges, as floats: vertexOf() of each, several at
/// a time, equal to the bit. REQUIRES: none of them is inside a cell.
template <class Live>
void interpolateVertices(const EdgeRecord<Live>* records, std::uint32_t count,
                         const std::array<std::int32_t, 3>& origin, Live isovalue, glm::vec3* positions,
                         glm::vec3* normals);

} // namespace isoslider::extract
