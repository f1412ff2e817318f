#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/topology/analysis/boundary_part.h"
#include "core/topology/analysis/boundary_rows.h"
#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/isovalue_sums.h"

namespace isoslider::topology {

/// The boundary of all cells that have eight finite corners. Its components on each side of the isovalue give the
/// boundary loops.
class DomainBoundary {
public:
    /// `pointsAtOnce` as in BoundaryRows.
    DomainBoundary(const ChangeStore& store, std::size_t pointsAtOnce)
        : above_(Side::Above, pointsAtOnce, Components(Side::Above, store)),
          below_(Side::Below, pointsAtOnce, Components(Side::Below, store)) {}

    /// In the order of layers. Errors: those of HistorySums::add.
    Status add(const BoundaryPart& part);
    /// Its components on one side at every isovalue, once all layers are there; `span` as in finishComponents.
    /// Errors: those of HistorySums::add.
    Result<SideChanges> take(Side side, double span);
    /// Whether it is nothing but spheres, `components` of them; then the cells have no tunnel, and every surface in
    /// them parts them in two.
    bool isOfSpheres(std::uint64_t components) const {
        return isManifold_ && euler_ == 2 * static_cast<std::int64_t>(components);
    }
    /// Of changes; what else is kept is as large as the rim of a plane.
    std::size_t sizeBytes() const { return above_.graph().sums.sizeBytes() + below_.graph().sums.sizeBytes(); }

private:
    // One side of it as BoundaryRows fills it.
    struct Components {
        Components(Side side, const ChangeStore& store) : sums(store) { graph.side = side; }
        std::uint32_t addNode(Point point, double scalar);
        void addLink(double isovalue, const Cause& cause, std::uint32_t a, std::uint32_t b) {
            graph.links.push_back({isovalue, cause, a, b});
        }
        std::uint32_t nodes() const { return static_cast<std::uint32_t>(graph.seeds.size()); }
        std::vector<std::uint32_t> settle(std::vector<double>& opens);
        Result<SideChanges> take(double span);

        ComponentGraph graph;
        IsovalueOrder order;
        HistorySums sums;
        Status status; ///< the first that the sums were not well with
    };

    BoundaryRows<Components> above_, below_;
    std::int64_t euler_ = 0;
    bool isManifold_ = true;
};

} // namespace isoslider::topology
