#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/input_kind.h"
#include "app/cli/number_parsing.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "app/cli/report/report_page.h"
#include "app/cli/volume_options_check.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/base/plain_text.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

using Measure = extract::MergeBound::Measure;

/// Larger indexes of edges are not built for a report.
constexpr std::uint64_t kMostIndexBytes = std::uint64_t{8} << 30;
constexpr std::int64_t kMostSteps = 1000;

std::vector<index::IndexKind> kindsOrThrow(const std::string& text) {
    if (text == "both")
        return {index::IndexKind::Edges, index::IndexKind::Metacells};
    for (const index::IndexKind kind : {index::IndexKind::Edges, index::IndexKind::Metacells})
        if (text == index::indexKindName(kind))
            return {kind};
    throw CLI::ValidationError("--index", fmt::format("'{}' is not known; give edges, metacells or both", text));
}

class ReportCommand final : public Command {
public:
    ReportCommand() {
        for (const double percent : {0.1, 0.3, 0.8, 1.0, 1.5, 2.0})
            options_.errors.push_back({Measure::Scalar, percent});
        for (const double cells : {0.1, 0.25, 0.5, 1.0})
            options_.errors.push_back({Measure::Distance, cells});
    }

    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand(
            "report", "Tables 1 to 3 and Fig. 10 of the paper for volumes: indexes, steps, triangles against error");
        addInput(*command, "VOLUME", paths_, "volumes to measure");
        auto* output = command->add_option(
            "-o,--output", output_, "page to write, with its plots beside it; else to standard output, without plots");
        requireName(output->type_name("PAGE.md"), "the output");
        command
            ->add_option_function<std::string>(
                "--index", [this](const std::string& text) { options_.kinds = kindsOrThrow(text); },
                "kinds of index to measure: edges, metacells or both (both)")
            ->type_name("KIND");
        addInteger(*command, "--steps", steps_, 1, kMostSteps, fmt::format("steps of each size ({})", steps_));
        auto* folder = command->add_option("--folder", folder_,
                                           "where indexes are written meanwhile; those of edges take 2 to 12 bytes per "
                                           "voxel (the temporary folder)");
        requireName(folder->type_name("FOLDER"), "the folder");
        addVolumeOptions(*command, volume_);
        return command;
    }

    Outcome run(Session& session) override {
        if (output_ == "-")
            output_.clear();
        if (std::find(paths_.begin(), paths_.end(), "-") != paths_.end())
            return Outcome::wrongUsage(
                "report -: volumes are read several times, which standard input cannot; save it to a file");
        if (!output_.empty())
            ISO_CLI_TRY(checkPage());
        options_.steps = static_cast<int>(steps_);
        options_.folder = folder_.empty() ? temporaryFolder() : std::filesystem::path(folder_);
        options_.mostIndexBytes = kMostIndexBytes;
        ISO_CLI_TRY(checkOutput(options_.folder / "isoslider-report.isx", ""));
        for (const std::string& path : paths_) {
            const auto kind = sniffInput(path, volume_.readOptions());
            if (!kind.isOk())
                return kind.error();
            if (kind.value() == InputKind::Index)
                return makeError(ErrorCode::InvalidArgument, "is an index; a report is of volumes", path);
        }
        ISO_CLI_TRY(checkAnyResampled(session.stop));
        if (!output_.empty())
            ISO_CLI_TRY(tryOutputs(session.stop));
        std::vector<VolumeMeasures> volumes;
        const Outcome measured = measureAll(session, volumes);
        if (measured.isSuccess())
            return write(session, volumes);
        // What has been measured took long: it is not lost with the volume that failed.
        if (!output_.empty() && !volumes.empty())
            ISO_CLI_TRY(writePage(volumes));
        return measured;
    }

private:
    // Of several volumes one may be uniform and another not.
    Outcome checkAnyResampled(const std::stop_token& stop) const {
        Outcome refusal;
        for (const std::string& path : paths_) {
            refusal = checkResampling(volume_.readOptions(), path, {stop, {}});
            if (refusal.isSuccess())
                break;
        }
        return refusal;
    }

    Outcome checkPage() const {
        if (!output_.ends_with(".md"))
            return Outcome::wrongUsage(fmt::format("--output: '{}': a report is written as .md", output_));
        for (const std::filesystem::path& output : outputs())
            for (const std::string& path : paths_)
                ISO_CLI_TRY(checkOutput(output, path));
        return {};
    }

    // The page and its plots; none where it goes to standard output.
    std::vector<std::filesystem::path> outputs() const {
        const std::filesystem::path page = output_;
        if (page.empty())
            return {};
        std::vector<std::filesystem::path> all{page};
        for (const std::string& name : plotNames(page.stem().string()))
            all.push_back(page.parent_path() / name);
        return all;
    }

    // Of all volumes before the first is measured. One that cannot be opened is reported once the others are measured,
    // unless the outputs replace files: those may be what it is read from.
    Outcome tryOutputs(const std::stop_token& stop) const {
        const std::vector<std::filesystem::path> all = outputs();
        const bool replaces = std::any_of(all.begin(), all.end(), isPresent);
        for (const std::string& path : paths_) {
            const auto source = io::openVolume(path, volume_.readOptions(), {stop, {}});
            if (!source.isOk() && replaces)
                return source.error();
            for (const std::filesystem::path& output : all)
                if (source.isOk())
                    ISO_CLI_TRY(checkNotRead(output, path, source.value()->info()));
        }
        for (const std::filesystem::path& output : all)
            ISO_CLI_TRY(tryOutput(output));
        return {};
    }

    Outcome measureAll(Session& session, std::vector<VolumeMeasures>& volumes) {
        ProgressBar bar(session.showsProgress, session.stop);
        const JobControl job = bar.job();
        for (std::size_t i = 0; i < paths_.size(); ++i) {
            const auto count = static_cast<double>(paths_.size());
            const JobControl measuring = job.part(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
            const auto source = io::openVolume(paths_[i], volume_.readOptions(), measuring);
            if (!source.isOk())
                return source.error();
            auto measured = measureVolume(*source.value(), paths_[i], options_, measuring);
            if (!measured.isOk())
                return measured.error();
            volumes.push_back(std::move(measured).value());
        }
        return {};
    }

    Outcome writePage(const std::vector<VolumeMeasures>& volumes) const {
        const std::filesystem::path page = output_;
        const std::vector<ReportPlot> plots = plotsOf(volumes, page.stem().string());
        for (const ReportPlot& plot : plots)
            if (const Status written = writeWholeFile(page.parent_path() / plot.fileName, plot.svg); !written.isOk())
                return written.error();
        const Status written = writeWholeFile(page, pageOf(volumes, plots));
        return written.isOk() ? Outcome() : Outcome(written.error());
    }

    Outcome write(Session& session, const std::vector<VolumeMeasures>& volumes) const {
        if (!output_.empty())
            ISO_CLI_TRY(writePage(volumes));
        if (session.isJson)
            session.output.writeJson(reportJson(volumes));
        else if (output_.empty())
            session.output.write(pageOf(volumes, {}));
        else
            session.output.write(fmt::format("{}: {}\n", output_, counted(volumes.size(), "volume")));
        return {};
    }

    std::vector<std::string> paths_;
    std::string output_;
    std::string folder_;
    std::int64_t steps_ = 12;
    MeasureOptions options_;
    VolumeOptions volume_;
};

} // namespace

std::unique_ptr<Command> makeReportCommand() { return std::make_unique<ReportCommand>(); }

} // namespace isoslider::cli
