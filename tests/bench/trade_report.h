#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/probes.h"
#include "tests/bench/slide_row.h"
#include "tests/bench/volume_file.h"

namespace isoslider::bench {

/// What one way to slide costs before a step is made.
struct WayCost {
    std::string name; ///< "edges", "metacells", "memory", with the cache where there are several
    bool isInMemory = false;
    bool isSkipped = false; ///< its index would be too large: only predictedBytes is set
    double predictedBytes = 0.0; ///< of the index, from that of the same field at a smaller size; 0: not asked for
    std::uint64_t indexBytes = 0;
    std::uint64_t cacheBytes = 0; ///< bound on what is kept of the index; in memory the volume
    BuildProbeResult build; ///< zeros in memory
    ProbeResult probe;
    double firstColdMs = 0.0; ///< the first surface with nothing of the file in memory; 0: not measured
};

/// One step size.
struct TradeRow {
    SlideRow warm;
    std::optional<SlideRow> cold;
    std::vector<EngineRow> onDisk, ahead; ///< by name; see README.md
    bool agrees() const;
};

struct TradeReport {
    std::string volume;
    VolumeFile file;
    Yardstick yardstick;
    std::uint64_t memoryBytes = 0; ///< the builds' budget
    std::vector<WayCost> ways;
    std::vector<TradeRow> rows;
    bool peerIsLeftOut = false; ///< the volume is too large for it
    double othersBusy = 0.0; ///< processors that other programs used meanwhile

    bool agrees() const;
};

enum class TextForm { Plain, Markdown };

/// A volume: its yardstick, a line for each way, then a line for each way and step size.
std::string describe(const TradeReport& report, TextForm form);
/// Over all volumes: how many times faster than the peer, for each way and step size.
std::string summarise(const std::vector<TradeReport>& reports, TextForm form);

/// Columns of the rows of comma-separated values, and a row per way and step size, each with its newline.
std::string tradeCsvHeading();
std::string tradeCsv(const TradeReport& report, int threads);

} // namespace isoslider::bench
