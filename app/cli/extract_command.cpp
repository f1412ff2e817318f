#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/certified_output.h"
#include "app/cli/command.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/mesh/certificate.h"
#include "core/mesh/mesh_export.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

/// A surface and the volume that it is of.
struct Extracted {
    extract::SurfaceMesh surface;
    mesh::SurfaceSource source;
};

std::uint64_t missingSamples(const ScalarGrid& grid) {
    return grid.visit([](auto values) -> std::uint64_t {
        if constexpr (std::is_floating_point_v<typename decltype(values)::value_type>)
            return static_cast<std::uint64_t>(
                std::count_if(values.begin(), values.end(), [](auto value) { return !std::isfinite(value); }));
        return 0;
    });
}

Result<Extracted> surfaceFromIndex(const std::string& path, double isovalue, const JobControl& job) {
    auto engine = extract::SlideEngine::open(path);
    if (!engine.isOk())
        return std::move(engine).error();
    const auto move = engine.value()->slideTo(isovalue, job.stop);
    if (!move.isOk())
        return move.error();
    return Extracted{engine.value()->mesh(), sourceOf(engine.value()->info(), path)};
}

Result<Extracted> surfaceFromVolume(const std::string& path, const io::ReadOptions& options, double isovalue,
                                    const JobControl& job) {
    const auto source = io::openVolume(path, options);
    if (!source.isOk())
        return source.error();
    const auto grid = io::readVolume(*source.value(), path, job);
    if (!grid.isOk())
        return grid.error();
    const std::uint64_t missing = missingSamples(*grid.value());
    if (missing == static_cast<std::uint64_t>(pointCount(grid.value()->dims())))
        return makeError(ErrorCode::InvalidArgument, "has no finite sample", path);
    auto surface = extract::extractFull(*grid.value(), isovalue, job);
    if (!surface.isOk())
        return std::move(surface).error();
    return Extracted{std::move(surface).value(), {sourceName(path), missing, source.value()->info().lengthUnit}};
}

Json jsonOf(const mesh::Certificate& certificate, InputKind source) {
    const mesh::MeshReport& report = certificate.report;
    Json json;
    json["isovalue"] = certificate.isovalue;
    json["source"] = source == InputKind::Index ? "index" : "volume";
    json["vertices"] = report.vertices;
    json["triangles"] = report.triangles;
    json["active_edges"] = certificate.activeEdges;
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
    json["degenerate_triangles"] = report.degenerateTriangles;
    json["duplicate_triangles"] = report.duplicateTriangles;
    for (std::size_t i = 0; i < certificate.openings.size(); ++i) {
        Json& opening = json["open_at"][std::string(mesh::kOpenAtNames[i])];
        opening["loops"] = certificate.openings[i].loops;
        opening["edges"] = certificate.openings[i].edges;
    }
    json["nudged_vertices"] = certificate.nudge.vertices;
    json["largest_nudge"] = certificate.nudge.largestCells;
    json["largest_nudge_world"] = certificate.nudge.largestWorld;
    json["inner_vertices"] = certificate.innerVertices;
    json["valid"] = mesh::isValid(certificate);
    return json;
}

std::string textOf(const mesh::Certificate& certificate, const std::string& meshPath) {
    std::string text;
    for (const auto& line : mesh::linesOf(certificate))
        text += fmt::format("{:<22}{}\n", line.name, line.value);
    if (!meshPath.empty())
        text += fmt::format("{:<22}{}\n", "written to", meshPath);
    return text;
}

class ExtractCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command =
            program.add_subcommand("extract", "The surface at one isovalue, counted and exported");
        command->add_option("FILE", path_, "index or volume")->required()->type_name("");
        addNumber(*command, "--isovalue", isovalue_, "isovalue of the surface")->required();
        command->add_option("-o,--output", meshPath_, "mesh to write (ply, obj, stl, off, om)")
            ->type_name("MESH");
        addLodError(*command);
        addVolumeOptions(*command, volume_);
        return command;
    }

    Outcome run(Session& session) override {
        const auto kind = sniffInput(path_, volume_.readOptions());
        if (!kind.isOk())
            return kind.error();
        if (!meshPath_.empty())
            ISO_CLI_TRY(checkMeshOutput(meshPath_, path_));
        ProgressBar bar(session.showsProgress, session.stop);
        const auto extracted = kind.value() == InputKind::Index
                                 ? surfaceFromIndex(path_, *isovalue_, bar.job())
                                 : surfaceFromVolume(path_, volume_.readOptions(), *isovalue_, bar.job());
        if (!extracted.isOk()) {
            bar.wipe();
            return extracted.error();
        }
        const extract::SurfaceMesh& surface = extracted.value().surface;
        bar.job().report(1.0, "checking");
        const auto certificate = mesh::certify(surface, extracted.value().source);
        bar.wipe();
        if (session.stop.stop_requested())
            return cancelledError();
        if (!meshPath_.empty()) {
            if (const auto status = mesh::exportMesh(surface, certificate, meshPath_); !status.isOk())
                return status.error();
        }
        if (session.isJson)
            session.output.writeJson(jsonOf(certificate, kind.value()));
        else
            session.output.write(textOf(certificate, meshPath_));
        return faultOutcome(certificate, meshPath_.empty() ? path_ : meshPath_);
    }

private:
    std::string path_;
    std::optional<double> isovalue_;
    std::string meshPath_;
    VolumeOptions volume_;
};

} // namespace

std::unique_ptr<Command> makeExtractCommand() { return std::make_unique<ExtractCommand>(); }

} // namespace isoslider::cli
