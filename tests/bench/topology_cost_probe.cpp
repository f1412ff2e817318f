// The analysis of a volume's topology from its index, which it is added to, in a separate process: time and memory.
// usage: topology_cost_probe INDEX THREADS
// Prints: seconds processor_seconds empty_bytes peak_bytes events

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "core/topology/index_topology.h"
#include "core/topology/topology_summary.h"
#include "tests/bench/timing.h"

using namespace isoslider;
using namespace isoslider::bench;

int main(int argc, char** argv) {
    if (argc != 3)
        return 2;
    const std::uint64_t empty = residentBytes();
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(std::max(1, std::atoi(argv[2]))));
    const double start = nowMs(), startProcessor = processorSeconds();
    const auto found = topology::topologyOfIndex(argv[1], {}, {});
    const double seconds = 1e-3 * (nowMs() - start), ofProcessors = processorSeconds() - startProcessor;
    if (!found.isOk() || !found.value().storing.isOk() || !found.value().isNew) {
        fmt::print(stderr, "topology_cost_probe: {}\n",
                   !found.isOk()                   ? found.error().line()
                   : !found.value().storing.isOk() ? found.value().storing.error().line()
                                                   : "the index has its topology already");
        return 4;
    }
    fmt::print("{} {} {} {} {}\n", seconds, ofProcessors, empty, peakResidentBytes(),
               found.value().summary->eventCount());
    return 0;
}
