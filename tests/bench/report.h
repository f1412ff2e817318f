#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/prepared_index.h"
#include "tests/bench/probes.h"
#include "tests/bench/slide_row.h"

namespace isoslider::bench {

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
