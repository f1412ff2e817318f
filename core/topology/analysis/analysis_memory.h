#pragma once

#include <cstddef>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/strip_changes.h"

namespace isoslider::topology {

/// How much was found that can be an event: in layers, or what is expected of all of them.
struct Findings {
    double euler = 0.0; ///< changes of the Euler number
    double changes = 0.0; ///< components that came and went: ComponentChange, of both sides
    double seeds = 0.0, links = 0.0; ///< of both sides, before they are sorted out
    double boundaryBytes = 0.0; ///< of changes that DomainBoundary keeps

    Findings operator+(const Findings& other) const {
        return {euler + other.euler, changes + other.changes, seeds + other.seeds, links + other.links,
                boundaryBytes + other.boundaryBytes};
    }
    Findings operator*(double factor) const {
        return {euler * factor, changes * factor, seeds * factor, links * factor, boundaryBytes * factor};
    }
    /// Bytes of all layers together, until events are made of it.
    double keptBytes() const { return euler * sizeof(EulerChange) + changes * sizeof(ComponentChange) + boundaryBytes; }
};

/// Bytes of the window of a layer: samples, their stars and which neighbours are higher; some planes are held twice.
inline double layerBytes(double samples, std::size_t sampleBytes) {
    return (1.5 * static_cast<double>(sampleBytes) + 4.0) * samples;
}

/// Bytes of what is as large as a plane: at both ends the graph of the boundary; seeds of the upper planes of two
/// layers, of both sides.
inline double planeBytes(double samples) {
    constexpr double kOfPoint = 56.0;
    return kOfPoint * samples;
}

/// Bytes of what is left of strips until their layer is there; `found` at the grid points between them.
inline double openBytes(const Findings& found) {
    constexpr double kOfSeed = 160.0; // itself, a link, a copy of that while it is settled, numbers and sets
    return kOfSeed * found.seeds;
}

/// Bytes of one strip while it is worked on; `found` in it. Measured on noise: vectors that grow are held one and a
/// quarter times besides; of each sample, also, what it leads to and the like; links are sorted in a copy.
inline double stripBytes(double samples, const Findings& found) {
    constexpr double kOfSample = 32.0, kGrowing = 2.25, kOfSeed = 48.0, kOfLink = 1.5 * sizeof(Link) + 20.0;
    return kOfSample * samples + kGrowing * found.keptBytes() + kOfSeed * found.seeds + kOfLink * found.links;
}

/// Bytes of several that are worked on at once: not all are where they take most. Measured.
inline double bytesOfStrips(double strips, double bytesOfOne) { return bytesOfOne * (0.15 + 0.85 * strips); }

/// Bytes of CoarseCounts beside a layer: of five forests nodes, links and sets, and of both planes between layers.
inline double coarseBytes(double planeSamples, const Findings& found) {
    constexpr double kOfSeed = 120.0, kOfPlanePoint = 120.0;
    return kOfSeed * found.seeds + kOfPlanePoint * planeSamples;
}

/// Bytes of events until they are stored, at most. An upper bound where every change is an event, as in noise.
inline double eventBytes(double eulerChanges) {
    constexpr double kCoded = 30.0; // of an event, at most
    return kCoded * eulerChanges;
}

} // namespace isoslider::topology
