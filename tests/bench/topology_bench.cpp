// What the topology of a volume takes, beside the build of its index and a sort of its samples, in turn. See README.md.

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include "tests/bench/prepared_index.h"
#include "tests/bench/probes.h"
#include "tests/bench/timing.h"

using namespace isoslider;
using namespace isoslider::bench;

namespace {

struct Options {
    std::vector<std::string> volumes{"cranium", "jmjd2da", "bluntfin", "noise256", "ct512"};
    int times = 3;
    int threads = 2;
    std::filesystem::path folder = std::filesystem::temp_directory_path() / "isoslider_bench";
};

struct Seconds {
    std::vector<double> index, sort, topology, processor, ratio;
};

Status runVolume(const std::string& spec, const Options& options) {
    const auto volume = loadWorkload(spec, ISOSLIDER_RESOURCES_DIR);
    if (!volume.isOk())
        return volume.error();
    Seconds seconds;
    TopologyProbeResult last;
    for (int i = 0; i < options.times; ++i) {
        const auto index =
            prepareIndex(volume.value(), {options.folder, index::IndexKind::Metacells, false, options.threads});
        if (!index.isOk())
            return index.error();
        const auto probed = probeTopology(index.value().path, options.threads);
        std::filesystem::remove(index.value().path);
        if (!probed.isOk())
            return probed.error();
        last = probed.value();
        seconds.index.push_back(index.value().buildSeconds);
        seconds.sort.push_back(index.value().sortSeconds);
        seconds.topology.push_back(last.seconds);
        seconds.processor.push_back(last.processorSeconds);
        seconds.ratio.push_back(last.seconds / (index.value().buildSeconds + index.value().sortSeconds));
    }
    const auto samples = static_cast<double>(volume.value().points());
    const Spread ratio = spreadOf(seconds.ratio);
    fmt::print(
        "{:<12} {:>8.1f} {:>10} {:>8.2f} {:>8.2f} {:>9.2f} {:>7.2f} {:>5.2f}-{:<5.2f} {:>9.0f} {:>8.0f} {:>8.1f}\n",
        volume.value().name, 1e-6 * samples, last.events, spreadOf(seconds.index).median, spreadOf(seconds.sort).median,
        spreadOf(seconds.topology).median, ratio.median, ratio.min, ratio.max,
        1e9 * spreadOf(seconds.processor).median / samples, 1e-6 * static_cast<double>(last.peakBytes),
        static_cast<double>(last.peakBytes - last.emptyBytes) / samples);
    std::fflush(stdout);
    return {};
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Times the analysis of topology beside index and sort");
    app.add_option("--volumes", options.volumes, "as with slide_bench")->delimiter(',');
    app.add_option("--times", options.times, "how often each is measured")->check(CLI::Range(1, 1000));
    app.add_option("--threads", options.threads, "of index and topology")->check(CLI::Range(1, 1024));
    app.add_option("--folder", options.folder, "where indexes are kept meanwhile");
    CLI11_PARSE(app, argc, argv);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(options.threads));
    std::filesystem::create_directories(options.folder);
    const NoiseWitness noise;
    fmt::print("{:<12} {:>8} {:>10} {:>8} {:>8} {:>9} {:>7} {:>11} {:>9} {:>8} {:>8}\n", "volume", "Msamples", "events",
               "index s", "sort s", "topology", "ratio", "least-most", "ns/sample", "peak MB", "B/sample");
    for (const std::string& spec : options.volumes)
        if (const Status status = runVolume(spec, options); !status.isOk()) {
            if (isFurtherVolume(spec) && status.error().code == ErrorCode::NotFound) {
                fmt::print("{:<12} not there\n", spec);
                continue;
            }
            fmt::print(stderr, "topology_bench: {}\n", status.error().line());
            return 4;
        }
    fmt::print("other programs kept {:.2f} processors busy meanwhile\n", noise.othersBusy());
    return 0;
}
