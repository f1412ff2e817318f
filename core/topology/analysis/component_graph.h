#pragma once

#include <cstdint>
#include <vector>

#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// What is above the isovalue, growing while it falls, or what is below it, growing while it rises. To both sides an
/// isovalue *comes earlier* than another when it is met first.
enum class Side { Above, Below };
inline bool comesEarlier(Side side, double a, double b) { return side == Side::Above ? a > b : a < b; }

/// Where a component may come: a grid point none of whose neighbours comes earlier, or none in its layer.
struct Seed {
    double isovalue;
    double reachesBoundary; ///< earliest isovalue at which the points that lead here reach the boundary; NaN: never
    Point point;
};
/// From an isovalue on, what two seeds have come to is one.
struct Link {
    double isovalue;
    Cause cause;
    std::uint32_t a, b;
};

/// The components of one side at every isovalue, as a graph of seeds and links. Links that never matter may be left
/// out: any forest of earliest links has the same components at every isovalue.
struct ComponentGraph {
    Side side = Side::Above;
    std::vector<Seed> seeds;
    std::vector<Link> links;
};

/// Leaves out links whose ends are joined no later without them (Borůvka's rounds); of equal isovalues the first.
/// Those left keep their order. O(links log seeds) at most.
void keepForest(Side side, std::size_t seeds, std::vector<Link>& links);

/// A component that comes, or joins an elder one, having lasted for a while.
struct ComponentChange {
    double isovalue;
    double persistence;
    Cause cause;
};
/// A change of the number of components that do not reach the boundary.
struct ClosedChange {
    double isovalue;
    std::int64_t closed;
    Cause cause;
};
struct ComponentHistory {
    std::vector<ComponentChange> births, joins; ///< not in order; equally many, but for the components that last
    std::vector<ClosedChange> closed; ///< in the order of isovalues met; of the side below only
    std::uint64_t lasting = 0; ///< components in the end
};

/// Joins components by the elder rule: the one that came earlier lasts. `span`: how long the one that lasts has lasted.
/// O(n log n); the links are sorted in place.
ComponentHistory followComponents(ComponentGraph& graph, double span);

} // namespace isoslider::topology
