#pragma once

#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/isovalue_sums.h"
#include "core/topology/analysis/link_collector.h"
#include "core/topology/analysis/strip_components.h"

namespace isoslider::topology {

/// One side of all strips, put together as they come: those of a layer in the order of their rows, one layer after the
/// other. What is left at the end of a layer is about as much as a plane has.
class SideGraph {
public:
    SideGraph(Side side, const ChangeStore& store) : sums_(store), between_(side) { graph_.side = side; }

    /// Errors: OutOfSpace (2^32 extremes); those of ScratchFile::append.
    template <class Sample>
    Status add(const StripComponents& part, const LayerWindow<Sample>& window, const Strip& strip);
    HistorySums& sums() { return sums_; }
    /// Once all are there. `span`: how long a component that lasts has lasted.
    Result<SideChanges> take(double span);

private:
    Status settle();

    ComponentGraph graph_;
    std::vector<double> opens_; ///< by seed, as in StripComponents
    HistorySums sums_;
    LinkCollector between_;
    // Seeds that grid points lead to: of the last layer's uppermost plane, of the present one's as far as it has come,
    // and of the last row of the strip before.
    std::vector<std::uint32_t> top_, nextTop_, back_;
};

} // namespace isoslider::topology
