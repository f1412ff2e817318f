#pragma once

#include <algorithm>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/layer_euler.h"
#include "core/topology/topology_event.h"

namespace isoslider::topology {

/// How much was found that can be an event: in layers, or what is expected of all of them.
struct Findings {
    double euler = 0.0; ///< changes of the Euler number
    double seeds = 0.0, links = 0.0; ///< of both sides
    double boundaryBytes = 0.0; ///< that DomainBoundary keeps

    Findings operator*(double factor) const {
        return {euler * factor, seeds * factor, links * factor, boundaryBytes * factor};
    }
    /// Bytes of all layers together, until events are made of it.
    double keptBytes() const {
        return euler * sizeof(EulerChange) + seeds * sizeof(Seed) + links * sizeof(Link) + boundaryBytes;
    }
};

/// Bytes of one layer while it is worked on; `found` in it. Measured on noise: vectors that grow are held one and a
/// quarter times besides; of each sample, also, what it leads to, its star and the like.
inline double layerBytes(double samples, const Findings& found) {
    constexpr double kOfSample = 40.0, kGrowing = 2.25;
    return kOfSample * samples + kGrowing * found.keptBytes();
}

/// Bytes of CoarseCounts beside a layer: of five forests nodes, links and sets, and of both planes between layers.
inline double coarseBytes(double planeSamples, const Findings& found) {
    constexpr double kOfNode = 60.0, kOfPlanePoint = 120.0;
    return kOfNode * (found.seeds + found.links) + kOfPlanePoint * planeSamples;
}

/// Bytes at most from when all layers are put together until their events are stored: components are followed, events
/// made, then written. An upper bound where every change is an event, as in noise.
inline double assemblyBytes(const Findings& found) {
    // A seed comes and joins; such changes, growing, are held half once more. Sets, and the order of seeds.
    const double changes = 2.0 * sizeof(ComponentChange) * found.seeds;
    const double closed = 0.5 * sizeof(ClosedChange) * (found.seeds + found.links); // of one side
    const double following = found.keptBytes() + 1.5 * changes + 16.0 * found.seeds + closed;
    const double events = sizeof(TopologyEvent) * found.euler;
    const double assembling = sizeof(EulerChange) * found.euler + changes + closed + 3.0 * found.boundaryBytes + events;
    constexpr double kStored = 100.0; // of an event, coded, in a vector that grows
    return std::max({following, assembling, (sizeof(TopologyEvent) + kStored) * found.euler});
}

} // namespace isoslider::topology
