#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/isovalue_sums.h"
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

    explicit DomainBoundary(const ChangeStore& store = {}) : above_(Side::Above, store), below_(Side::Below, store) {}

    /// In the order of layers. Errors: those of HistorySums::add.
    Status add(const Part& part);
    /// Its components on one side at every isovalue, once all layers are there; `span` as in finishComponents.
    /// Errors: those of HistorySums::add.
    Result<SideChanges> take(Side side, double span);
    /// Whether it is nothing but spheres, `components` of them; then the cells have no tunnel, and every surface in
    /// them parts them in two.
    bool isOfSpheres(std::uint64_t components) const {
        return isManifold_ && euler_ == 2 * static_cast<std::int64_t>(components);
    }
    /// Of changes; what else is kept is as large as the rim of a plane.
    std::size_t sizeBytes() const { return above_.sums.sizeBytes() + below_.sums.sizeBytes(); }

private:
    // One side of it in the layers so far. Each grid point is a seed at first; those without links to points to come
    // are soon settled.
    class OneSide {
    public:
        OneSide(Side side, const ChangeStore& store) : sums(store) { graph_.side = side; }
        Status add(const Part& part);
        Result<SideChanges> take(double span);
        HistorySums sums;

    private:
        struct Place {
            Point point;
            double scalar;
            std::uint32_t seed;
        };
        struct Waiting { // a link, to a grid point that is not there yet
            std::array<Point, 2> points;
            double isovalue;
            Cause cause;
            bool isEdge; ///< of the grid: from the later of both scalars on
        };
        Status addPoints(const Part& part, std::size_t begin, std::size_t end);
        void addEdges(const Part& part, std::size_t firstPlace);
        void addLink(const Waiting& link, const Place& a, const Place& b);
        const Place* find(Point point) const;
        Status settle();

        ComponentGraph graph_;
        IsovalueOrder order_;
        std::vector<Place> places_; ///< with links that wait, and those that have just come; ascending
        std::vector<Waiting> waiting_;
        std::vector<BoundaryJoin> joins_; ///< of the part that comes, by their first points
        std::size_t nextEdge_ = 0, nextJoin_ = 0; ///< of the part
    };

    OneSide above_, below_;
    std::int64_t euler_ = 0;
    bool isManifold_ = true;
};

} // namespace isoslider::topology
