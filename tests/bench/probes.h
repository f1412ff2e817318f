#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/index/format/index_info.h"
#include "tests/bench/volume_file.h"

namespace isoslider::bench {

/// The product in a separate process (slide_probe).
struct ProbeResult {
    double openMs = 0.0;
    double firstSurfaceMs = 0.0; ///< from nothing: opening included
    std::uint64_t emptyBytes = 0; ///< before anything was opened
    std::uint64_t firstBytes = 0; ///< with the first surface
    std::uint64_t slideBytes = 0; ///< after the slide
    std::uint64_t peakBytes = 0;
    std::uint64_t firstEdges = 0;
    std::uint64_t mostEdges = 0;

    double bytesPerEdgeAtFirst() const;
    double bytesPerEdgeAfterSlide() const;
    /// Bytes that came while exploring.
    std::uint64_t grownBytes() const { return slideBytes > emptyBytes ? slideBytes - emptyBytes : 0; }
};

struct ProbeRequest {
    std::filesystem::path index;
    std::optional<VolumeFile> volume; ///< set: read into memory and slid on there, without an index
    int threads = 2;
    std::optional<std::uint64_t> cacheBytes; ///< none: as the product has it
    std::vector<double> isovalues; ///< the first is the first surface, the others are the slide
};

/// Errors: IoError (the probe cannot be started or fails).
Result<ProbeResult> probeSlide(const ProbeRequest& request);

/// A build in a separate process (build_probe).
struct BuildProbeResult {
    double seconds = 0.0; ///< opening the volume's file included
    std::uint64_t emptyBytes = 0; ///< resident before
    std::uint64_t peakBytes = 0; ///< resident at most, the program itself included
};

struct BuildProbeRequest {
    VolumeFile volume; ///< streamed from the disk
    std::filesystem::path index;
    index::IndexKind kind = index::IndexKind::Edges;
    int threads = 2;
    std::uint64_t memoryBytes = std::uint64_t{512} << 20;
};

/// Errors: IoError (the probe cannot be started or fails).
Result<BuildProbeResult> probeBuild(const BuildProbeRequest& request);

/// An analysis of topology in a separate process (topology_cost_probe).
struct TopologyProbeResult {
    double seconds = 0.0;
    double processorSeconds = 0.0; ///< of all threads
    std::uint64_t emptyBytes = 0; ///< resident before
    std::uint64_t peakBytes = 0; ///< resident at most, the program itself included
    std::uint64_t events = 0;
};

/// Adds the topology to an index of metacells that has none. Errors: IoError (the probe cannot be started or fails).
Result<TopologyProbeResult> probeTopology(const std::filesystem::path& index, int threads);

} // namespace isoslider::bench
