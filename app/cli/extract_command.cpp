#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/output_check.h"
#include "app/cli/progress_bar.h"
#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/mesh/mesh_checks.h"
#include "core/mesh/mesh_export.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

Result<extract::SurfaceMesh> surfaceFromIndex(const std::string& path, double isovalue,
                                              const JobControl& job) {
    auto engine = extract::SlideEngine::open(path);
    if (!engine.isOk())
        return std::move(engine).error();
    const auto move = engine.value()->slideTo(isovalue, job.stop);
    if (!move.isOk())
        return move.error();
    return engine.value()->mesh();
}

Result<extract::SurfaceMesh> surfaceFromVolume(const std::string& path, const io::ReadOptions& options,
                                               double isovalue, const JobControl& job) {
    const auto grid = io::readVolume(path, options, job);
    if (!grid.isOk())
        return grid.error();
    return extract::extractFull(*grid.value(), isovalue, job);
}

/// What is told of a surface, besides the mesh itself.
struct Account {
    double isovalue = 0.0;
    InputKind source = InputKind::Volume;
    std::uint64_t activeEdges = 0;
    mesh::MeshReport report;
};

Json jsonOf(const Account& account) {
    const mesh::MeshReport& report = account.report;
    Json json;
    json["isovalue"] = account.isovalue;
    json["source"] = account.source == InputKind::Index ? "index" : "volume";
    json["vertices"] = report.vertices;
    json["triangles"] = report.triangles;
    json["active_edges"] = account.activeEdges;
    json["components"] = report.components;
    json["euler"] = report.euler;
    json["boundary_loops"] = report.boundaryLoops;
    json["closed"] = report.isClosed;
    json["manifold"] = report.isManifold;
    json["area"] = report.area;
    json["volume"] = report.enclosedVolume;
    return json;
}

std::string textOf(const Account& account, const std::string& meshPath) {
    const mesh::MeshReport& report = account.report;
    std::string text = fmt::format("isovalue {}: {} triangles, {} vertices, {} active edges\n",
                                   account.isovalue, report.triangles, report.vertices, account.activeEdges);
    text += fmt::format("{} components, Euler number {}, {} boundary loops, {}, {}\n", report.components,
                        report.euler, report.boundaryLoops, report.isClosed ? "closed" : "open",
                        report.isManifold ? "manifold" : "not manifold");
    text += fmt::format("area {}", report.area);
    text += report.isClosed ? fmt::format(", enclosed volume {}\n", report.enclosedVolume) : "\n";
    if (!meshPath.empty())
        text += fmt::format("written to {}\n", meshPath);
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
        const auto surface = kind.value() == InputKind::Index
                                 ? surfaceFromIndex(path_, *isovalue_, bar.job())
                                 : surfaceFromVolume(path_, volume_.readOptions(), *isovalue_, bar.job());
        bar.wipe();
        if (!surface.isOk())
            return surface.error();
        const Account account{*isovalue_, kind.value(), surface.value().positions.size(),
                              mesh::checkMesh(surface.value())};
        if (session.stop.stop_requested())
            return cancelledError();
        if (!meshPath_.empty()) {
            if (const auto status = mesh::exportMesh(surface.value(), meshPath_); !status.isOk())
                return status.error();
        }
        if (session.isJson)
            session.output.writeJson(jsonOf(account));
        else
            session.output.write(textOf(account, meshPath_));
        return {};
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
