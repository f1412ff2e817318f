#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/asked_isovalue.h"
#include "app/cli/certified_output.h"
#include "app/cli/command.h"
#include "app/cli/escaped_name.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "app/cli/resampling_report.h"
#include "app/cli/standard_input.h"
#include "app/cli/standard_output.h"
#include "app/cli/volume_options_check.h"
#include "core/base/folders.h"
#include "core/extract/full_extraction.h"
#include "core/extract/merged/merged_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/grid/volume_statistics.h"
#include "core/mesh/certificate.h"
#include "core/mesh/mesh_export.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

/// A surface and the volume that it is of.
struct Extracted {
    extract::SurfaceMesh surface;
    mesh::SurfaceSource source;
    io::VolumeInfo volume; ///< unless it is of an index
    extract::LeafCounts leaves{}; ///< active ones by level
    std::string lodError; ///< as it is given on the command line; empty: nothing is merged
};

/// Unfinished once `job` is to stop.
std::uint64_t missingSamples(const ScalarGrid& grid, const JobControl& job) {
    return grid.visit([&](auto values) -> std::uint64_t {
        std::uint64_t missing = 0;
        if constexpr (std::is_floating_point_v<typename decltype(values)::value_type>) {
            constexpr std::size_t kChunk = std::size_t{1} << 22;
            for (std::size_t at = 0; at < values.size() && !job.isStopRequested(); at += kChunk) {
                const auto chunk = values.subspan(at, std::min(kChunk, values.size() - at));
                missing += static_cast<std::uint64_t>(
                    std::count_if(chunk.begin(), chunk.end(), [](auto value) { return !std::isfinite(value); }));
            }
        }
        return missing;
    });
}

Result<Extracted> surfaceFromIndex(const std::string& path, const AskedIsovalue& isovalue, const LodError& lodError,
                                   const JobControl& job) {
    extract::SlideOptions options; // it moves once
    options.readsAhead = options.buildsLevels = false;
    auto engine = extract::SlideEngine::open(path, options);
    if (!engine.isOk())
        return std::move(engine).error();
    const index::IndexInfo& info = engine.value()->info();
    Extracted extracted{{}, sourceOf(info, path), {}, {}, {}};
    if (lodError.isGiven()) {
        const extract::MergeBound bound = extract::boundOf(lodError.error, info.min, info.max);
        engine.value()->setMergeBound(bound);
    }
    const auto values = valuesOf(std::span(&isovalue, 1), path, job);
    if (!values.isOk())
        return values.error();
    const auto move = engine.value()->slideTo(values.value().front(), job.part(0.0, 0.5));
    if (!move.isOk())
        return move.error();
    extracted.leaves = move.value().activeLeaves;
    extracted.source.merging =
        mesh::mergingText(engine.value()->mergeBound(), info.min, info.max, 1 << extract::kMaxBrickMergeLevel);
    const extract::MergeError error = lodError.isGiven() ? lodError.error : extract::builtError(info);
    if (error.amount > 0.0)
        extracted.lodError = lodError.isGiven() ? lodError.text : optionText(error);
    auto surface = engine.value()->mesh(job.part(0.5, 1.0));
    if (!surface.isOk())
        return std::move(surface).error();
    extracted.surface = std::move(surface).value();
    return extracted;
}

Result<Extracted> surfaceFromVolume(io::VolumeSource& source, const std::string& path, const AskedIsovalue& asked,
                                    const LodError& lodError, int maxLevel, const JobControl& job) {
    const JobControl reading = job.part(0.0, 0.5), extracting = job.part(0.5, 1.0);
    const auto grid = io::readVolume(source, path, reading);
    if (!grid.isOk())
        return grid.error();
    const std::uint64_t missing = missingSamples(*grid.value(), job);
    if (missing == static_cast<std::uint64_t>(pointCount(grid.value()->dims())))
        return makeError(ErrorCode::InvalidArgument, "has no finite sample", path);
    const auto values = valuesOf(std::span(&asked, 1), *grid.value(), path, job);
    if (!values.isOk())
        return values.error();
    const double isovalue = values.value().front();
    const io::VolumeInfo& info = source.info();
    Extracted extracted{
        {}, {sourceName(path), missing, info.lengthUnit, resamplingText(info), "", info.isPatientSpace}, info, {}, {}};
    Result<extract::SurfaceMesh> surface = extract::SurfaceMesh();
    if (lodError.merges()) {
        double least = 0.0, greatest = 0.0;
        if (lodError.error.measure == extract::MergeBound::Measure::Scalar) {
            const auto statistics = computeStatistics(*grid.value(), false, 1, extracting.part(0.0, 0.2));
            if (!statistics.isOk())
                return statistics.error();
            least = statistics.value().min;
            greatest = statistics.value().max;
        }
        const extract::MergeBound bound = extract::boundOf(lodError.error, least, greatest);
        extracted.lodError = lodError.text;
        extracted.source.merging = mesh::mergingText(bound, least, greatest, 1 << maxLevel);
        surface = extract::extractMerged(*grid.value(), isovalue, bound, maxLevel, extracting.part(0.2, 1.0),
                                         &extracted.leaves);
    } else {
        surface = extract::extractFull(*grid.value(), isovalue, extracting);
    }
    if (!surface.isOk())
        return std::move(surface).error();
    extracted.surface = std::move(surface).value();
    return extracted;
}

void addChecked(const mesh::Certificate& certificate, Json& json) {
    const mesh::MeshReport& report = certificate.report;
    json["components"] = report.components;
    json["euler"] = report.euler;
    json["boundary_loops"] = report.boundaryLoops;
    json["closed"] = report.isClosed;
    json["manifold"] = report.isManifold;
    json["oriented"] = report.isOriented;
    json["genus"] = report.genus;
    json["area"] = report.area;
    json["volume"] = report.isClosed ? Json(report.enclosedVolume) : Json(nullptr);
    if (!certificate.lengthUnit.empty())
        json["length_unit"] = certificate.lengthUnit;
    if (certificate.isPatientSpace)
        json["coordinates"] = "LPS";
    json["degenerate_triangles"] = report.degenerateTriangles;
    json["duplicate_triangles"] = report.duplicateTriangles;
    for (std::size_t i = 0; i < certificate.openings.size(); ++i) {
        Json& opening = json["open_at"][std::string(mesh::kOpenAtNames[i])];
        opening["loops"] = certificate.openings[i].loops;
        opening["edges"] = certificate.openings[i].edges;
    }
    json["loops_at_several_places"] = certificate.sharedLoops;
    json["nudged_vertices"] = certificate.nudge.vertices;
    json["largest_nudge"] = certificate.nudge.largestCells;
    json["largest_nudge_world"] = certificate.nudge.largestWorld;
    json["inner_vertices"] = certificate.innerVertices;
    json["valid"] = mesh::isValid(certificate);
}

Json jsonOf(const mesh::Certificate& certificate, InputKind source, const Extracted& extracted) {
    Json json;
    json["isovalue"] = certificate.isovalue;
    json["source"] = source == InputKind::Index ? "index" : "volume";
    json["vertices"] = certificate.report.vertices;
    json["triangles"] = certificate.report.triangles;
    json["active_edges"] = certificate.activeEdges;
    if (certificate.isChecked)
        addChecked(certificate, json);
    else
        json["checked"] = false;
    if (source == InputKind::Index)
        addResampling(certificate.resampling, json);
    addResampling(extracted.volume, json);
    if (!extracted.lodError.empty()) {
        json["lod_error"] = extracted.lodError;
        json["leaves"] = extracted.leaves;
    }
    return json;
}

std::string textOf(const mesh::Certificate& certificate, const std::string& meshPath) {
    std::string text;
    if (certificate.report.triangles == 0)
        text += fmt::format("{:<22}{}\n", "surface", "none at this isovalue: the mesh has no triangle");
    for (const auto& line : mesh::linesOf(certificate))
        text += fmt::format("{:<22}{}\n", line.name, line.value);
    if (!meshPath.empty())
        text += fmt::format("{:<22}{}\n", "written to", escapedName(meshPath));
    return text;
}

class ExtractCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("extract", "The surface at one isovalue, counted and exported");
        addInput(*command, "FILE", path_, "index or volume; - for standard input");
        addIsovalue(*command, "--isovalue", isovalue_, "isovalue of the surface")->required();
        auto* output = command->add_option("-o,--output", meshPath_,
                                           "mesh to write (ply, obj, stl, off, om); - for standard output");
        requireName(output->type_name("MESH"), "the output");
        addFormat(*command);
        command->add_flag("--no-check", skipsCheck_, "write and count the surface without checking it: no certificate");
        auto* lodError =
            addLodError(*command, lodError_, "merge cells that differ by no more: % of the value range, or c (cells)");
        addInteger(*command, "--lod-levels", lodLevels_, 1, extract::kMaxMergeLevel,
                   "merge up to 2^N cells along each axis: 5 of a volume unless given, always 3 of an index")
            ->needs(lodError);
        addVolumeOptions(*command, volume_);
        standardInput_.declare(*command, path_, InputContent::VolumeOrIndex);
        return command;
    }

    Outcome run(Session& session) override {
        ISO_CLI_TRY(checkFormat());
        ISO_CLI_TRY(standardOutput_.prepare(session, meshPath_, "." + format_));
        if (!meshPath_.empty() && path_ == "-") { // before all of standard input is read
            ISO_CLI_TRY(checkMeshOutput(meshPath_, ""));
            ISO_CLI_TRY(tryOutput(meshPath_));
        }
        ISO_CLI_TRY(standardInput_.fetch(session, volume_, temporaryFolder()));
        const auto kind = sniffInput(path_, volume_.readOptions());
        if (!kind.isOk())
            return kind.error();
        ISO_CLI_TRY(checkVolumeOptions(volume_, kind.value(), path_));
        if (kind.value() == InputKind::Index && lodLevels_ > 0 && lodLevels_ != extract::kMaxBrickMergeLevel)
            return Outcome::wrongUsage("--lod-levels: cells of an index are merged up to level 3");
        if (!meshPath_.empty())
            ISO_CLI_TRY(checkMeshOutput(meshPath_, path_));
        ProgressBar bar(session.showsProgress, session.stop);
        const JobControl job = bar.job();
        const JobControl extracting = job.part(0.0, 0.4), finishing = job.part(0.4, 1.0);
        std::unique_ptr<io::VolumeSource> source; // of a volume
        if (kind.value() == InputKind::Volume) {
            ISO_CLI_TRY(checkResampling(volume_.readOptions(), path_, extracting));
            auto opened = io::openVolume(path_, volume_.readOptions(), extracting);
            if (!opened.isOk())
                return std::move(opened).error();
            source = std::move(opened).value();
            if (!meshPath_.empty())
                ISO_CLI_TRY(checkNotRead(meshPath_, path_, source->info()));
        }
        if (!meshPath_.empty())
            ISO_CLI_TRY(tryOutput(meshPath_));
        const auto extracted = source ? surfaceFromVolume(*source, path_, *isovalue_, lodError_, maxLevel(), extracting)
                                      : surfaceFromIndex(path_, *isovalue_, lodError_, extracting);
        if (!extracted.isOk())
            return extracted.error();
        const auto certificate = certifyAndExport(extracted.value(), finishing);
        if (!certificate.isOk())
            return certificate.error();
        bar.wipe();
        if (const Status sent = standardOutput_.send(session); !sent.isOk())
            return sent.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(certificate.value(), kind.value(), extracted.value()));
        else
            session.output.write(textOf(certificate.value(), session.shown(meshPath_)));
        return faultOutcome(certificate.value(), meshPath_.empty() ? path_ : meshPath_);
    }

private:
    int maxLevel() const { return static_cast<int>(lodLevels_ > 0 ? lodLevels_ : extract::kMaxMergeLevel); }

    void addFormat(CLI::App& command) {
        command
            .add_option_function<std::string>(
                "--format",
                [this](const std::string& text) {
                    if (!mesh::isExportSuffix("mesh." + text))
                        throw CLI::ValidationError(
                            "--format", fmt::format("'{}' is not a format; known: ply, obj, stl, off, om", text));
                    format_ = text;
                },
                "format of the mesh on standard output (-o -); of a file, its suffix states it")
            ->type_name("FORMAT");
    }

    Outcome checkFormat() const {
        if (meshPath_ == "-" && format_.empty())
            return Outcome::wrongUsage("-o - needs --format: ply, obj, stl, off or om");
        if (meshPath_ != "-" && !format_.empty())
            return Outcome::wrongUsage("--format is for standard output (-o -); a file's suffix states its format");
        return {};
    }

    Result<mesh::Certificate> certifyAndExport(const Extracted& extracted, const JobControl& job) const {
        const JobControl checking = job.part(0.0, 0.7), writing = job.part(0.7, 1.0);
        auto certificate = skipsCheck_ ? mesh::uncheckedCertificate(extracted.surface, extracted.source)
                                       : mesh::certify(extracted.surface, extracted.source, checking);
        if (!certificate.isOk())
            return certificate;
        if (job.isStopRequested())
            return cancelledError();
        if (!meshPath_.empty())
            ISO_TRY(mesh::exportMesh(extracted.surface, certificate.value(), meshPath_, writing));
        return certificate;
    }

    std::string path_;
    std::optional<AskedIsovalue> isovalue_;
    std::string meshPath_;
    bool skipsCheck_ = false;
    LodError lodError_;
    std::int64_t lodLevels_ = 0; ///< 0: not given
    std::string format_; ///< of standard output
    VolumeOptions volume_;
    StandardInput standardInput_;
    StandardOutput standardOutput_;
};

} // namespace

std::unique_ptr<Command> makeExtractCommand() { return std::make_unique<ExtractCommand>(); }

} // namespace isoslider::cli
