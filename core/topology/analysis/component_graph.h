#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/topology/analysis/isovalue_order.h"
#include "core/topology/analysis/packed_cause.h"

namespace isoslider::topology {

/// What is above the isovalue, growing while it falls, or what is below it, growing while it rises. To both sides an
/// isovalue *comes earlier* than another when it is met first.
enum class Side { Above, Below };
inline bool comesEarlier(Side side, double a, double b) { return side == Side::Above ? a > b : a < b; }
/// The earlier one; NaN stands for never.
inline double earlier(Side side, double a, double b) { return std::isnan(a) || comesEarlier(side, b, a) ? b : a; }

/// Where a component may come: a grid point none of whose neighbours comes earlier, or none in its strip.
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

/// Which of two links of one isovalue is met first. The order does not depend on the parts that a volume is taken in,
/// so the same links matter: those at grid points come first, for within a part there are none to a point's own
/// neighbours; of equal samples in the order in which one leads to the other.
inline bool isMetFirst(Side side, Cause a, Cause b) {
    if (a.isVertex() != b.isVertex())
        return a.isVertex();
    return a.isVertex() && side == Side::Above ? b < a : a < b;
}

/// The components of one side at every isovalue, as a graph of seeds and links. Links that never matter may be left
/// out: any forest of earliest links has the same components at every isovalue.
struct ComponentGraph {
    Side side = Side::Above;
    std::vector<Seed> seeds;
    std::vector<Link> links;
};

/// Leaves out links whose ends are joined no later without them; of equal isovalues those that are met first stay.
/// Those left keep their order. O(links), nearly.
void keepForest(Side side, std::size_t seeds, std::vector<Link>& links, IsovalueOrder& order);

/// Components that come, or join elder ones, at one isovalue: at a grid point, or at saddles.
struct ComponentChange {
    double isovalue;
    double persistence; ///< how long they last as separate ones: the longest
    Cause cause; ///< of that one
    std::uint32_t count;
    std::uint32_t closed; ///< of those that join: how many do not reach the boundary by then
};
/// Components of the side below that come to reach the boundary.
struct ClosedChange {
    double isovalue;
    std::uint32_t count;
};
/// Components that lasted no while are not in it.
struct ComponentHistory {
    std::vector<ComponentChange> births, joins; ///< in no order
    std::vector<ClosedChange> reached;
    std::uint64_t lasting = 0; ///< components in the end

    void add(const ComponentHistory& other);
};

/// Joins components by the elder rule: the one that came earlier lasts. What is certain by then goes into `history`:
/// that a component joins an elder one, while it is known whole. `opens[s]`: the earliest isovalue at which points that
/// lead to seed s touch what is not in the graph yet; NaN: never. Seeds and links that may still matter stay in the
/// graph, which has the same components as before among these; returns what each seed is then part of. O(n), nearly.
std::vector<std::uint32_t> settleComponents(ComponentGraph& graph, std::vector<double>& opens,
                                            ComponentHistory& history, IsovalueOrder& order);

/// What is left of a graph that is whole. `span`: how long a component that lasts has lasted.
void finishComponents(ComponentGraph graph, double span, ComponentHistory& history);

} // namespace isoslider::topology
