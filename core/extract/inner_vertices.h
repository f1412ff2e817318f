#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/cell/cell_states.h"

namespace isoslider::extract {

/// A cell whose inner vertices are to be placed.
struct InnerVertexCell {
    const cell::CellState* state = nullptr;
    std::array<std::int64_t, 3> origin{};      ///< grid coordinates of corner 0
    std::array<glm::vec3, 12> edgePositions{}; ///< of the active edges' vertices
    std::array<glm::vec3, 12> edgeNormals{};
    cell::CornerScalars scalars{};             ///< needed for a tunnel only
};

/// Places a cell's inner vertices: on the interpolant's surface for a tunnel's waist, in the mean of the
/// loop for a centre; always strictly inside the cell and apart from each other, by 1/2048 of a cell or
/// more where coordinates are too large for that. The same arithmetic in full extraction and in sliding, so
/// that equal surfaces have equal bytes. `positions` and `normals` have room for state->innerVertices.
void placeInnerVertices(const InnerVertexCell& cell, double isovalue, const glm::vec3& inverseSpacing, glm::vec3* positions,
                        glm::vec3* normals);

} // namespace isoslider::extract
