// The paper's flat layout alone: its times per step, and whether it agrees with the product.

#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "core/extract/slide_engine.h"
#include "tests/bench/flat_runner.h"
#include "tests/bench/prepared_index.h"
#include "tests/bench/timing.h"

using namespace isoslider;
using namespace isoslider::bench;

namespace {

struct Options {
    std::vector<std::string> volumes{"shell256", "ml256", "noise256"};
    std::vector<double> percents{0.01, 0.1, 1, 10};
    int steps = 10;
    std::filesystem::path folder = std::filesystem::temp_directory_path() / "isoslider_bench";
    bool reusesIndex = false;
};

// One slide; false where baseline and product disagree.
Result<bool> runSlide(const BenchVolume& volume, const std::filesystem::path& index, double percent, int steps) {
    auto flat = FlatRunner::open(index);
    if (!flat.isOk())
        return std::move(flat).error();
    auto engine = extract::SlideEngine::open(index);
    if (!engine.isOk())
        return std::move(engine).error();
    std::vector<double> updates, interpolations, engineTimes;
    std::uint64_t changed = 0;
    std::uint64_t mostBytes = 0, mostEdges = 1;
    bool agrees = true;
    for (const double isovalue : slide(volume, percent, steps)) {
        const auto flatStep = flat.value()->slideTo(isovalue);
        if (!flatStep.isOk())
            return flatStep.error();
        const auto step = engine.value()->slideTo(isovalue);
        if (!step.isOk())
            return step.error();
        const FlatStep& ours = flatStep.value();
        agrees = agrees && ours.activeEdges == step.value().activeEdges && ours.triangles == step.value().triangles;
        mostBytes = std::max(mostBytes, ours.memoryBytes);
        mostEdges = std::max(mostEdges, ours.activeEdges);
        updates.push_back(ours.updateMs);
        interpolations.push_back(ours.interpolateMs);
        engineTimes.push_back(step.value().updateMs + step.value().interpolateMs);
        if (engineTimes.size() > 1) // the first isovalue is where the surface starts, no step
            changed += step.value().edgesAdded + step.value().edgesRemoved;
    }
    for (auto* times : {&updates, &interpolations, &engineTimes})
        times->erase(times->begin());
    fmt::print(
        "{:<14} {:>6} %  update {:8.2f}  interpolate {:7.2f}  product {:7.2f} ms  {:7.0f} edges changed  {:4.0f} B/edge  {}\n",
        volume.name, percent, spreadOf(updates).median, spreadOf(interpolations).median, spreadOf(engineTimes).median,
        static_cast<double>(changed) / steps, static_cast<double>(mostBytes) / static_cast<double>(mostEdges),
        agrees ? "agrees" : "DISAGREES");
    std::fflush(stdout);
    return agrees;
}

Result<bool> runVolume(const std::string& spec, const Options& options) {
    auto volume = loadWorkload(spec, ISOSLIDER_RESOURCES_DIR);
    if (!volume.isOk())
        return std::move(volume).error();
    auto index = prepareIndex(volume.value(), {options.folder, index::IndexKind::Edges, options.reusesIndex});
    if (!index.isOk())
        return std::move(index).error();
    bool agrees = true;
    for (const double percent : options.percents) {
        const auto slideAgrees = runSlide(volume.value(), index.value().path, percent, options.steps);
        if (!slideAgrees.isOk())
            return slideAgrees.error();
        agrees = agrees && slideAgrees.value();
    }
    return agrees;
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Times the paper's flat layout, one thread, beside the product");
    app.add_option("--volumes", options.volumes,
                   "shellN, mlN, noiseN, whiteN, bluntfin, PATH or PATH:nx:ny:nz:TYPE[:skip]")
        ->delimiter(',');
    app.add_option("--pct", options.percents, "step sizes, % of the range")->delimiter(',');
    app.add_option("--steps", options.steps, "steps per slide")->check(CLI::Range(1, 10000));
    app.add_option("--folder", options.folder, "where indexes are kept");
    app.add_flag("--reuse-index", options.reusesIndex, "take the index of an earlier run");
    CLI11_PARSE(app, argc, argv);
    std::filesystem::create_directories(options.folder);
    bool agrees = true;
    for (const std::string& spec : options.volumes) {
        const auto result = runVolume(spec, options);
        if (!result.isOk()) {
            fmt::print(stderr, "flat_bench: {}\n", result.error().line());
            return 4;
        }
        agrees = agrees && result.value();
    }
    return agrees ? 0 : 1;
}
