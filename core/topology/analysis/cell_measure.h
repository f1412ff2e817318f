#pragma once

#include <array>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "core/cell/cell_states.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::topology {

/// What the triangles of one cell measure.
struct CellSum {
    double area = 0.0;
    double volume = 0.0; ///< above the surface, in cells
    double gradient = 0.0; ///< gradient magnitude in the middle, times the area
};

/// Measures one cell after the other, in double precision. CellBatches is the quick way; here are the cells with
/// tunnels and with scalars far away, and what it is tested against.
class CellMeasure {
public:
    explicit CellMeasure(const GridGeometry& geometry);

    /// O(triangles). REQUIRES: `state` is that of the cell at this isovalue; the surface passes through the cell.
    CellSum at(const cell::CornerScalars& scalars, const cell::CellState& state, double isovalue);

    /// From steps along the grid's axes to lengths: of gradients; of what is normal to an area.
    const glm::dmat3& gradientToWorld() const { return gradientToWorld_; }
    const glm::dmat3& areaToWorld() const { return areaToWorld_; }

private:
    double areaAboveOnFace(const cell::CellState& state) const;
    void placeInner(const cell::CornerScalars& scalars, const cell::CellState& state, double isovalue);

    glm::dmat3 gradientToWorld_, areaToWorld_;
    std::array<glm::dvec3, cell::kInnerVertex + cell::kMaxInnerVertices> places_{};
};

} // namespace isoslider::topology
