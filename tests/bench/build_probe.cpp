// A build of an index from a headerless file, in a separate process: its time and its memory.
// usage: build_probe VOLUME NX NY NZ TYPE INDEX KIND THREADS MEMORY_BYTES
// Prints: seconds empty_bytes peak_bytes

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "preprocess/build_index.h"
#include "tests/bench/timing.h"
#include "tests/bench/volume_file.h"

using namespace isoslider;
using namespace isoslider::bench;

namespace {

Result<double> buildSeconds(std::span<char* const> arguments) {
    const auto file = volumeFileFromArguments(arguments.first(5));
    if (!file.isOk())
        return file.error();
    std::optional<index::IndexKind> kind;
    for (const index::IndexKind each : {index::IndexKind::Edges, index::IndexKind::Metacells})
        if (std::string_view(arguments[6]) == index::indexKindName(each))
            kind = each;
    if (!kind)
        return makeError(ErrorCode::InvalidArgument, "no such kind of index", arguments[6]);
    preprocess::BuildOptions options;
    options.kind = *kind;
    options.threads = std::max(1, std::atoi(arguments[7]));
    options.memoryBytes = std::strtoull(arguments[8], nullptr, 10);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(options.threads));
    const double start = nowMs();
    auto source = io::openVolume(file.value().path, file.value().readOptions());
    if (!source.isOk())
        return std::move(source).error();
    const auto report = preprocess::buildIndex(*source.value(), arguments[5], options);
    if (!report.isOk())
        return report.error();
    return 1e-3 * (nowMs() - start);
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 10)
        return 2;
    const std::uint64_t empty = residentBytes();
    const auto seconds = buildSeconds({argv + 1, 9});
    if (!seconds.isOk()) {
        fmt::print(stderr, "build_probe: {}\n", seconds.error().line());
        return 4;
    }
    fmt::print("{} {} {}\n", seconds.value(), empty, peakResidentBytes());
    return 0;
}
