// Memory and opening time of the product in a separate process: nothing else is in the way.
// usage: slide_probe INDEX THREADS CACHE_BYTES ISOVALUE...
//        slide_probe --memory VOLUME NX NY NZ TYPE THREADS CACHE_BYTES ISOVALUE...
// The first isovalue is the first surface, the others are a slide. CACHE_BYTES -1: as the product has by
// default. With --memory a headerless file is read and slid on without an index; CACHE_BYTES means nothing.
// Prints: open_ms first_ms empty_bytes first_bytes slide_bytes peak_bytes first_edges most_edges

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/bench/timing.h"
#include "tests/bench/volume_file.h"

using namespace isoslider;
using namespace isoslider::bench;

namespace {

Result<std::unique_ptr<extract::SlideEngine>> openInMemory(std::span<char* const> arguments) {
    const auto file = volumeFileFromArguments(arguments);
    if (!file.isOk())
        return file.error();
    auto grid = io::readVolume(file.value().path, file.value().readOptions());
    if (!grid.isOk())
        return std::move(grid).error();
    return preprocess::makeMemoryEngine(std::move(grid).value());
}

} // namespace

int main(int argc, char** argv) {
    const bool isInMemory = argc > 1 && std::string_view(argv[1]) == "--memory";
    const int afterSource = isInMemory ? 7 : 2;
    const int first = afterSource + 2; // argument that is the first isovalue
    if (argc <= first)
        return 2;
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(std::max(1, std::atoi(argv[afterSource]))));
    extract::SlideOptions options;
    if (const long long bytes = std::atoll(argv[afterSource + 1]); bytes >= 0)
        options.cacheBytes = static_cast<std::uint64_t>(bytes);
    options.readsAhead = false;
    const std::uint64_t empty = residentBytes();
    const double start = nowMs();
    auto engine = isInMemory ? openInMemory({argv + 2, 5}) : extract::SlideEngine::open(argv[1], options);
    if (!engine.isOk()) {
        fmt::print(stderr, "slide_probe: {}\n", engine.error().line());
        return 4;
    }
    const double openMs = nowMs() - start;
    double firstMs = 0.0;
    std::uint64_t firstBytes = 0, firstEdges = 0, mostEdges = 0;
    for (int i = first; i < argc; ++i) {
        const auto step = engine.value()->slideTo(std::strtod(argv[i], nullptr));
        if (!step.isOk()) {
            fmt::print(stderr, "slide_probe: {}\n", step.error().line());
            return 4;
        }
        mostEdges = std::max(mostEdges, step.value().activeEdges);
        if (i == first) {
            firstMs = nowMs() - start;
            firstBytes = residentBytes();
            firstEdges = step.value().activeEdges;
        }
    }
    fmt::print("{} {} {} {} {} {} {} {}\n", openMs, firstMs, empty, firstBytes, residentBytes(), peakResidentBytes(),
               firstEdges, mostEdges);
    return 0;
}
