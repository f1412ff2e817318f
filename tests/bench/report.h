#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/slide_row.h"

namespace isoslider::bench {

/// The product in a process of its own (slide_probe).
struct ProbeResult {
    double openMs = 0.0;
    double firstSurfaceMs = 0.0; ///< from nothing: opening included
    std::uint64_t emptyBytes = 0; ///< before the index was opened
    std::uint64_t firstBytes = 0; ///< with the first surface
    std::uint64_t slideBytes = 0; ///< after a slide of 1 % steps
    std::uint64_t peakBytes = 0;
    std::uint64_t firstEdges = 0;
    std::uint64_t mostEdges = 0;

    double bytesPerEdgeAtFirst() const;
    double bytesPerEdgeAfterSlide() const;
};

/// Everything measured for one volume.
struct VolumeReport {
    BenchVolume volume;
    PreparedIndex index;
    ProbeResult probe;
    ProbeResult probeWithoutCache; ///< the same with no decoded page kept: the live surface alone
    double firstPictureSeconds = 0.0;
    std::vector<SlideRow> rows;
    double othersBusy = 0.0; ///< processors that other programs used meanwhile
};

void printVolume(const VolumeReport& report);
void printRowHeading();
void printRow(const SlideRow& row);

/// Geometric mean over the volumes for each step size, then the figures to reach beside those measured.
void printSummary(const std::vector<VolumeReport>& reports, bool isCold);

/// One row of comma-separated values, the columns as README.md lists them; without a newline.
std::string productCsv(const SlideRow& row, const VolumeReport& report, int threads);
/// REQUIRES: row.peer.
std::string peerCsv(const SlideRow& row, int threads, std::uint64_t baseBytes);

} // namespace isoslider::bench
