#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/escaped_name.h"
#include "app/cli/number_parsing.h"
#include "app/cli/options.h"
#include "app/cli/progress_bar.h"
#include "app/cli/standard_input.h"
#include "app/cli/volume_options_check.h"
#include "core/base/plain_text.h"
#include "core/index/index_reader.h"
#include "core/index/validation/index_validation.h"
#include "core/topology/stored_topology_check.h"

namespace isoslider::cli {
namespace {

/// What was looked at, and what came of it.
struct Validated {
    index::ValidationReport report;
    topology::StoredTopologyCheck topology;

    std::uint64_t faultCount() const { return report.faultCount + topology.faults.size(); }
    /// Whatever volume it is of.
    bool isSound() const { return faultCount() == report.differences; }
    std::vector<index::IndexFault> faults() const {
        std::vector<index::IndexFault> all = report.faults;
        all.insert(all.end(), topology.faults.begin(), topology.faults.end());
        return all;
    }
};

Json faultJson(const index::IndexFault& fault) {
    Json json;
    json["part"] = fault.part;
    json["problem"] = fault.problem;
    if (fault.offset)
        json["offset"] = *fault.offset;
    if (fault.isovalues)
        json["isovalues"] = *fault.isovalues;
    if (fault.box)
        json["box"] = {{"first", fault.box->first}, {"last", fault.box->last}};
    return json;
}

class ValidateCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand("validate", "Whether an index is sound, and where it is not");
        addInput(*command, "INDEX", path_, "index to look at; - for standard input");
        command->add_flag("--full", isFull_, "besides the checksums, all that its parts state of each other");
        auto* against = command->add_option("--against", volumePath_,
                                            "volume that the index should be of: its samples are compared");
        requireName(against->type_name("VOLUME"), "the volume");
        addVolumeOptions(*command, volume_);
        for (CLI::Option* option : volume_.added) // they describe that volume, not the index
            option->needs(against);
        standardInput_.declare(*command, path_, InputContent::Index);
        return command;
    }

    Outcome run(Session& session) override {
        ISO_CLI_TRY(standardInput_.fetch(session));
        ProgressBar bar(session.showsProgress, session.stop);
        if (!volumePath_.empty())
            ISO_CLI_TRY(checkResampling(volume_.readOptions(), volumePath_, bar.job()));
        auto validated = validate(bar.job());
        bar.wipe();
        if (!validated.isOk())
            return validated.error();
        if (session.isJson)
            session.output.writeJson(jsonOf(validated.value()));
        else
            session.output.write(session.shown(textOf(validated.value())));
        const std::uint64_t count = validated.value().faultCount();
        if (count == 0)
            return {};
        const std::string verdict =
            validated.value().isSound() ? fmt::format("is sound, but not of {}: ", escapedName(volumePath_)) : "";
        const std::string first = verdict + validated.value().faults().front().line();
        const std::string more = count > 1 ? ", and " + counted(count - 1, "more fault") : "";
        return Outcome::foundFault(makeError(ErrorCode::InvalidArgument, first + more, path_).line());
    }

private:
    Result<Validated> validate(const JobControl& job) const {
        index::ValidationOptions options;
        options.isFull = isFull_;
        std::unique_ptr<io::VolumeSource> source;
        if (!volumePath_.empty()) {
            // What the index is comes first: a volume may take long to open.
            if (const auto opened = index::IndexReader::open(path_); !opened.isOk())
                return opened.error();
            auto volume = io::openVolume(volumePath_, volume_.readOptions(), job);
            if (!volume.isOk())
                return std::move(volume).error();
            source = std::move(volume).value();
            ISO_TRY(source->prepare(job));
            options.volume =
                index::ComparedVolume{source->info().geometry, source->info().type,
                                      [&source](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
                                          return source->readSlab(zBegin, zEnd, out);
                                      }};
        }
        auto report = index::validateIndex(path_, options, job);
        if (!report.isOk())
            return std::move(report).error();
        if (source)
            ISO_TRY(source->checkUnchanged());
        auto stored = topology::checkStoredTopology(path_, job);
        if (!stored.isOk())
            return std::move(stored).error();
        return Validated{std::move(report).value(), std::move(stored).value()};
    }

    Json jsonOf(const Validated& validated) const {
        const index::ValidationReport& report = validated.report;
        Json json;
        json["sound"] = validated.isSound();
        json["kind"] = index::indexKindName(report.info.kind);
        json["full"] = isFull_;
        if (!volumePath_.empty()) {
            json["against"] = volumePath_;
            json["compared"] = report.areSamplesCompared ? "samples" : "facts";
            json["differences"] = report.differences;
        }
        json["pages"] = report.pages;
        json["chunks"] = report.chunks;
        json["bytes"] = report.bytes;
        json["topology_events"] =
            validated.topology.isThere && validated.topology.hasEvents ? Json(validated.topology.events) : Json();
        json["fault_count"] = validated.faultCount();
        json["faults"] = Json::array();
        for (const index::IndexFault& fault : validated.faults())
            json["faults"].push_back(faultJson(fault));
        return json;
    }

    std::string textOf(const Validated& validated) const {
        std::string text;
        for (const index::IndexFault& fault : validated.faults())
            text += fault.line() + "\n";
        const auto described = validated.faults().size();
        if (validated.faultCount() > described)
            text += fmt::format("… and {} more\n", validated.faultCount() - described);
        const index::ValidationReport& report = validated.report;
        const std::string verdict = !validated.isSound()     ? "damaged"
                                    : report.differences > 0 ? "sound, but not of " + escapedName(volumePath_)
                                                             : "sound";
        text += fmt::format("{}: {}, {} of {} in {}", escapedName(path_), verdict, sizeText(report.bytes),
                            index::indexKindName(report.info.kind), counted(report.pages, "page"));
        if (report.chunks > 0)
            text += " and " + counted(report.chunks, "chunk");
        text += !validated.topology.isThere    ? ", no topology"
                : validated.topology.hasEvents ? ", " + counted(validated.topology.events, "event") + " of topology"
                                               : ", counts of topology without events";
        if (!isFull_)
            text += "; checksums only (--full: everything)";
        if (report.areSamplesCompared && report.info.mergeError > 0.0)
            text += "; which edges merged cells have is not compared with the volume";
        return text + "\n";
    }

    std::string path_;
    StandardInput standardInput_;
    std::string volumePath_;
    VolumeOptions volume_;
    bool isFull_ = false;
};

} // namespace

std::unique_ptr<Command> makeValidateCommand() { return std::make_unique<ValidateCommand>(); }

} // namespace isoslider::cli
