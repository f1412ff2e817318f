#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/geometry_text.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/progress_bar.h"
#include "core/extract/slide_engine.h"
#include "core/grid/volume_statistics.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

/// The same facts for a volume and for an index of one.
struct Facts {
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    double min = 0.0;
    double max = 0.0;
    std::uint64_t distinctValues = 0;
    std::uint64_t nanCount = 0;
    std::string format;
    std::string fieldName;
};

Result<Facts> factsOfIndex(const std::string& path) {
    auto engine = extract::SlideEngine::open(path);
    if (!engine.isOk())
        return std::move(engine).error();
    const index::IndexInfo& info = engine.value()->info();
    return Facts{info.geometry,       info.type,     info.min,          info.max,
                 info.distinctValues, info.nanCount, "ISOSLIDER index", ""};
}

Result<Facts> factsOfVolume(const std::string& path, const io::ReadOptions& options, const JobControl& job) {
    auto source = io::openVolume(path, options);
    if (!source.isOk())
        return std::move(source).error();
    const io::VolumeInfo info = source.value()->info();
    source.value().reset();
    auto grid = io::readVolume(path, options, job);
    if (!grid.isOk())
        return std::move(grid).error();
    auto statistics = computeStatistics(*grid.value(), true, 1, job);
    if (!statistics.isOk())
        return std::move(statistics).error();
    const VolumeStatistics& found = statistics.value();
    return Facts{grid.value()->geometry(), grid.value()->type(), found.min,   found.max,
                 found.distinctValues,     found.nanCount,       info.format, info.fieldName};
}

Json jsonOf(const Facts& facts) {
    Json json;
    json["dims"] = facts.geometry.dims;
    json["spacing"] = vectorJson(facts.geometry.spacing);
    json["origin"] = vectorJson(facts.geometry.origin);
    json["scalar_type"] = scalarTypeName(facts.type);
    json["min"] = facts.min;
    json["max"] = facts.max;
    json["distinct_values"] = facts.distinctValues;
    json["nan_count"] = facts.nanCount;
    json["format"] = facts.format;
    json["direction"] = {vectorJson(facts.geometry.direction[0]), vectorJson(facts.geometry.direction[1]),
                         vectorJson(facts.geometry.direction[2])};
    return json;
}

std::string textOf(const Facts& facts) {
    std::string text = fmt::format("format           {}\n", facts.format);
    if (!facts.fieldName.empty())
        text += fmt::format("field            {}\n", facts.fieldName);
    text += fmt::format("dims             {}\n", dimsText(facts.geometry.dims));
    text += fmt::format("spacing          {}\n", vectorText(facts.geometry.spacing));
    text += fmt::format("origin           {}\n", vectorText(facts.geometry.origin));
    text += fmt::format("direction        {} | {} | {}\n", vectorText(facts.geometry.direction[0]),
                        vectorText(facts.geometry.direction[1]), vectorText(facts.geometry.direction[2]));
    text += fmt::format("scalar type      {}\n", scalarTypeName(facts.type));
    text += fmt::format("range            {} .. {}\n", facts.min, facts.max);
    text += fmt::format("distinct values  {}\n", facts.distinctValues);
    text += fmt::format("missing samples  {}\n", facts.nanCount);
    return text;
}

class InfoCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("info", "What a volume, or an index of one, holds");
        command->add_option("FILE", path_, "volume or index")->required()->type_name("");
        addVolumeOptions(*command, volume_);
        return command;
    }

    Outcome run(Session& session) override {
        const auto kind = sniffInput(path_, volume_.readOptions());
        if (!kind.isOk())
            return kind.error();
        ProgressBar bar(session.showsProgress, session.stop);
        const auto facts = kind.value() == InputKind::Index
                               ? factsOfIndex(path_)
                               : factsOfVolume(path_, volume_.readOptions(), bar.job());
        bar.wipe();
        if (!facts.isOk())
            return facts.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(facts.value()));
        else
            session.output.write(textOf(facts.value()));
        return {};
    }

private:
    std::string path_;
    VolumeOptions volume_;
};

} // namespace

std::unique_ptr<Command> makeInfoCommand() { return std::make_unique<InfoCommand>(); }

} // namespace isoslider::cli
