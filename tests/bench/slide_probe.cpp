// Memory and opening time of the product in a process of its own: nothing else is in the way.
// usage: slide_probe INDEX THREADS ISOVALUE...   The first isovalue is the first surface, the others are a slide.
// Prints: open_ms first_ms empty_bytes first_bytes slide_bytes peak_bytes first_edges most_edges

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "core/extract/slide_engine.h"
#include "tests/bench/timing.h"

using namespace isoslider;
using namespace isoslider::bench;

int main(int argc, char** argv) {
    if (argc < 4)
        return 2;
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(std::max(1, std::atoi(argv[2]))));
    const std::uint64_t empty = residentBytes();
    const double start = nowMs();
    auto engine = extract::SlideEngine::open(argv[1]);
    if (!engine.isOk()) {
        fmt::print(stderr, "slide_probe: {}\n", engine.error().line());
        return 4;
    }
    const double openMs = nowMs() - start;
    double firstMs = 0.0;
    std::uint64_t firstBytes = 0, firstEdges = 0, mostEdges = 0;
    for (int i = 3; i < argc; ++i) {
        const auto step = engine.value()->slideTo(std::strtod(argv[i], nullptr));
        if (!step.isOk()) {
            fmt::print(stderr, "slide_probe: {}\n", step.error().line());
            return 4;
        }
        mostEdges = std::max(mostEdges, step.value().activeEdges);
        if (i == 3) {
            firstMs = nowMs() - start;
            firstBytes = residentBytes();
            firstEdges = step.value().activeEdges;
        }
    }
    fmt::print("{} {} {} {} {} {} {} {}\n", openMs, firstMs, empty, firstBytes, residentBytes(), peakResidentBytes(), firstEdges,
               mostEdges);
    return 0;
}
