// Slides: the product, the fastest peer and a copy of the same bytes, in turn. See README.md.

#include <cstdio>
#include <fstream>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include "tests/bench/report.h"

using namespace isoslider;
using namespace isoslider::bench;

namespace {

struct Options {
    std::vector<std::string> volumes{"shell256", "ml256", "noise256", "bluntfin"};
    std::vector<double> percents{0.01, 0.1, 1, 2, 5, 10, 37};
    RowOptions row;
    std::filesystem::path folder = std::filesystem::temp_directory_path() / "isoslider_bench";
    std::filesystem::path csv;
    index::IndexKind kind = index::IndexKind::Metacells; // what builds make unless told otherwise
    bool reusesIndex = false;
    bool withoutPeer = false;
};

Result<VolumeReport> runVolume(const std::string& spec, const Options& options, std::ofstream& csv) {
    const NoiseWitness noise;
    VolumeReport report;
    auto volume = loadWorkload(spec, ISOSLIDER_RESOURCES_DIR);
    if (!volume.isOk())
        return std::move(volume).error();
    report.volume = std::move(volume).value();
    auto index = prepareIndex(report.volume, {options.folder, options.kind, options.reusesIndex, options.row.threads});
    if (!index.isOk())
        return std::move(index).error();
    report.index = std::move(index).value();
    ProbeRequest request;
    request.index = report.index.path;
    request.threads = options.row.threads;
    request.isovalues = slide(report.volume, 1.0, options.row.steps);
    for (ProbeResult* result : {&report.probe, &report.probeWithoutCache}) {
        auto probed = probeSlide(request);
        if (!probed.isOk())
            return std::move(probed).error();
        *result = probed.value();
        request.cacheBytes = 0;
    }
    auto picture = firstPictureSeconds(report.volume, options.folder);
    if (!picture.isOk())
        return std::move(picture).error();
    report.firstPictureSeconds = picture.value();
    printVolume(report);
    printRowHeading();
    const std::uint64_t baseBytes = residentBytes();
    std::vector<Contestant> contestants{
        contestantOnIndex("isoslider", report.index.path),
        contestantOnIndex("isoslider, V+N", report.index.path, {.readsAhead = false, .keepsGroups = true})};
    contestants.back().makesArrays = true;
    for (const double percent : options.percents) {
        RowOptions rowOptions = options.row;
        rowOptions.percent = percent;
        auto row = measureRow(report.volume, contestants, rowOptions);
        if (!row.isOk())
            return std::move(row).error();
        printRow(row.value());
        if (csv.is_open()) {
            csv << productCsv(row.value(), report, options.row.threads) << '\n';
            if (row.value().peer)
                csv << peerCsv(row.value(), options.row.threads, baseBytes) << '\n';
            csv.flush();
        }
        report.rows.push_back(std::move(row).value());
    }
    report.othersBusy = noise.othersBusy();
    report.volume.grid.reset(); // one volume in memory at a time
    return report;
}

void addOptions(CLI::App& app, Options& options) {
    app.add_option("--volumes", options.volumes,
                   "shellN, mlN, noiseN, whiteN, bluntfin, PATH or PATH:nx:ny:nz:TYPE[:skip]")
        ->delimiter(',');
    app.add_option("--pct", options.percents, "step sizes, % of the range")->delimiter(',');
    app.add_option("--steps", options.row.steps, "steps per slide")->check(CLI::Range(1, 10000));
    app.add_option("--threads", options.row.threads, "threads of every contestant")->check(CLI::Range(1, 1024));
    app.add_option("--folder", options.folder, "where indexes are kept");
    app.add_option("--csv", options.csv, "append a row per volume and step size to this file");
    app.add_option("--peer-backend", options.row.peerBackend, "threads of the peer: STDThread, TBB or Sequential");
    const std::map<std::string, index::IndexKind> kinds{{"edges", index::IndexKind::Edges},
                                                        {"metacells", index::IndexKind::Metacells}};
    app.add_option("--index", options.kind, "kind of index: edges or metacells")
        ->transform(CLI::CheckedTransformer(kinds));
    app.add_flag_callback(
        "--cold", [&options] { options.row.caches = CacheState::Empty; },
        "nothing of the index in memory at the start of a step");
    app.add_flag("--again", options.row.isSecondSlide, "measure where the product has slid there and back before");
    app.add_flag("--baseline", options.row.withBaseline, "the paper's flat layout beside the product");
    app.add_flag("--no-peer", options.withoutPeer, "the product alone");
    app.add_flag("--reuse-index", options.reusesIndex, "take the index of an earlier run");
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Times slides of the product and of its fastest peer in turn");
    addOptions(app, options);
    CLI11_PARSE(app, argc, argv);
    if (options.row.withBaseline && options.kind != index::IndexKind::Edges) {
        fmt::print(stderr, "slide_bench: the paper's flat layout wants an index of edges\n");
        return 2;
    }
    options.row.withPeer = hasPeer() && !options.withoutPeer;
    if (!hasPeer())
        fmt::print("built without VTK: no peer\n");
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(options.row.threads));
    std::filesystem::create_directories(options.folder);
    std::ofstream csv;
    if (!options.csv.empty())
        csv.open(options.csv, std::ios::app);
    if (!options.csv.empty() && !csv) {
        fmt::print(stderr, "slide_bench: {}: cannot write\n", options.csv.string());
        return 4;
    }
    std::vector<VolumeReport> reports;
    int disagreements = 0;
    for (const std::string& spec : options.volumes) {
        auto report = runVolume(spec, options, csv);
        if (!report.isOk()) {
            fmt::print(stderr, "slide_bench: {}\n", report.error().line());
            return 4;
        }
        for (const SlideRow& row : report.value().rows)
            disagreements += row.disagreements;
        reports.push_back(std::move(report).value());
    }
    printSummary(reports, options.row.caches == CacheState::Empty);
    return disagreements == 0 ? 0 : 1;
}
