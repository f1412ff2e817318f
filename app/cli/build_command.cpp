#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/task_arena.h>

#include "app/cli/command.h"
#include "app/cli/escaped_name.h"
#include "app/cli/input_kind.h"
#include "app/cli/level_json.h"
#include "app/cli/number_parsing.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "app/cli/resampling_report.h"
#include "app/cli/standard_input.h"
#include "app/cli/volume_options_check.h"
#include "core/base/machine.h"
#include "core/base/memory_limit.h"
#include "core/base/plain_text.h"
#include "core/base/process_memory.h"
#include "core/index/format/index_format.h"
#include "core/topology/index_topology.h"
#include "core/topology/stored_topology.h"
#include "preprocess/build_index.h"
#include "preprocess/resume/build_checkpoints.h"

namespace isoslider::cli {
namespace {

constexpr std::int64_t kMaxThreads = 1024;

std::uint64_t memoryOrThrow(const std::string& text) {
    const auto bytes = parseSizeBytes(text);
    const std::string least = "at least " + sizeText(preprocess::kMinBuildMemoryBytes);
    if (!bytes)
        throw CLI::ValidationError("--memory",
                                   fmt::format("'{}' is not a size; give one as 512M or 2G, {}", text, least));
    if (*bytes < preprocess::kMinBuildMemoryBytes)
        throw CLI::ValidationError("--memory", fmt::format("'{}' is too little; give {}", text, least));
    return *bytes;
}

/// None: the program chooses.
std::optional<index::IndexKind> kindOrThrow(const std::string& text) {
    for (const index::IndexKind kind : {index::IndexKind::Edges, index::IndexKind::Metacells})
        if (text == index::indexKindName(kind))
            return kind;
    if (text != "auto")
        throw CLI::ValidationError("--index",
                                   fmt::format("'{}' is not a kind of index; known: edges, metacells, auto", text));
    return std::nullopt;
}

/// What is wrong with a number, for CLI11; text that is no number is refused elsewhere.
std::string isAboveZero(const std::string& text) {
    const auto value = parseFinite(text);
    return value && *value <= 0.0 ? fmt::format("'{}' is not above zero", text) : std::string();
}

std::string isNotNegative(const std::string& text) {
    const auto value = parseFinite(text);
    return value && *value < 0.0 ? fmt::format("'{}' is below zero", text) : std::string();
}

/// An index, and the volume that it is of.
struct Built {
    preprocess::BuildReport report;
    io::VolumeInfo volume;
    std::uint64_t events = 0; ///< of topology
    std::uint64_t topologyBytes = 0; ///< behind the index in its file
    double topologySeconds = 0.0;
    bool hasEvents = true; ///< else counts and curves only
    std::string scratchProblem; ///< why the analysis did without a temporary file; empty: it had one, or needed none
    std::string topologyProblem; ///< why the index has none; empty: it has, or it was not wanted
};

Json jsonOf(const Built& built) {
    const preprocess::BuildReport& report = built.report;
    Json json;
    json["seconds"] = report.seconds;
    json["peak_rss_bytes"] = report.peakRssBytes;
    json["forecast_bytes"] = report.forecast.indexBytes;
    json["index_bytes"] = report.info.indexBytes;
    json["forecast_topology_bytes"] = report.forecast.topologyBytes;
    json["forecast_temporary_bytes"] = report.forecast.temporaryBytes;
    json["temporary_bytes"] = report.temporaryBytes;
    json["distinct_values"] = report.info.distinctValues;
    json["levels"] = levelsJson(report.info);
    json["kind"] = index::indexKindName(report.info.kind);
    json["resumed"] = report.isResumed;
    if (!built.scratchProblem.empty())
        json["topology_scratch_problem"] = built.scratchProblem;
    if (!built.topologyProblem.empty()) {
        json["topology_problem"] = built.topologyProblem;
    } else if (built.topologySeconds > 0.0) {
        json["topology_events"] = built.hasEvents ? Json(built.events) : Json();
        json["topology_bytes"] = built.topologyBytes;
        json["topology_seconds"] = built.topologySeconds;
    }
    addResampling(built.volume, json);
    return json;
}

class BuildCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("build", "Build the index of a volume, for sliding");
        addInput(*command, "VOLUME", volumePath_, "volume to index; - for standard input");
        auto* output = command->add_option("-o,--output", indexPath_, "index to write")->required();
        requireName(output->type_name("INDEX.isx"), "the output");
        addIndexOptions(*command);
        addMachineOptions(*command);
        addVolumeOptions(*command, volume_);
        standardInput_.declare(*command, volumePath_, InputContent::Volume);
        return command;
    }

    Outcome run(Session& session) override {
        if (lodError_.merges() && kind_ == index::IndexKind::Metacells)
            return Outcome::wrongUsage(
                "--lod-error: metacells are merged while sliding; give it to slide or extract, or build --index edges");
        if (indexPath_ == "-")
            return Outcome::wrongUsage(
                "-o -: an index is written to and fro, which standard output cannot; give a file");
        if (volumePath_ == "-" && resumes_)
            return Outcome::wrongUsage("build - --resume: standard input cannot be read again; save it to a file");
        if (volumePath_ == "-") { // kept where the build keeps its temporary files: beside the index
            ISO_CLI_TRY(checkOutput(indexPath_, ""));
            ISO_CLI_TRY(standardInput_.fetch(session, volume_, std::filesystem::path(indexPath_).parent_path()));
        }
        const auto kind = sniffInput(volumePath_, volume_.readOptions());
        if (!kind.isOk())
            return kind.error();
        if (kind.value() == InputKind::Index)
            return makeError(ErrorCode::InvalidArgument, "is an index; build needs a volume", volumePath_);
        ISO_CLI_TRY(checkOutput(indexPath_, volumePath_));
        ProgressBar bar(session.showsProgress, session.stop);
        io::ReadOptions reading = volume_.readOptions();
        reading.memoryBytes = memoryBytes_ / 2;
        ISO_CLI_TRY(checkResampling(reading, volumePath_, bar.job()));
        auto source = io::openVolume(volumePath_, reading, bar.job());
        if (!source.isOk()) {
            bar.wipe();
            return source.error();
        }
        ISO_CLI_TRY(checkNotRead(indexPath_, volumePath_, source.value()->info()));
        const bool isUnfinished = preprocess::hasCheckpoint(indexPath_);
        if (!isUnfinished || !resumes_) // which empties what is unfinished
            ISO_CLI_TRY(tryOutput(indexPath_));
        if (isUnfinished && !resumes_ && !session.isQuiet) {
            bar.wipe();
            const Error note =
                makeError(ErrorCode::InvalidArgument,
                          "an unfinished build is replaced; --resume would have gone on with it", indexPath_);
            std::fputs(("isoslider-cli: " + note.line() + "\n").c_str(), stderr);
        }
        const JobControl all = bar.job();
        const JobControl building = withTopology_ ? all.part(0.0, 0.5) : all, analysing = all.part(0.5, 1.0);
        auto report = build(*source.value(), building);
        if (report.isOk() && withTopology_) {
            Status added = addTopology(*source.value(), report.value(), analysing);
            if (!added.isCancelled() || !resumes_)
                preprocess::forgetCompletedBuild(indexPath_);
            if (added.isCancelled()) {
                bar.wipe();
                return {ExitCode::Interrupted,
                        fmt::format("interrupted; '{}' is whole, but has no topology", indexPath_)};
            }
            if (!added.isOk())
                report = std::move(added).error();
        }
        bar.wipe();
        if (!report.isOk())
            return report.error();
        source.value().reset(); // and its reader ends
        report.value().report.peakRssBytes = peakRssBytes() + peakRssOfHelpersBytes();
        if (session.isJson)
            session.output.writeJson(jsonOf(report.value()));
        else
            session.output.write(textOf(report.value()));
        return {};
    }

private:
    void addIndexOptions(CLI::App& command) {
        addInteger(command, "--skip-levels", skipLevels_, 1, index::kMaxSkipLevels,
                   fmt::format("levels written, 1 to {} ({})", index::kMaxSkipLevels, skipLevels_));
        addNumber(command, "--redundancy", redundancy_,
                  fmt::format("a block ends when its redundant entries exceed this many times its others "
                              "(edges: 0.5 to 4, the smallest that keeps the index below {} bytes per voxel; "
                              "metacells: 1)",
                              preprocess::kBytesPerVoxelAim))
            ->check(isAboveZero);
        command
            .add_option_function<std::string>(
                "--index", [this](const std::string& text) { kind_ = kindOrThrow(text); },
                "metacells: smaller than the volume as a rule; edges: the paper's, 2 to 12 bytes per voxel; auto: metacells, or edges with --lod-error (auto)")
            ->type_name("KIND");
        addLodError(command, lodError_,
                    "edges: merge cells that differ by no more: % of the value range, or c (cells)");
    }

    void addMachineOptions(CLI::App& command) {
        command
            .add_option_function<std::string>(
                "--memory", [this](const std::string& text) { memoryBytes_ = memoryOrThrow(text); },
                fmt::format("memory to keep within, as 512M or 2G (a quarter of this machine's: {})",
                            sizeText(memoryBytes_)))
            ->type_name("SIZE");
        command.add_flag_callback(
            "--no-topology", [this] { withTopology_ = false; },
            "leave out events, counts and curves: topology then analyses the volume");
        addInteger(command, "--threads", threads_, 1, kMaxThreads,
                   "threads to use, as far as there are cores (all cores)");
        command.add_flag("--resume", resumes_,
                         "go on with an unfinished build of this index, and leave one if this is interrupted");
        addNumber(command, "--checkpoint", checkpointSeconds_,
                  fmt::format("seconds between two states that --resume can go on from ({:.0f})",
                              preprocess::BuildOptions{}.checkpointSeconds))
            ->check(isNotNegative);
    }

    Result<Built> build(io::VolumeSource& source, const JobControl& job) {
        preprocess::BuildOptions options;
        // Metacells slide as fast, are built sooner and are smaller; only edges hold merged cells.
        options.kind = kind_.value_or(lodError_.merges() ? index::IndexKind::Edges : index::IndexKind::Metacells);
        options.mergeError = lodError_.error;
        options.skipLevels = static_cast<int>(skipLevels_);
        options.redundancyThreshold = redundancy_.value_or(options.redundancyThreshold);
        options.memoryBytes = memoryBytes_;
        returnLargeBlocksAtOnce();
        options.threads = static_cast<int>(threads_);
        options.withTopology = withTopology_;
        options.leavesTopology = withTopology_;
        options.resumes = resumes_;
        options.checkpointSeconds = checkpointSeconds_.value_or(options.checkpointSeconds);
        options.sourceName = std::filesystem::path(volumePath_).filename().string();
        auto report = preprocess::buildIndex(source, indexPath_, options, job);
        if (!report.isOk())
            return std::move(report).error();
        report.value().forecast.temporaryBytes += standardInput_.bytes();
        report.value().temporaryBytes += standardInput_.bytes();
        return Built{std::move(report).value(), source.info()};
    }

    Result<topology::TopologyCurve> analysed(const topology::PlaneSource& planes,
                                             const topology::AnalysisOptions& options, const JobControl& job) const {
        const int cores = tbb::this_task_arena::max_concurrency(); // more threads would make TBB complain
        tbb::task_arena arena(threads_ > 0 ? std::min(static_cast<int>(threads_), cores) : cores);
        try {
            return arena.execute([&] { return topology::analyseTopology(planes, options, job); });
        } catch (const std::bad_alloc&) {
            return makeError(ErrorCode::OutOfSpace, "out of memory");
        }
    }

    // The index is there, and stays. That its volume is too large for an analysis is no failure of the build.
    Status addTopology(io::VolumeSource& source, Built& built, const JobControl& job) {
        const auto start = std::chrono::steady_clock::now();
        const Status status = tryTopology(source, built, job);
        if (!status.isOk()) {
            Error error = status.error();
            error.path = indexPath_;
            error.message += "; the index is complete, without topology";
            return error;
        }
        built.topologySeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return {};
    }

    Status tryTopology(io::VolumeSource& source, Built& built, const JobControl& job) const {
        if (built.report.isResumed) // it may have been killed at its very end
            if (const auto there = topology::openTopology(indexPath_); there.isOk() && there.value()) {
                noteTopology(there.value()->hasEvents(), there.value()->eventCount(), built);
                return {};
            }
        const auto reader = index::IndexReader::open(indexPath_);
        if (!reader.isOk())
            return reader.error();
        topology::AnalysisOptions options;
        options.memoryBytes = memoryLeft();
        options.scratch = topology::scratchPathOf(indexPath_);
        options.scratchProblem = &built.scratchProblem;
        const topology::PlaneSource planes =
            topology::planesOf(*reader.value()); // decoded faster than most files are read
        const index::IndexInfo& info = reader.value()->info();
        auto plan = topology::planMeasures(planes, info.min, info.max, job);
        if (!plan.isOk())
            return std::move(plan).error();
        options.measures = std::move(plan).value();
        const auto curve = analysed(planes, options, job);
        if (!curve.isOk() && curve.error().code == ErrorCode::OutOfSpace) { // memory
            built.topologyProblem = curve.error().message + "; " + kOtherWay;
            return {};
        }
        if (!curve.isOk())
            return curve.error();
        ISO_TRY(source.checkUnchanged());
        ISO_TRY(topology::storeTopology(*reader.value(), curve.value()));
        noteTopology(curve.value().hasEvents(), curve.value().eventCount(), built);
        return {};
    }

    void noteTopology(bool hasEvents, std::uint64_t events, Built& built) const {
        built.hasEvents = hasEvents;
        built.events = events;
        const auto file = defaultFileSystem().openForReading(indexPath_);
        if (file.isOk())
            built.topologyBytes = file.value()->sizeBytes() - built.report.info.indexBytes;
    }

    // The program itself is beside the budget, what the build left in memory is not.
    std::uint64_t memoryLeft() const {
        constexpr std::uint64_t kProgramBytes = std::uint64_t{64} << 20;
        returnFreeBlocks();
        const std::uint64_t resident = std::max(residentBytes(), kProgramBytes);
        return memoryBytes_ + kProgramBytes - std::min(resident, memoryBytes_ + kProgramBytes);
    }
    static constexpr const char* kOtherWay =
        "\"isoslider-cli topology INDEX\" adds what is missing, where there is enough, or a build with more --memory";

    std::string textOf(const Built& built) const {
        const preprocess::BuildReport& report = built.report;
        std::string text = fmt::format("{}: {} in {:.2f} s, peak memory {}{}\n", escapedName(indexPath_),
                                       sizeText(report.info.indexBytes), report.seconds, sizeText(report.peakRssBytes),
                                       report.isResumed ? ", of which a part was there" : "");
        text += fmt::format("forecast: {}, {} of topology, and up to {} of temporary files, of which {} were used\n",
                            sizeText(report.forecast.indexBytes), sizeText(report.forecast.topologyBytes),
                            sizeText(report.forecast.temporaryBytes), sizeText(report.temporaryBytes));
        text += fmt::format("{}, {}, {}\n", index::indexKindName(report.info.kind),
                            counted(report.info.distinctValues, "distinct value"),
                            counted(report.info.levels.size(), "skip level"));
        if (!built.topologyProblem.empty())
            text += fmt::format("without topology: {}\n", built.topologyProblem);
        else if (withTopology_ && !built.hasEvents)
            text += fmt::format("topology without events and persistence, which take more memory: counts at {} "
                                "and curves in {:.2f} s; {}{}\n",
                                counted(built.events, "isovalue"), built.topologySeconds, kOtherWay,
                                built.scratchProblem.empty() ? "" : "; no temporary file: " + built.scratchProblem);
        else if (withTopology_)
            text += fmt::format("{} of topology in {:.2f} s, {} behind the index\n", counted(built.events, "event"),
                                built.topologySeconds, sizeText(built.topologyBytes));
        if (const std::string lost = resamplingText(built.volume); !lost.empty())
            text += fmt::format("resampled {}\n", lost);
        return text;
    }

    std::string volumePath_;
    std::string indexPath_;
    VolumeOptions volume_;
    StandardInput standardInput_;
    std::optional<index::IndexKind> kind_;
    LodError lodError_;
    std::int64_t skipLevels_ = preprocess::BuildOptions{}.skipLevels;
    std::optional<double> redundancy_;
    std::uint64_t memoryBytes_ = std::max(preprocess::kMinBuildMemoryBytes, usableMemoryBytes() / 4);
    std::int64_t threads_ = 0;
    bool withTopology_ = true;
    bool resumes_ = false;
    std::optional<double> checkpointSeconds_;
};

} // namespace

std::unique_ptr<Command> makeBuildCommand() { return std::make_unique<BuildCommand>(); }

} // namespace isoslider::cli
