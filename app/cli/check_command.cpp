#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/options.h"
#include "app/cli/progress_bar.h"
#include "app/cli/standard_input.h"
#include "core/mesh/mesh_checks.h"

namespace isoslider::cli {
namespace {

Json jsonOf(const mesh::MeshReport& report) {
    Json json;
    json["manifold"] = report.isManifold;
    json["closed"] = report.isClosed;
    json["oriented"] = report.isOriented;
    json["vertices"] = report.vertices;
    json["edges"] = report.edges;
    json["triangles"] = report.triangles;
    json["components"] = report.components;
    json["euler"] = report.euler;
    json["boundary_loops"] = report.boundaryLoops;
    json["genus"] = report.genus;
    json["degenerate_triangles"] = report.degenerateTriangles;
    json["duplicate_triangles"] = report.duplicateTriangles;
    return json;
}

std::string textOf(const mesh::MeshReport& report) {
    const auto yesNo = [](bool isSo) { return isSo ? "yes" : "no"; };
    std::string text;
    if (report.triangles == 0)
        text += "surface               none: the mesh has no triangle\n";
    text += fmt::format("manifold              {}\n", yesNo(report.isManifold));
    text += fmt::format("closed                {}\n", yesNo(report.isClosed));
    text += fmt::format("oriented              {}\n", yesNo(report.isOriented));
    text += fmt::format("vertices              {}\n", report.vertices);
    text += fmt::format("edges                 {}\n", report.edges);
    text += fmt::format("triangles             {}\n", report.triangles);
    text += fmt::format("components            {}\n", report.components);
    text += fmt::format("Euler number          {}\n", report.euler);
    text += fmt::format("boundary loops        {}\n", report.boundaryLoops);
    text += fmt::format("genus                 {}\n", report.genus);
    text += fmt::format("degenerate triangles  {}\n", report.degenerateTriangles);
    text += fmt::format("duplicate triangles   {}\n", report.duplicateTriangles);
    return text;
}

class CheckCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("check", "Whether a mesh is a sound, oriented 2-manifold");
        addInput(*command, "MESH", path_, "mesh to check (ply, obj, stl, off, om); - for standard input");
        standardInput_.declare(*command, path_, InputContent::Mesh);
        return command;
    }

    Outcome run(Session& session) override {
        ISO_CLI_TRY(standardInput_.fetch(session));
        ProgressBar bar(session.showsProgress, session.stop);
        const JobControl job = bar.job();
        const auto report = mesh::checkMeshFile(path_, job);
        bar.wipe();
        if (!report.isOk())
            return report.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(report.value()));
        else
            session.output.write(textOf(report.value()));
        const auto faults = mesh::faultsOf(report.value());
        if (faults.empty())
            return {};
        const auto line = fmt::format("{}", fmt::join(faults, ", "));
        return Outcome::foundFault(makeError(ErrorCode::InvalidArgument, line, path_).line());
    }

private:
    std::string path_;
    StandardInput standardInput_;
};

} // namespace

std::unique_ptr<Command> makeCheckCommand() { return std::make_unique<CheckCommand>(); }

} // namespace isoslider::cli
