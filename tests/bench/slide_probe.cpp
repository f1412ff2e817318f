// Memory and opening time of the product in a process of its own: nothing else is in the way.
// usage: slide_probe INDEX THREADS CACHE_BYTES ISOVALUE...
// The first isovalue is the first surface, the others are a slide. CACHE_BYTES -1: as the product has by
// default. Prints: open_ms first_ms empty_bytes first_bytes slide_bytes peak_bytes first_edges most_edges

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "core/extract/slide_engine.h"
#include "tests/bench/timing.h"

using namespace isoslider;
using namespace isoslider::bench;

constexpr int kFirst = 4; // argument that is the first isovalue

int main(int argc, char** argv) {
    if (argc < 5)
        return 2;
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(std::max(1, std::atoi(argv[2]))));
    extract::SlideOptions options;
    if (const long long bytes = std::atoll(argv[3]); bytes >= 0)
        options.cacheBytes = static_cast<std::uint64_t>(bytes);
    const std::uint64_t empty = residentBytes();
    const double start = nowMs();
    auto engine = extract::SlideEngine::open(argv[1], options);
    if (!engine.isOk()) {
        fmt::print(stderr, "slide_probe: {}\n", engine.error().line());
        return 4;
    }
    const double openMs = nowMs() - start;
    double firstMs = 0.0;
    std::uint64_t firstBytes = 0, firstEdges = 0, mostEdges = 0;
    for (int i = kFirst; i < argc; ++i) {
        const auto step = engine.value()->slideTo(std::strtod(argv[i], nullptr));
        if (!step.isOk()) {
            fmt::print(stderr, "slide_probe: {}\n", step.error().line());
            return 4;
        }
        mostEdges = std::max(mostEdges, step.value().activeEdges);
        if (i == kFirst) {
            firstMs = nowMs() - start;
            firstBytes = residentBytes();
            firstEdges = step.value().activeEdges;
        }
    }
    fmt::print("{} {} {} {} {} {} {} {}\n", openMs, firstMs, empty, firstBytes, residentBytes(),
               peakResidentBytes(), firstEdges, mostEdges);
    return 0;
}
