#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/geometry_text.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "app/cli/standard_input.h"
#include "app/cli/standard_output.h"
#include "core/base/folders.h"
#include "core/volume_io/volume_reader.h"
#include "core/volume_io/volume_writer.h"

namespace isoslider::cli {
namespace {

Json jsonOf(const io::VolumeInfo& info) {
    Json json;
    json["dims"] = info.geometry.dims;
    json["spacing"] = vectorJson(info.geometry.spacing);
    json["origin"] = vectorJson(info.geometry.origin);
    json["scalar_type"] = scalarTypeName(info.type);
    json["field"] = info.fieldName;
    const io::ResampleReport& report = *info.resampling;
    json["source_points"] = report.sourcePoints;
    json["compared_points"] = report.comparedPoints;
    json["max_difference"] = report.maxDifference;
    json["rms_difference"] = report.rmsDifference;
    json["range_fraction"] = report.rangeFraction;
    json["outside_points"] = report.outsidePoints;
    return json;
}

std::string textOf(const std::string& output, const io::VolumeInfo& info) {
    const io::ResampleReport& report = *info.resampling;
    return fmt::format("{}: {} of {}, spacing {}\n"
                       "largest difference   {} ({:.3g} % of the range)\n"
                       "root mean square     {}\n"
                       "compared             {} of {} points of the source\n"
                       "outside the source   {} of {} points, missing\n",
                       output, dimsText(info.geometry.dims), info.fieldName.empty() ? "samples" : info.fieldName,
                       vectorText(info.geometry.spacing), report.maxDifference, 100.0 * report.rangeFraction,
                       report.rmsDifference, report.comparedPoints, report.sourcePoints, report.outsidePoints,
                       pointCount(info.geometry.dims));
}

class ResampleCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("resample", "Make a uniform volume of a non-uniform grid");
        addInput(*command, "GRID", path_, "rectilinear, curvilinear or unstructured grid; - for standard input");
        auto* output =
            command->add_option("-o,--output", output_, "volume to write; - for standard output")->required();
        requireName(output->type_name("VOLUME.mha"), "the output");
        addVolumeOptions(*command, volume_);
        standardInput_.declare(*command, path_, InputContent::Volume);
        command->get_option("--resample")->group("");
        addDims(*command, "--size", volume_.resampleDims, "size of the volume (about as many points as the grid has)");
        return command;
    }

    Outcome run(Session& session) override {
        ISO_CLI_TRY(standardOutput_.prepare(session, output_, ".mha"));
        ISO_CLI_TRY(checkOutput(output_, path_ == "-" ? "" : path_)); // before all of standard input is read
        if (!output_.ends_with(".mha"))
            return Outcome::wrongUsage(fmt::format("--output: '{}': volumes are written as .mha", output_));
        ISO_CLI_TRY(standardInput_.fetch(session, volume_, temporaryFolder()));
        ProgressBar bar(session.showsProgress, session.stop);
        const JobControl job = bar.job();
        const auto source = io::openVolume(path_, volume_.readOptions(), job);
        if (!source.isOk())
            return source.error();
        ISO_CLI_TRY(checkNotRead(output_, path_, source.value()->info()));
        ISO_CLI_TRY(tryOutput(output_));
        const auto info = resample(*source.value(), job);
        bar.wipe();
        if (!info.isOk())
            return info.error();
        if (const Status sent = standardOutput_.send(session); !sent.isOk())
            return sent.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(info.value()));
        else
            session.output.write(textOf(session.shown(output_), info.value()));
        return {};
    }

private:
    Result<io::VolumeInfo> resample(io::VolumeSource& source, const JobControl& job) const {
        const JobControl making = job.part(0.0, 0.9), writing = job.part(0.9, 1.0);
        const auto grid = io::readVolume(source, path_, making);
        if (!grid.isOk())
            return grid.error();
        if (!source.info().resampling)
            return makeError(ErrorCode::InvalidArgument, "is a uniform grid: there is nothing to resample", path_);
        ISO_TRY(io::writeVolume(*grid.value(), output_, source.info().lengthUnit, writing));
        return source.info();
    }

    std::string path_;
    std::string output_;
    VolumeOptions volume_;
    StandardInput standardInput_;
    StandardOutput standardOutput_;
};

} // namespace

std::unique_ptr<Command> makeResampleCommand() { return std::make_unique<ResampleCommand>(); }

} // namespace isoslider::cli
