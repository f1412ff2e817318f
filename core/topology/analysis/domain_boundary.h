#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/layer_euler.h"
#include "core/topology/analysis/layer_window.h"

namespace isoslider::topology {

/// The boundary of all cells that have eight finite corners, as a graph of grid points: of a box its six sides, where
/// samples are missing more. Its components on each side of the isovalue give the boundary loops.
class DomainBoundary {
public:
    /// Between grid points next to each other: up along an axis.
    class Edge {
    public:
        Edge(Point start, std::size_t axis) : bits_(start << 2 | axis) {}
        Point start() const { return bits_ >> 2; }
        std::size_t axis() const { return bits_ & 3; }

    private:
        std::uint64_t bits_;
    };
    /// What one layer has of it.
    struct Part {
        std::vector<Point> points; ///< ascending
        std::vector<double> scalars;
        std::vector<Edge> edges; ///< in the order of their starts, then axes
        std::array<Point, 3> steps{}; ///< from a grid point to the next along each axis
        std::vector<BoundaryJoin> above, below;
        std::int64_t euler = 0; ///< of the boundary: points less edges plus faces
        bool isManifold = true; ///< no edge or point at which it only touches itself
    };
    template <class Sample>
    static Part partOf(const LayerWindow<Sample>& window, const LayerChanges& changes);

    /// In the order of layers.
    void add(const Part& part);

    /// Its components on one side at every isovalue; `span` as in finishComponents. O(n log n) in its points.
    ComponentHistory follow(Side side, double span) const;
    /// Whether it is nothing but spheres, `components` of them; then the cells have no tunnel, and every surface in
    /// them parts them in two.
    bool isOfSpheres(std::uint64_t components) const {
        return all_.isManifold && all_.euler == 2 * static_cast<std::int64_t>(components);
    }
    std::uint64_t sizeBytes() const;

private:
    Part all_;
};

} // namespace isoslider::topology
