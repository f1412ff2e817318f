#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/cell_batches.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/measuring.h"

namespace isoslider::topology {

/// Sums over the cells of a strip.
struct MeasureSums {
    std::vector<ExactSum> sums; ///< as those of CellBatches: two for each isovalue of the plan
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
