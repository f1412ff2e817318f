#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/asked_isovalue.h"
#include "app/cli/certified_output.h"
#include "app/cli/command.h"
#include "app/cli/export_pattern.h"
#include "app/cli/number_parsing.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "core/base/machine.h"
#include "core/extract/slide_engine.h"
#include "core/mesh/mesh_export.h"

namespace isoslider::cli {
namespace {

constexpr std::int64_t kMaxSteps = 10'000'000;

std::vector<AskedIsovalue> isovaluesOrThrow(const std::string& text) {
    std::vector<AskedIsovalue> isovalues;
    for (const auto part : splitAt(text, ','))
        isovalues.push_back(isovalueOrThrow("--path", part));
    return isovalues;
}

ExportPattern patternOrThrow(const std::string& text) {
    const auto pattern = ExportPattern::parse(text);
    if (!pattern)
        throw CLI::ValidationError("--export",
                                   fmt::format("'{}' needs exactly one %d or %04d, for the number of the step", text));
    return *pattern;
}

std::string jsonLine(const extract::SlideStats& stats) {
    Json json;
    json["isovalue"] = stats.isovalue;
    json["edges_added"] = stats.edgesAdded;
    json["edges_removed"] = stats.edgesRemoved;
    json["edges_touched"] = stats.edgesTouched;
    json["cells_retriangulated"] = stats.cellsRetriangulated;
    json["active_edges"] = stats.activeEdges;
    json["triangles"] = stats.triangles;
    json["leaves"] = stats.activeLeaves;
    json["bricks_read"] = stats.bricksRead;
    json["bytes_read"] = stats.bytesRead;
    json["update_ms"] = stats.updateMs;
    json["interpolate_ms"] = stats.interpolateMs;
    return jsonText(json);
}

std::string headLine() {
    return fmt::format("{:>6} {:>14} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "step", "isovalue", "added",
                       "removed", "cells", "active", "triangles", "update ms", "interp. ms");
}

std::string textLine(std::size_t step, const extract::SlideStats& stats) {
    return fmt::format("{:>6} {:>14} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10.3f} {:>10.3f}\n", step, stats.isovalue,
                       stats.edgesAdded, stats.edgesRemoved, stats.cellsRetriangulated, stats.activeEdges,
                       stats.triangles, stats.updateMs, stats.interpolateMs);
}

class SlideCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("slide", "Slide through isovalues, one record per step");
        addInput(*command, "INDEX", indexPath_, "index to slide through");
        auto* from = addIsovalue(*command, "--from", askedFrom_, "first isovalue");
        auto* to = addIsovalue(*command, "--to", askedTo_, "last isovalue")->needs(from);
        auto* steps = addInteger(*command, "--steps", steps_, 1, kMaxSteps,
                                 "even steps between them; step 0 builds the first surface");
        from->needs(to)->needs(steps);
        steps->needs(from);
        auto* path = command->add_option_function<std::string>(
            "--path", [this](const std::string& text) { askedPath_ = isovaluesOrThrow(text); },
            "isovalues to visit in turn");
        path->type_name("V1,V2,...")->excludes(from)->excludes(to)->excludes(steps);
        command
            ->add_option_function<std::string>(
                "--export", [this](const std::string& text) { pattern_ = patternOrThrow(text); },
                "mesh of each step, as 'out_%04d.ply'")
            ->type_name("PATTERN");
        addLodError(*command, lodError_, "merge cells that differ by no more: % of the value range, or c (cells)");
        return command;
    }

    Outcome run(Session& session) override {
        if (askedPath_.empty() && !askedFrom_)
            return Outcome::wrongUsage("slide needs --from, --to and --steps, or --path");
        if (indexPath_ == "-")
            return Outcome::wrongUsage(
                "slide -: an index is read to and fro, which standard input cannot; save it to a file");
        ISO_CLI_TRY(checkExports());
        const auto begin = std::chrono::steady_clock::now();
        extract::SlideOptions options;
        options.readsAhead = false; // the next move follows at once
        auto engine = extract::SlideEngine::open(indexPath_, options);
        if (!engine.isOk())
            return engine.error();
        if (lodError_.isGiven()) {
            const index::IndexInfo& info = engine.value()->info();
            const extract::MergeBound bound = extract::boundOf(lodError_.error, info.min, info.max);
            engine.value()->setMergeBound(bound);
        }
        const std::chrono::duration<double, std::milli> openTime = std::chrono::steady_clock::now() - begin;
        if (const Status found = findIsovalues(session); !found.isOk())
            return found.error();
        ISO_CLI_TRY(slide(*engine.value(), session));
        if (session.isJson)
            writeJson(session.output, openTime.count());
        return fault_;
    }

private:
    std::size_t stepCount() const {
        return askedPath_.empty() ? static_cast<std::size_t>(steps_) + 1 : askedPath_.size();
    }

    Status findIsovalues(const Session& session) {
        const bool isPath = !askedPath_.empty();
        const auto asked = isPath ? askedPath_ : std::vector<AskedIsovalue>{*askedFrom_, *askedTo_};
        auto found = valuesOf(asked, indexPath_, {session.stop, {}});
        if (!found.isOk())
            return std::move(found).error();
        values_ = std::move(found).value();
        return {};
    }

    // The first one is tried; of the others none may be the index.
    Outcome checkExports() const {
        if (!pattern_)
            return {};
        ISO_CLI_TRY(checkMeshOutput(pattern_->nameOf(0), indexPath_));
        for (std::size_t step = 1; step < stepCount(); ++step)
            ISO_CLI_TRY(checkNotRead(pattern_->nameOf(step), {indexPath_}));
        return tryOutput(pattern_->nameOf(0));
    }

    double isovalueOf(std::size_t step) const {
        if (!askedPath_.empty())
            return values_[step];
        const double part = static_cast<double>(step) / static_cast<double>(steps_);
        // Both ends exactly, and no overflow between the largest numbers.
        return values_[0] * (1.0 - part) + values_[1] * part;
    }

    Outcome slide(extract::SlideEngine& engine, Session& session) {
        ProgressBar bar(session.showsProgress && pattern_, session.stop);
        const JobControl job = bar.job();
        if (!session.isJson)
            session.output.write(headLine());
        for (std::size_t step = 0; step < stepCount(); ++step) {
            const auto stats = engine.slideTo(isovalueOf(step), {session.stop, {}});
            if (!stats.isOk())
                return stats.error();
            if (pattern_) {
                const JobControl exporting = job.part(static_cast<double>(step) / static_cast<double>(stepCount()),
                                                      static_cast<double>(step + 1) / static_cast<double>(stepCount()));
                ISO_CLI_TRY(exportStep(engine, pattern_->nameOf(step), exporting));
                job.report(static_cast<double>(step + 1) / static_cast<double>(stepCount()), "exporting");
            }
            record(step, stats.value(), session);
            if (session.output.isClosed() && !pattern_)
                return {};
        }
        return {};
    }

    // The slide goes on after a surface with a fault; the first one is reported at the end.
    Outcome exportStep(const extract::SlideEngine& engine, const std::string& path, const JobControl& job) {
        const JobControl joining = job.part(0.0, 0.2), checking = job.part(0.2, 0.7), writing = job.part(0.7, 1.0);
        const auto surface = engine.mesh(joining);
        if (!surface.isOk())
            return surface.error();
        mesh::SurfaceSource source = sourceOf(engine.info(), indexPath_);
        source.merging = mesh::mergingText(engine.mergeBound(), engine.info().min, engine.info().max,
                                           1 << extract::kMaxBrickMergeLevel);
        const auto certificate = mesh::certify(surface.value(), source, checking);
        if (!certificate.isOk())
            return certificate.error();
        if (const auto status = mesh::exportMesh(surface.value(), certificate.value(), path, writing); !status.isOk())
            return status.error();
        if (fault_.isSuccess())
            fault_ = faultOutcome(certificate.value(), path);
        return {};
    }

    // Text goes out as it comes; JSON waits, since a failure must leave standard output empty. Kept
    // as text it costs some 250 bytes a step.
    void record(std::size_t step, const extract::SlideStats& stats, Session& session) {
        if (!session.isJson)
            session.output.write(textLine(step, stats));
        else
            stepsJson_ += (step == 0 ? "" : ",") + jsonLine(stats);
    }

    void writeJson(Output& output, double openMs) const {
        output.write("{\"open_ms\":" + jsonText(openMs));
        output.write(",\"peak_rss_bytes\":" + jsonText(peakRssBytes()));
        output.write(",\"steps\":[");
        output.write(stepsJson_);
        output.write("]}\n");
    }

    std::string indexPath_;
    std::optional<AskedIsovalue> askedFrom_;
    std::optional<AskedIsovalue> askedTo_;
    std::int64_t steps_ = 0;
    std::vector<AskedIsovalue> askedPath_;
    std::vector<double> values_; ///< of the path, or of both ends
    std::optional<ExportPattern> pattern_;
    LodError lodError_;
    std::string stepsJson_;
    Outcome fault_;
};

} // namespace

std::unique_ptr<Command> makeSlideCommand() { return std::make_unique<SlideCommand>(); }

} // namespace isoslider::cli
