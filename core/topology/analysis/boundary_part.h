#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/analysis/strip_changes.h"

namespace isoslider::topology {

/// What one layer has of the boundary of all cells that have eight finite corners, as a graph of grid points: of a box
/// its six sides, where samples are missing more.
struct BoundaryPart {
    /// Between grid points next to each other: up along an axis.
    class Edge {
    public:
        Edge(Point start, std::size_t axis) : bits_(start << 2 | axis) {}
        Point start() const { return bits_ >> 2; }
        std::size_t axis() const { return bits_ & 3; }

    private:
        std::uint64_t bits_;
    };

    std::vector<Point> points; ///< ascending
    std::vector<double> scalars;
    std::vector<Edge> edges; ///< in the order of their starts, then axes
    std::array<Point, 3> steps{}; ///< from a grid point to the next along each axis
    std::vector<BoundaryJoin> above, below;
    std::int64_t euler = 0; ///< of the boundary: points less edges plus faces
    bool isManifold = true; ///< no edge or point at which it only touches itself

    /// But for `above` and `below`, which strips add.
    template <class Sample>
    static BoundaryPart of(const LayerWindow<Sample>& window);
    void add(const StripChanges& changes);
};

} // namespace isoslider::topology
