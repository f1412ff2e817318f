// What the kinds of index cost and what they give, beside a volume in memory and the peer. See README.md.

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include "tests/bench/trade.h"

using namespace isoslider;
using namespace isoslider::bench;

namespace {

struct Options {
    std::vector<std::string> volumes{"cranium", "jmjd2da", "bluntfin", "noise256", "shell512", "shell1024"};
    TradeOptions trade;
    std::filesystem::path csv, markdown;
};

void addOptions(CLI::App& app, Options& options) {
    const CLI::AsSizeValue sizes(false);
    TradeOptions& trade = options.trade;
    app.add_option("--volumes", options.volumes,
                   "shellN, mlN, noiseN, whiteN, bluntfin, cranium, jmjd2da, PATH or PATH:nx:ny:nz:TYPE[:skip]")
        ->delimiter(',');
    app.add_option("--kinds", trade.kinds, "ways to slide: edges, metacells, memory")
        ->delimiter(',')
        ->check(CLI::IsMember({"edges", "metacells", "memory"}));
    app.add_option("--pct", trade.percents, "step sizes, % of the range")->delimiter(',');
    app.add_option("--steps", trade.row.steps, "steps per slide")->check(CLI::Range(1, 10000));
    app.add_option("--threads", trade.row.threads, "threads of every contestant")->check(CLI::Range(1, 1024));
    app.add_option("--cache", trade.caches, "bounds on what is kept of an index, one contestant each")
        ->delimiter(',')
        ->transform(sizes);
    app.add_option("--memory", trade.memoryBytes, "memory that a build may use")->transform(sizes);
    app.add_option("--max-edges-bytes", trade.maxEdgesBytes, "larger indexes of edges are predicted, not built")
        ->transform(sizes);
    app.add_option("--peer-bytes", trade.peerBytes, "volumes larger than this are not given to the peer")
        ->transform(sizes);
    app.add_flag("--cold", trade.isCold, "steps with nothing of the index in memory, in columns of their own");
    app.add_flag("--ahead", trade.measuresAhead, "steps with reading ahead, without the peer");
    app.add_option("--pause", trade.pauseMs, "ms after each step of --ahead")->check(CLI::Range(0, 10000));
    app.add_flag_callback(
        "--no-peer", [&trade] { trade.row.withPeer = false; }, "the product alone");
    app.add_option("--folder", trade.folder, "where volumes and indexes are written");
    app.add_flag("--keep", trade.keepsFiles, "leave them there");
    app.add_option("--csv", options.csv, "append rows to this file");
    app.add_option("--markdown", options.markdown, "write the tables to this file");
}

// False where the volume is one of those that need not be there.
Result<bool> runVolume(const std::string& spec, const Options& options, std::vector<TradeReport>& reports) {
    fmt::print(stderr, "trade_bench: {}: loading\n", spec);
    auto volume = loadWorkload(spec, ISOSLIDER_RESOURCES_DIR);
    if (!volume.isOk() && volume.error().code == ErrorCode::NotFound && isFurtherVolume(spec))
        return false;
    if (!volume.isOk())
        return std::move(volume).error();
    auto report = measureTrade(std::move(volume).value(), options.trade);
    if (!report.isOk())
        return std::move(report).error();
    reports.push_back(std::move(report).value());
    return true;
}

// Rewritten after each volume: a long run that is broken off has left what it measured.
bool writeMarkdown(const Options& options, const std::string& text) {
    std::ofstream file(options.markdown);
    file << text;
    return options.markdown.empty() || file.flush();
}

bool appendCsv(const Options& options, const TradeReport& report) {
    if (options.csv.empty())
        return true;
    const bool isNew = !std::filesystem::exists(options.csv) || std::filesystem::file_size(options.csv) == 0;
    std::ofstream file(options.csv, std::ios::app);
    file << (isNew ? tradeCsvHeading() : "") << tradeCsv(report, options.trade.row.threads);
    return static_cast<bool>(file.flush());
}

int runAll(const Options& options) {
    std::vector<TradeReport> reports;
    std::string markdown = fmt::format("## Trade between kinds of index\n\n{} threads, {} steps a slide.\n",
                                       options.trade.row.threads, options.trade.row.steps);
    for (const std::string& spec : options.volumes) {
        const auto done = runVolume(spec, options, reports);
        if (!done.isOk()) {
            fmt::print(stderr, "trade_bench: {}\n", done.error().line());
            return 4;
        }
        if (!done.value()) {
            fmt::print("\n{}: not there, left out\n", spec);
            continue;
        }
        fmt::print("{}", describe(reports.back(), TextForm::Plain));
        std::fflush(stdout);
        markdown += describe(reports.back(), TextForm::Markdown);
        if (!writeMarkdown(options, markdown) || !appendCsv(options, reports.back())) {
            fmt::print(stderr, "trade_bench: cannot write what was measured\n");
            return 4;
        }
    }
    fmt::print("{}", summarise(reports, TextForm::Plain));
    if (!writeMarkdown(options, markdown + summarise(reports, TextForm::Markdown)))
        return 4;
    const bool agree = std::all_of(reports.begin(), reports.end(), [](const TradeReport& r) { return r.agrees(); });
    return agree ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("What the kinds of index cost and what they give, beside a volume in memory and the peer");
    addOptions(app, options);
    CLI11_PARSE(app, argc, argv);
    if (!hasPeer())
        fmt::print("built without VTK: no peer\n");
    options.trade.row.withPeer = hasPeer() && options.trade.row.withPeer;
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(options.trade.row.threads));
    std::filesystem::create_directories(options.trade.folder);
    return runAll(options);
}
