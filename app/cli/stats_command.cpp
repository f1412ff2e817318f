#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/escaped_name.h"
#include "app/cli/geometry_text.h"
#include "app/cli/index_facts.h"
#include "app/cli/level_json.h"
#include "app/cli/lod_error.h"
#include "app/cli/options.h"
#include "app/cli/standard_input.h"
#include "core/extract/slide_engine.h"
#include "core/index/index_reader.h"

namespace isoslider::cli {
namespace {

Json jsonOf(const index::IndexInfo& info) {
    Json json;
    json["source_name"] = info.sourceName;
    json["kind"] = index::indexKindName(info.kind);
    json["dims"] = info.geometry.dims;
    json["scalar_type"] = scalarTypeName(info.type);
    json["distinct_values"] = info.distinctValues;
    json["average_active_edges"] = meanActiveEdges(info);
    json["average_change"] = meanChange(info);
    json["redundancy"] = info.redundancyThreshold;
    if (info.mergeError > 0.0)
        json["lod_error"] = optionText(extract::builtError(info));
    json["index_bytes"] = info.indexBytes;
    json["bytes_per_voxel"] = bytesPerPoint(info, info.indexBytes);
    json["sample_bytes"] = info.chunkBytes;
    json["levels"] = levelsJson(info);
    return json;
}

std::string textOf(const index::IndexInfo& info) {
    std::string text = "Table 1: the model\n";
    text += fmt::format("  model                 {}\n", escapedName(info.sourceName));
    text += fmt::format("  resolution            {}\n", dimsText(info.geometry.dims));
    text += fmt::format("  scalar type           {}\n", scalarTypeName(info.type));
    text += fmt::format("  distinct isovalues    {}\n", info.distinctValues);
    text += fmt::format("  average active edges  {:.0f}\n\n", meanActiveEdges(info));
    const bool isEdges = info.kind == index::IndexKind::Edges;
    text += "Table 2: the preprocessing\n";
    text += fmt::format("  kind                  {}\n", index::indexKindName(info.kind));
    text += fmt::format("  error                 {}\n",
                        info.mergeError > 0.0 ? plainText(extract::builtError(info))
                                              : std::string(isEdges ? "0 % (no merging)" : "chosen while sliding"));
    text += fmt::format("  redundancy k          {}\n", info.redundancyThreshold);
    text += fmt::format("  change per value      {:.1f} {}\n", meanChange(info),
                        !isEdges                ? "bricks"
                        : info.mergeError > 0.0 ? "entries"
                                                : "edges");
    text += fmt::format("  samples               {} bytes, {:.2f} bytes per voxel\n", info.chunkBytes,
                        bytesPerPoint(info, info.chunkBytes));
    text += fmt::format("  index                 {} bytes, {:.2f} bytes per voxel\n\n", info.indexBytes,
                        bytesPerPoint(info, info.indexBytes));
    text += fmt::format("{:>5} {:>12} {:>14} {:>14} {:>14} {:>14} {:>11}\n", "level", "blocks",
                        !isEdges                ? "bricks"
                        : info.mergeError > 0.0 ? "records"
                                                : "points",
                        isEdges && !(info.mergeError > 0.0) ? "edges" : "entries", "redundant", "bytes", "bytes/voxel");
    for (std::size_t level = 0; level < info.levels.size(); ++level) {
        const index::SkipLevelInfo& facts = info.levels[level];
        text += fmt::format("{:>5} {:>12} {:>14} {:>14} {:>14} {:>14} {:>11.2f}\n", level, facts.blocks, facts.points,
                            facts.edges, facts.redundantRemoved, facts.bytes, bytesPerPoint(info, facts.bytes));
    }
    return text;
}

class StatsCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("stats", "Tables 1 and 2 of the paper for an index, and its levels");
        addInput(*command, "INDEX", path_, "index to describe; - for standard input");
        standardInput_.declare(*command, path_, InputContent::Index);
        return command;
    }

    Outcome run(Session& session) override {
        ISO_CLI_TRY(standardInput_.fetch(session));
        const auto reader = index::IndexReader::open(path_);
        if (!reader.isOk())
            return reader.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(reader.value()->info()));
        else
            session.output.write(textOf(reader.value()->info()));
        return {};
    }

private:
    std::string path_;
    StandardInput standardInput_;
};

} // namespace

std::unique_ptr<Command> makeStatsCommand() { return std::make_unique<StatsCommand>(); }

} // namespace isoslider::cli
