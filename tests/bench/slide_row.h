#pragma once

#include <optional>
#include <string>

#include "core/base/result.h"
#include "tests/bench/prepared_index.h"
#include "tests/bench/timing.h"

namespace isoslider::bench {

struct RowOptions {
    double percent = 1.0;
    int steps = 20;
    int threads = 2;
    bool isCold = false; ///< no decoded page is kept, and the file is dropped from memory before each step
    bool withPeer = true; ///< ignored in a build without VTK
    bool withBaseline = false;
    std::string peerBackend = "STDThread";
};

/// One slide of one volume, all contestants in turn at each isovalue. Times in milliseconds per step.
struct SlideRow {
    std::string volume;
    double percent = 0.0;
    int steps = 0;

    Spread product;
    double productFirstMs = 0.0; ///< to the first isovalue of the slide, which is no step
    double updateMs = 0.0; ///< median
    double interpolateMs = 0.0; ///< median
    double copyMs = 0.0; ///< median; memcpy of as many bytes as interpolation reads and writes
    double nsPerChange = 0.0; ///< median over steps that change anything; 0 when none does
    int rebuilds = 0; ///< steps at which the surface was built anew

    // Means over the steps.
    double activeEdges = 0.0;
    double triangles = 0.0;
    double edgesChanged = 0.0;
    double edgesTouched = 0.0;
    double bytesRead = 0.0;
    double ambiguousCells = 0.0; ///< active cells whose signs do not tell their surface
    double cellsResolved = 0.0;  ///< of them decided in the step, by their corner scalars
    double resolveMs = 0.0;      ///< that, summed over the threads

    struct Peer {
        Spread times;
        double firstMs = 0.0;
        double vertices = 0.0; ///< mean
        double triangles = 0.0;
        bool hasNormals = true;
        std::string backend;
    };
    std::optional<Peer> peer;
    std::optional<Spread> baseline;
    int disagreements = 0; ///< steps at which a contestant has another number of vertices

    double ratio() const { return peer ? peer->times.median / product.median : 0.0; }
    double copyRatio() const { return copyMs > 0.0 ? interpolateMs / copyMs : 0.0; }
};

/// Measures one row. Peers see samples that are missing as below every isovalue and make vertices there:
/// on such volumes a peer must only have no fewer. Errors: those of the engine.
Result<SlideRow> measureRow(const BenchVolume& volume, const PreparedIndex& index, const RowOptions& options);

/// True when the bench was built with the peer.
bool hasPeer();

} // namespace isoslider::bench
