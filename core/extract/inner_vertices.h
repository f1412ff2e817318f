#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "core/cell/cell_states.h"
#include "core/grid/brick_grid.h"
#include "core/grid/normal_codec.h"

namespace isoslider::extract {

/// A cell whose inner vertices are to be placed.
struct InnerVertexCell {
    const cell::CellState* state = nullptr;
    std::array<std::int64_t, 3> origin{}; ///< grid coordinates of corner 0
    std::array<glm::vec3, 12> edgePositions{}; ///< of the vertices on edgesOfInnerVertices()
    std::array<glm::vec3, 12> edgeNormals{};
    cell::CornerScalars scalars{}; ///< needed for a tunnel only
};

/// A vertex inside a cell, as an index of the surface's bricks keeps it.
struct InnerVertex {
    glm::vec3 place; ///< in cells from the first grid point of the cell's brick (core/grid/brick_grid.h)
    NormalCode normal = 0;
};

/// Position in grid index units and normal: the same arithmetic in full extraction and in sliding, so that equal
/// surfaces have equal bytes.
inline glm::vec3 positionOf(const InnerVertex& vertex, const std::array<std::int64_t, 3>& cellOrigin) {
    glm::vec3 first;
    for (int a = 0; a < 3; ++a)
        first[a] = static_cast<float>(cellOrigin[static_cast<std::size_t>(a)] & ~std::int64_t{kBrickSide - 1});
    return first + vertex.place;
}

/// Places a cell's inner vertices: on the interpolant's surface for a tunnel's waist, in the mean of the
/// loop for a centre; always strictly inside the cell and apart from each other, by 1/2048 of a cell or
/// more where coordinates are too large for that. `vertices` has room for state->innerVertices.
void placeInnerVertices(const InnerVertexCell& cell, double isovalue, const glm::vec3& inverseSpacing,
                        InnerVertex* vertices);

/// By state, bit e: its inner vertices depend on edgePositions[e] or edgeNormals[e].
std::span<const std::uint16_t> edgesOfInnerVertices();

/// A vertex in the mean of a loop around a cell of `side` cells of the grid from `origin` on: strictly inside it.
/// `positions` in grid index units. REQUIRES: not empty, as many normals.
InnerVertex placeLoopCentre(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                            const std::array<std::int64_t, 3>& origin, std::int32_t side);

} // namespace isoslider::extract
