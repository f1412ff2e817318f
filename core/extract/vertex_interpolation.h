#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/grid/brick_grid.h"
#include "core/grid/normal_codec.h"

namespace isoslider::extract {

/// The array E for a run of active edges of one brick, a column per field. Positions of the edges'
/// ends follow from brick and local edge, so they are not stored.
template <class Live>
struct EdgeColumns {
    const Live* scalars1 = nullptr;
    const Live* scalars2 = nullptr;
    const std::uint32_t* normals = nullptr; ///< normal1 | normal2 << 16
    const LocalEdge* edges = nullptr;
};

/// Entries are processed in groups of this size.
inline constexpr std::size_t kInterpolationGroup = 16;

/// Fills V and N for `count` active edges of the brick whose first grid point is `origin`:
/// positions in grid index units, unit normals. Vectorised; about 14 bytes read and 24 written an edge.
/// REQUIRES: all arrays have room for `count` rounded up to kInterpolationGroup; the rest is filled with
/// finite nonsense.
void interpolateVertices(const EdgeColumns<float>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin,
                         float isovalue, glm::vec3* positions, glm::vec3* normals);
void interpolateVertices(const EdgeColumns<double>& edges, std::size_t count, const std::array<std::int32_t, 3>& origin,
                         double isovalue, glm::vec3* positions, glm::vec3* normals);

/// V and N may be written past the caches: a thread calls this after its last interpolateVertices() and
/// before it tells others that it is done.
void orderInterpolatedVertices();

} // namespace isoslider::extract
