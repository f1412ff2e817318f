#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/extract/slide_engine.h"
#include "tests/bench/timing.h"
#include "tests/bench/workloads.h"

namespace isoslider::bench {

/// The product on one thing to slide on: an index of either kind, or a volume in memory.
struct Contestant {
    std::string name;
    std::filesystem::path file; ///< the index; empty: nothing on disk
    std::function<Result<std::unique_ptr<extract::SlideEngine>>()> open;
    bool makesArrays = false; ///< positions and normals as floats besides
};

/// An index. Reading ahead is off unless asked for: it would go on while others are timed.
Contestant contestantOnIndex(std::string name, const std::filesystem::path& path,
                             const extract::SlideOptions& options = {std::nullopt, false});

/// What a step finds in memory of the index.
enum class CacheState {
    AsLeft, ///< what the steps before have left
    OnDisk, ///< what was decoded before, within its bound; of the file nothing
    Empty, ///< nothing decoded, nothing of the file
};

struct RowOptions {
    double percent = 1.0;
    int steps = 20;
    bool isSecondSlide = false; ///< measure where the product has slid before
    int threads = 2;
    CacheState caches = CacheState::AsLeft;
    int pauseMs = 0; ///< after each contestant's step: time to read ahead, where that is on
    bool withCopy = true; ///< a copy of what interpolation touches, after each contestant
    bool withPeer = true; ///< ignored in a build without VTK
    bool withBaseline = false; ///< REQUIRES: the first contestant has an index of edges
    std::string peerBackend = "STDThread";
};

/// What one contestant took. Times in milliseconds per step.
struct EngineRow {
    std::string name;
    Spread times;
    double firstMs = 0.0; ///< to the first isovalue of the slide, which is no step
    double updateMs = 0.0; ///< median of the engine's part of a step; the rest is the table of the picture
    double arraysMs = 0.0; ///< median of what it takes further to have positions and normals as floats; 0: not made
    double sentBytes = 0.0; ///< mean: records and indices of bricks that differ from the picture before
    double copyMs = 0.0; ///< median; memcpy of as many bytes as interpolation reads and writes
    double nsPerChange = 0.0; ///< median over steps that change anything; 0 when none does
    int rebuilds = 0; ///< steps at which the surface was built again

    // Means over the steps.
    double activeEdges = 0.0;
    double triangles = 0.0;
    double edgesChanged = 0.0;
    double edgesTouched = 0.0;
    double bytesRead = 0.0;
    double bytesAhead = 0.0;
    double bricksRead = 0.0;
    double chunksRead = 0.0;
    double ambiguousCells = 0.0; ///< active cells whose signs do not determine their surface
    double cellsResolved = 0.0; ///< of them decided in the step, by their corner scalars

    double copyRatio() const { return copyMs > 0.0 ? arraysMs / copyMs : 0.0; }
};

/// One slide of one volume, all contestants in turn at each isovalue.
struct SlideRow {
    std::string volume;
    double percent = 0.0;
    int steps = 0;
    std::vector<EngineRow> engines;

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
    int disagreements = 0; ///< steps at which a contestant has another number of vertices or triangles

    const EngineRow& ours() const { return engines.front(); }
    /// The first that makes arrays; where scalars live as double all of them do, in their steps.
    const EngineRow& withArrays() const {
        const auto found =
            std::find_if(engines.begin(), engines.end(), [](const EngineRow& row) { return row.arraysMs > 0.0; });
        return found != engines.end() ? *found : ours();
    }
    double arraysMs() const { return withArrays().times.median + withArrays().arraysMs; }
    /// How many times faster than the peer; 0 without it.
    double ratio(const EngineRow& engine) const { return peer ? peer->times.median / engine.times.median : 0.0; }
    double ratio() const { return ratio(ours()); }
    /// The same with positions and normals as floats.
    double arraysRatio() const { return peer ? peer->times.median / arraysMs() : 0.0; }
};

/// Measures one row. Peers see samples that are missing as below every isovalue and make vertices there:
/// on such volumes a peer must only have no fewer. REQUIRES: a contestant. Errors: those of the engines.
Result<SlideRow> measureRow(const BenchVolume& volume, const std::vector<Contestant>& contestants,
                            const RowOptions& options);

/// True when the bench was built with the peer.
bool hasPeer();

} // namespace isoslider::bench
