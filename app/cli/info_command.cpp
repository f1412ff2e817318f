#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/geometry_text.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/progress_bar.h"
#include "app/cli/resampling_report.h"
#include "app/cli/standard_input.h"
#include "app/cli/volume_options_check.h"
#include "core/base/folders.h"
#include "core/base/plain_text.h"
#include "core/index/index_distribution.h"
#include "core/volume_io/volume_contents.h"
#include "preprocess/volume_facts.h"

namespace isoslider::cli {
namespace {

constexpr std::uint64_t kDistinctBytes = std::uint64_t{512} << 20;
constexpr std::uint64_t kCountedSamples = std::uint64_t{1} << 24; // of an index: within a second
constexpr std::int64_t kMaxParts = 4096; // components and frames that are read one by one

/// The same facts for a volume and for an index of one.
struct Facts {
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    preprocess::VolumeFacts samples;
    std::string format;
    std::string fieldName;
    std::string fieldTitle;
    std::string lengthUnit;
    std::vector<std::string> notes;
    io::VolumeInfo volume; ///< of a volume: what is known of its resampling
    std::string resampling; ///< of an index: what resampling its volume lost
    bool isPatientSpace = false; ///< as io::VolumeInfo has it
};

/// One component or frame of a field that nobody has chosen from.
struct Part {
    std::optional<int> component;
    std::optional<std::int64_t> frame;
    Facts facts;
};

struct Report {
    std::optional<io::VolumeContents> contents; ///< of volumes
    std::vector<Part> parts; ///< one, or as many as there are to choose from
    std::int64_t partsInAll = 1; ///< parts are the first of these
    bool isChosen = true; ///< the one part is what other commands take
};

Result<Facts> factsOfIndex(const std::string& path, const JobControl& job) {
    const auto reader = index::IndexReader::open(path);
    if (!reader.isOk())
        return reader.error();
    const index::IndexInfo& info = reader.value()->info();
    // What cannot be read is not stated: `validate` is for finding damage.
    const auto values = index::distributionOf(*reader.value(), kCountedSamples, job);
    if (values.isCancelled())
        return cancelledError();
    const auto spread = values.isOk() ? std::optional(values.value().spread) : std::nullopt;
    Facts facts{
        info.geometry, info.type, {info.min, info.max, info.distinctValues, info.nanCount, spread}, "ISOSLIDER index"};
    facts.lengthUnit = info.lengthUnit;
    facts.resampling = info.resampling;
    facts.isPatientSpace = info.isPatientSpace;
    return facts;
}

Result<Report> reportOfIndex(const std::string& path, const JobControl& job) {
    auto facts = factsOfIndex(path, job);
    if (!facts.isOk())
        return std::move(facts).error();
    Report report;
    report.parts.push_back({std::nullopt, std::nullopt, std::move(facts).value()});
    return report;
}

Result<Facts> factsOfVolume(const std::string& path, const io::ReadOptions& options, const JobControl& job) {
    const auto source = io::openVolume(path, options, job);
    if (!source.isOk())
        return source.error();
    auto found = preprocess::findFacts(*source.value(), kDistinctBytes, job);
    if (!found.isOk())
        return std::move(found).error();
    if (const Status unchanged = source.value()->checkUnchanged(); !unchanged.isOk())
        return unchanged.error();
    if (std::isnan(found.value().min))
        return makeError(ErrorCode::InvalidArgument, "has no finite sample", path);
    const io::VolumeInfo& info = source.value()->info();
    std::vector<std::string> notes = info.notes;
    const GridDims& dims = info.geometry.dims;
    if (std::min({dims[0], dims[1], dims[2]}) < 2)
        notes.push_back("has no cells, so no surface: that takes two grid points along each axis");
    Facts facts{info.geometry,   info.type,       found.value(),    info.format, info.fieldName,
                info.fieldTitle, info.lengthUnit, std::move(notes), info};
    facts.isPatientSpace = info.isPatientSpace;
    return facts;
}

const io::VolumeField* fieldAsked(const io::VolumeContents& contents, const std::string& name) {
    if (name.empty())
        return contents.fields.size() == 1 || contents.isPreferredChosen ? &contents.fields[contents.preferred]
                                                                         : nullptr;
    for (const io::VolumeField& field : contents.fields)
        if (field.name == name)
            return &field;
    return nullptr;
}

/// Every component and frame that the options leave open.
Result<Report> reportOfVolume(const std::string& path, const io::ReadOptions& options, const JobControl& job) {
    Report report;
    const io::VolumeField* field = nullptr;
    if (!options.raw) {
        auto contents = io::listVolumes(path, options, job);
        if (!contents.isOk())
            return std::move(contents).error();
        report.contents = std::move(contents).value();
        field = fieldAsked(*report.contents, options.field);
        if (field == nullptr && options.field.empty()) {
            report.isChosen = false;
            return report;
        }
    }
    const int components = field != nullptr && !options.component ? field->components : 1;
    const std::int64_t frames = field != nullptr && !options.frame ? field->frames : 1;
    report.isChosen = components == 1 && frames == 1;
    report.partsInAll = components * frames;
    const std::int64_t read = std::min(report.partsInAll, kMaxParts);
    for (std::int64_t i = 0; i < read; ++i) {
        Part part;
        io::ReadOptions asked = options;
        if (components > 1)
            part.component = asked.component = static_cast<int>(i % components);
        if (frames > 1)
            part.frame = asked.frame = i / components;
        const JobControl reading = job.part(static_cast<double>(i) / static_cast<double>(read),
                                            static_cast<double>(i + 1) / static_cast<double>(read));
        auto facts = factsOfVolume(path, asked, reading);
        if (!facts.isOk())
            return std::move(facts).error();
        part.facts = std::move(facts).value();
        report.parts.push_back(std::move(part));
    }
    if (read < report.partsInAll)
        report.parts.front().facts.notes.push_back(fmt::format(
            "the first {} of {} components and frames have been read; the range is theirs", read, report.partsInAll));
    return report;
}

void addSpread(const preprocess::VolumeFacts& samples, Json& json) {
    if (!samples.spread)
        return;
    json["mean"] = samples.spread->mean;
    json["standard_deviation"] = samples.spread->deviation;
    if (!samples.spread->isExact)
        json["mean_is_estimated"] = true;
}

Json jsonOf(const Facts& facts) {
    Json json;
    json["dims"] = facts.geometry.dims;
    json["spacing"] = vectorJson(facts.geometry.spacing);
    json["origin"] = vectorJson(facts.geometry.origin);
    json["scalar_type"] = scalarTypeName(facts.type);
    json["min"] = facts.samples.min;
    json["max"] = facts.samples.max;
    addSpread(facts.samples, json);
    json["distinct_values"] = facts.samples.distinctValues;
    json["nan_count"] = facts.samples.missingSamples;
    json["format"] = facts.format;
    if (!facts.fieldName.empty())
        json["field"] = facts.fieldName;
    if (!facts.fieldTitle.empty())
        json["title"] = facts.fieldTitle;
    if (!facts.lengthUnit.empty())
        json["length_unit"] = facts.lengthUnit;
    if (facts.isPatientSpace)
        json["coordinates"] = "LPS";
    json["direction"] = {vectorJson(facts.geometry.direction[0]), vectorJson(facts.geometry.direction[1]),
                         vectorJson(facts.geometry.direction[2])};
    addResampling(facts.volume, json);
    addResampling(facts.resampling, json);
    return json;
}

Json jsonOf(const io::VolumeContents& contents) {
    Json fields = Json::array();
    for (const io::VolumeField& field : contents.fields) {
        Json json;
        json["name"] = field.name;
        if (!field.title.empty())
            json["title"] = field.title;
        json["dims"] = field.dims;
        json["type"] = field.typeName;
        json["components"] = field.components;
        if (!field.componentNames.empty())
            json["component_names"] = field.componentNames;
        json["frames"] = field.frames;
        json["resampled"] = field.isResampled;
        if (!field.problem.empty())
            json["problem"] = field.problem;
        fields.push_back(std::move(json));
    }
    return fields;
}

// With one part, its facts. With several, those of the first, the range of all, and each part's own.
Json jsonOf(const Report& report) {
    Json json;
    if (report.parts.empty())
        json["format"] = report.contents->format;
    else
        json = jsonOf(report.parts.front().facts);
    if (!report.isChosen && !report.parts.empty()) {
        Json parts = Json::array();
        for (const Part& part : report.parts) {
            const preprocess::VolumeFacts& samples = part.facts.samples;
            json["min"] = std::min(json["min"].get<double>(), samples.min);
            json["max"] = std::max(json["max"].get<double>(), samples.max);
            Json one;
            if (part.component)
                one["component"] = *part.component;
            if (part.frame)
                one["frame"] = *part.frame;
            one["min"] = samples.min;
            one["max"] = samples.max;
            addSpread(samples, one);
            one["distinct_values"] = samples.distinctValues;
            one["nan_count"] = samples.missingSamples;
            parts.push_back(std::move(one));
        }
        for (const char* name : {"mean", "standard_deviation"})
            json[name] = nullptr; // of what? Each part has its own
        json["distinct_values"] = nullptr;
        json["nan_count"] = nullptr;
        json["parts"] = std::move(parts);
        json["parts_in_all"] = report.partsInAll;
    }
    if (report.contents && (report.contents->fields.size() > 1 || report.contents->needsChoice()))
        json["fields"] = jsonOf(*report.contents);
    if (!report.parts.empty() && !report.parts.front().facts.notes.empty())
        json["notes"] = report.parts.front().facts.notes;
    return json;
}

std::string textOf(const Facts& facts) {
    std::string text = fmt::format("format           {}\n", facts.format);
    if (!facts.fieldName.empty())
        text += fmt::format("field            {}\n", oneLine(facts.fieldName));
    if (!facts.fieldTitle.empty())
        text += fmt::format("title            {}\n", oneLine(facts.fieldTitle));
    text += fmt::format("dims             {}\n", dimsText(facts.geometry.dims));
    const std::string unit = facts.lengthUnit.empty() ? "" : " " + facts.lengthUnit;
    text += fmt::format("spacing          {}{}\n", vectorText(facts.geometry.spacing), unit);
    text += fmt::format("origin           {}{}\n", vectorText(facts.geometry.origin), unit);
    if (facts.isPatientSpace)
        text += "coordinates      LPS: x to the left, y to posterior, z to superior\n";
    text += fmt::format("direction        {} | {} | {}\n", vectorText(facts.geometry.direction[0]),
                        vectorText(facts.geometry.direction[1]), vectorText(facts.geometry.direction[2]));
    text += fmt::format("scalar type      {}\n", scalarTypeName(facts.type));
    if (const std::string lost = facts.resampling + resamplingText(facts.volume); !lost.empty())
        text += fmt::format("resampled        {}\n", lost);
    return text;
}

std::string textOf(const preprocess::VolumeFacts& samples) {
    std::string text = fmt::format("range            {} .. {}\n", samples.min, samples.max);
    if (samples.spread) {
        const char* about = samples.spread->isExact ? "" : "about ";
        text += fmt::format("mean             {}{}\nstd. deviation   {}{}\n", about, samples.spread->mean, about,
                            samples.spread->deviation);
    }
    return text +
           fmt::format("distinct values  {}\nmissing samples  {}\n", samples.distinctValues, samples.missingSamples);
}

std::string textOf(const io::VolumeContents& contents) {
    std::string text;
    for (const io::VolumeField& field : contents.fields) {
        text += fmt::format("  {}  {}, {}", field.name.empty() ? "(no name)" : oneLine(field.name),
                            dimsText(field.dims), field.typeName);
        if (field.components > 1)
            text += fmt::format(", {} components", field.components);
        if (field.frames > 1)
            text += fmt::format(", {} frames", field.frames);
        if (field.isResampled)
            text += ", resampled";
        if (!field.title.empty())
            text += ": " + oneLine(field.title);
        if (!field.problem.empty())
            text += " (" + oneLine(field.problem) + ")";
        text += "\n";
    }
    return text;
}

std::string textOf(const Report& report) {
    std::string text = report.parts.empty() ? fmt::format("format           {}\n", report.contents->format)
                                            : textOf(report.parts.front().facts);
    for (const Part& part : report.parts) {
        if (part.component)
            text += fmt::format("--component {} ", *part.component);
        if (part.frame)
            text += fmt::format("--frame {}", *part.frame);
        text += (report.isChosen ? "" : "\n") + textOf(part.facts.samples);
    }
    if (report.contents && report.contents->fields.size() > 1)
        text += "fields, chosen by --field\n" + textOf(*report.contents);
    if (!report.parts.empty())
        for (const std::string& note : report.parts.front().facts.notes)
            text += fmt::format("note             {}\n", note);
    return text;
}

class InfoCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("info", "What a volume, or an index of one, contains");
        addInput(*command, "FILE", path_, "volume or index; - for standard input");
        addVolumeOptions(*command, volume_);
        standardInput_.declare(*command, path_, InputContent::VolumeOrIndex);
        return command;
    }

    Outcome run(Session& session) override {
        ISO_CLI_TRY(standardInput_.fetch(session, volume_, temporaryFolder()));
        const auto kind = sniffInput(path_, volume_.readOptions());
        if (!kind.isOk())
            return kind.error();
        ISO_CLI_TRY(checkVolumeOptions(volume_, kind.value(), path_));
        ProgressBar bar(session.showsProgress, session.stop);
        if (kind.value() == InputKind::Volume)
            ISO_CLI_TRY(checkResampling(volume_.readOptions(), path_, bar.job()));
        auto report = kind.value() == InputKind::Index ? reportOfIndex(path_, bar.job())
                                                       : reportOfVolume(path_, volume_.readOptions(), bar.job());
        bar.wipe();
        if (!report.isOk())
            return report.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(report.value()));
        else
            session.output.write(textOf(report.value()));
        return {};
    }

private:
    std::string path_;
    VolumeOptions volume_;
    StandardInput standardInput_;
};

} // namespace

std::unique_ptr<Command> makeInfoCommand() { return std::make_unique<InfoCommand>(); }

} // namespace isoslider::cli
