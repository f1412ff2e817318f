#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/measuring.h"

namespace isoslider::topology {

/// Sums over the cells of a strip, one for each isovalue of the plan.
struct MeasureSums {
    struct Sum {
        double area = 0.0, volume = 0.0, triangles = 0.0, gradient = 0.0; ///< the last times the area
        double usualArea = 0.0, usualGradient = 0.0; ///< in cells of usual values
    };
    std::vector<Sum> sums;
    std::vector<std::uint64_t> cellsAbove; ///< [i]: wholly above the first i isovalues, not above the next

    void add(const MeasureSums& other);
    /// In units of the geometry.
    MeasureCurves curves(const MeasurePlan& plan, const GridGeometry& geometry) const;
};

/// Measures the triangles that the surface has in cells. O(cells), and what CellBatches takes.
template <class Sample>
MeasureSums measureStrip(const LayerWindow<Sample>& window, const Strip& strip, const MeasurePlan& plan,
                         const GridGeometry& geometry);

} // namespace isoslider::topology
