#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/trade_report.h"

namespace isoslider::bench {

struct TradeOptions {
    std::vector<std::string> kinds{"edges", "metacells", "memory"};
    std::vector<double> percents{0.01, 0.1, 1, 10, 37};
    std::vector<std::uint64_t> caches; ///< none: as the product has it
    RowOptions row;
    std::uint64_t maxEdgesBytes = std::uint64_t{8} << 30; ///< larger indexes of edges are predicted, not built
    std::uint64_t peerBytes = std::uint64_t{4} << 30; ///< larger volumes are not given to the peer
    std::uint64_t memoryBytes = std::uint64_t{512} << 20; ///< the builds' budget
    std::filesystem::path folder = std::filesystem::temp_directory_path() / "isoslider_bench";
    bool keepsFiles = false;
    bool isCold = false, measuresAhead = false;
    int pauseMs = 30; ///< after each step where reading ahead is measured
};

/// Builds each kind of index of a volume, in a separate process from a headerless file, probes what
/// opening and exploring take, and slides on all of them in turn. While builds and probes run no samples are
/// held here. States on the error stream how far it is. Errors: those of writing, building and sliding.
Result<TradeReport> measureTrade(BenchVolume volume, const TradeOptions& options);

} // namespace isoslider::bench
