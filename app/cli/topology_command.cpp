#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/asked_isovalue.h"
#include "app/cli/command.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/progress_bar.h"
#include "app/cli/standard_input.h"
#include "app/cli/volume_options_check.h"
#include "core/base/folders.h"
#include "core/base/memory_limit.h"
#include "core/base/plain_text.h"
#include "core/grid/classification.h"
#include "core/topology/index_topology.h"
#include "core/topology/stored_topology.h"
#include "core/topology/topology_queries.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

constexpr std::int64_t kMostEvents = std::int64_t{1} << 40;
constexpr int kCurveSteps = 256;

bool hasFiniteSample(const ScalarGrid& grid) {
    return grid.visit([](auto values) {
        return std::any_of(values.begin(), values.end(), [](auto sample) { return !isMissing(sample); });
    });
}

// `areExact`, here and below: else tunnels are not known, as samples are missing.
Json countsJson(const topology::SurfaceCounts& counts, bool areExact) {
    Json json;
    json["components"] = counts.components;
    json["euler"] = counts.euler;
    json["boundary_loops"] = counts.loops;
    json["handles"] = areExact ? Json(counts.handles()) : Json();
    json["voids"] = counts.voids;
    return json;
}

Json eventJson(const topology::TopologyEvent& event, bool areExact) {
    Json json;
    json["isovalue"] = event.isovalue;
    json["kind"] = topology::eventKindName(event.kind);
    json["position"] = event.position;
    json["before"] = countsJson(event.below, areExact);
    json["after"] = countsJson(event.above, areExact);
    json["persistence"] = event.persistence;
    json["births"] = event.pieces.births;
    json["deaths"] = event.pieces.deaths;
    json["joins"] = event.pieces.joins;
    json["splits"] = event.pieces.splits;
    return json;
}

Json measuresJson(const topology::SurfaceMeasures& measures) {
    Json json;
    json["area"] = measures.area;
    json["volume"] = measures.volume;
    json["triangles"] = measures.triangles;
    json["mean_gradient"] = measures.gradient;
    return json;
}

std::string tunnelsText(const topology::SurfaceCounts& counts, bool areExact) {
    return areExact ? std::to_string(counts.handles()) : "unknown";
}

std::string countsText(const topology::SurfaceCounts& counts, bool areExact) {
    return fmt::format("{}, {}, {}, {}, Euler number {}", counted(counts.components, "piece"),
                       areExact ? counted(counts.handles(), "tunnel") : "unknown tunnels",
                       counted(counts.loops, "boundary loop"), counted(counts.voids, "void"), counts.euler);
}

class TopologyCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand(
            "topology", "Isovalues at which pieces, tunnels and boundary loops change, and what surfaces measure");
        addInput(*command, "FILE", path_, "volume, or index; - for a volume from standard input");
        std::vector<CLI::Option*> questions;
        questions.push_back(addIsovalue(*command, "--at", askedAt_, "counts and measures at one isovalue"));
        questions.push_back(addInteger(*command, "--events", events_, 0, kMostEvents,
                                       "the N most notable events, ascending; 0: all of them"));
        hasEvents_ = questions.back();
        questions.push_back(command->add_flag(
            "--curves", showsCurves_,
            fmt::format("counts and measures where surfaces were measured, else at {} even steps", kCurveSteps + 1)));
        questions.push_back(addInteger(*command, "--pieces", pieces_, 0, kMostEvents, "isovalues with N pieces"));
        hasPieces_ = questions.back();
        questions.push_back(addInteger(*command, "--tunnels", tunnels_, 0, kMostEvents,
                                       "isovalues with N tunnels: of a closed surface the genus"));
        hasTunnels_ = questions.back();
        questions.push_back(addNumber(*command, "--area", area_, "isovalues of surfaces of this area"));
        questions.push_back(addNumber(*command, "--volume", enclosed_, "isovalues above which this volume lies"));
        questions.push_back(command
                                ->add_option_function<std::vector<std::string>>(
                                    "--between", [this](const std::vector<std::string>& ends) { setEnds(ends); },
                                    "what changes from one isovalue to another, and the volume between")
                                ->expected(2)
                                ->type_name("A B"));
        questions.push_back(
            command->add_flag("--suggest", suggests_, "isovalues worth a look, the best first, with a reason each"));
        for (CLI::Option* question : questions)
            for (CLI::Option* other : questions)
                if (question != other)
                    question->excludes(other);
        addVolumeOptions(*command, volume_);
        standardInput_.declare(*command, path_, InputContent::Volume);
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
        const auto summary = find(kind.value(), bar.job());
        bar.wipe();
        if (!summary.isOk()) {
            Error error = summary.error();
            error.path = error.path.empty() ? path_ : error.path;
            return error;
        }
        Answer answer;
        if (const Status status = describe(*summary.value(), answer); !status.isOk())
            return status.error();
        if (session.isJson)
            session.output.writeJson(answer.json);
        else
            session.output.write(answer.text);
        return {};
    }

private:
    using Summary = std::shared_ptr<const topology::TopologySummary>;
    struct Answer {
        Json json;
        std::string text;
    };

    void setEnds(const std::vector<std::string>& ends) {
        for (const std::string& end : ends) {
            askedBetween_.push_back(isovalueOrThrow("--between", end));
        }
        if (askedBetween_[0].isInDeviations != askedBetween_[1].isInDeviations)
            throw CLI::ValidationError("--between", "give both ends as values, or both in standard deviations");
        if (!(askedBetween_[0].number <= askedBetween_[1].number))
            throw CLI::ValidationError("--between", "the lesser isovalue comes first");
    }

    Status takeIsovalues(Result<std::vector<double>> values) {
        if (!values.isOk())
            return std::move(values).error();
        if (askedAt_)
            at_ = values.value().front();
        else
            between_ = std::move(values).value();
        return {};
    }

    // Of an index what was stored in it; else analysed now, and for the next time stored where that can be.
    Result<Summary> find(InputKind kind, const JobControl& job) {
        const auto asked = askedAt_ ? std::vector<AskedIsovalue>{*askedAt_} : askedBetween_;
        topology::AnalysisOptions options;
        options.memoryBytes = usableMemoryBytes() / 2;
        if (kind == InputKind::Index) {
            ISO_TRY(takeIsovalues(valuesOf(asked, path_, job)));
            auto found = topology::topologyOfIndex(path_, options, job);
            if (!found.isOk())
                return std::move(found).error();
            if (found.value().summary->hasEvents() || found.value().isNew)
                return std::move(found).value().summary;
            // Built with less memory than there is now, perhaps. What is known already serves where that fails.
            auto whole = topology::addEvents(path_, options, job);
            if (whole.isCancelled())
                return std::move(whole).error();
            return std::move(whole.isOk() ? whole : found).value().summary;
        }
        const JobControl reading = job.part(0.0, 0.3), analysing = job.part(0.3, 1.0);
        const auto grid = io::readVolume(path_, volume_.readOptions(), reading);
        if (!grid.isOk())
            return grid.error();
        if (!hasFiniteSample(*grid.value()))
            return makeError(ErrorCode::InvalidArgument, "has no finite sample", path_);
        ISO_TRY(takeIsovalues(valuesOf(asked, *grid.value(), path_, job)));
        options.measures = topology::planMeasures(*grid.value());
        auto curve = topology::analyseTopology(topology::planesOf(*grid.value()), options, analysing);
        if (!curve.isOk())
            return std::move(curve).error();
        return Summary(std::make_shared<topology::TopologyCurve>(std::move(curve).value()));
    }

    Status describe(const topology::TopologySummary& summary, Answer& answer) const {
        ISO_TRY(answerQuestion(summary, answer));
        if (!summary.hasEvents()) {
            answer.json["has_events"] = false;
            answer.text += "no events or persistence, which took more memory than there was: counts are those at the "
                           "next of some thousand isovalues\n";
        }
        if (!summary.areCountsExact()) {
            answer.json["counts_exact"] = false;
            answer.text += "samples are missing: pieces and boundary loops are at least as many, tunnels are unknown\n";
        }
        return {};
    }
    Status answerQuestion(const topology::TopologySummary& summary, Answer& answer) const {
        if (at_)
            return showAt(summary, answer);
        if (showsCurves_)
            return showCurves(summary, answer);
        if (*hasEvents_)
            return showEvents(summary, answer);
        if (*hasPieces_)
            return showIntervals(summary, answer, [this](const topology::SurfaceCounts& counts) {
                return counts.components == pieces_;
            });
        if (*hasTunnels_)
            return showIntervals(summary, answer,
                                 [this, areExact = summary.areCountsExact()](const topology::SurfaceCounts& counts) {
                                     return areExact && counts.handles() == tunnels_;
                                 });
        if (area_)
            return showIsovalues(summary, answer, &topology::SurfaceMeasures::area, *area_);
        if (enclosed_)
            return showIsovalues(summary, answer, &topology::SurfaceMeasures::volume, *enclosed_);
        if (!between_.empty())
            return showDifference(summary, answer);
        if (suggests_)
            return showSuggestions(summary, answer);
        answer.json["event_count"] = eventCountJson(summary);
        answer.json["events"] = Json::array();
        answer.text = !summary.hasEvents() ? std::string()
                                           : fmt::format("{}; see --at, --events, --curves and --suggest\n",
                                                         counted(summary.eventCount(), "event"));
        return {};
    }

    static Json eventCountJson(const topology::TopologySummary& summary) {
        return summary.hasEvents() ? Json(summary.eventCount()) : Json();
    }

    Status showAt(const topology::TopologySummary& summary, Answer& answer) const {
        const auto counts = summary.at(*at_);
        if (!counts.isOk())
            return counts.error();
        answer.json["isovalue"] = *at_;
        answer.json.update(countsJson(counts.value(), summary.areCountsExact()));
        answer.text = fmt::format("isovalue {}: {}\n", *at_, countsText(counts.value(), summary.areCountsExact()));
        if (!summary.curves().isEmpty()) {
            const topology::SurfaceMeasures measures = summary.curves().at(*at_);
            answer.json.update(measuresJson(measures));
            answer.text +=
                fmt::format("about: area {:.5g}, volume above {:.5g}, {:.0f} triangles, mean gradient {:.5g}\n",
                            measures.area, measures.volume, measures.triangles, measures.gradient);
        }
        return {};
    }

    Status showEvents(const topology::TopologySummary& summary, Answer& answer) const {
        const auto events =
            summary.mostNotable(events_ == 0 ? summary.eventCount() : static_cast<std::size_t>(events_));
        if (!events.isOk())
            return events.error();
        answer.json["event_count"] = eventCountJson(summary);
        answer.json["events"] = Json::array();
        answer.text = !summary.hasEvents()
                          ? std::string()
                          : fmt::format("{:>20} {:<12} {:>12} {:>18} {:>18} {:>18} {:>20}\n", "isovalue", "kind",
                                        "persistence", "pieces", "tunnels", "boundary loops", "near grid point");
        const auto change = [](std::int64_t before, std::int64_t after) {
            return before == after ? fmt::format("{}", before) : fmt::format("{} > {}", before, after);
        };
        for (const auto& [event, weight] : events.value()) {
            answer.json["events"].push_back(eventJson(event, summary.areCountsExact()));
            answer.text +=
                fmt::format("{:>20} {:<12} {:>12.5g} {:>18} {:>18} {:>18} {:>20}\n", event.isovalue,
                            topology::eventKindName(event.kind), event.persistence,
                            change(event.below.components, event.above.components),
                            summary.areCountsExact() ? change(event.below.handles(), event.above.handles()) : "unknown",
                            change(event.below.loops, event.above.loops),
                            fmt::format("{:g} {:g} {:g}", event.position[0], event.position[1], event.position[2]));
        }
        return {};
    }

    // Where the surface was measured, so that nothing is interpolated; even steps where it was not.
    static Result<std::vector<double>> stepsOf(const topology::TopologySummary& summary) {
        if (!summary.curves().isEmpty())
            return summary.curves().isovalues;
        std::optional<double> first;
        double last = 0.0;
        ISO_TRY(summary.visitEvents([&](const topology::TopologyEvent& event) {
            first = first.value_or(event.isovalue);
            last = event.isovalue;
            return true;
        }));
        std::vector<double> steps;
        for (int i = 0; first && i <= kCurveSteps; ++i) {
            const double part = static_cast<double>(i) / kCurveSteps;
            steps.push_back(*first * (1.0 - part) + last * part);
        }
        return steps;
    }

    static Status showCurves(const topology::TopologySummary& summary, Answer& answer) {
        const auto steps = stepsOf(summary);
        if (!steps.isOk())
            return steps.error();
        for (const char* name : {"isovalue", "components", "euler", "boundary_loops", "handles", "voids"})
            answer.json[name] = Json::array();
        const bool isMeasured = !summary.curves().isEmpty();
        answer.text = fmt::format("{:>20} {:>10} {:>10} {:>14} {:>8} {:>12}", "isovalue", "pieces", "tunnels",
                                  "boundary loops", "voids", "Euler number");
        if (isMeasured)
            answer.text +=
                fmt::format(" {:>12} {:>12} {:>10} {:>12}", "area", "volume above", "triangles", "mean gradient");
        answer.text += '\n';
        for (const double isovalue : steps.value()) {
            const auto counts = summary.at(isovalue);
            if (!counts.isOk())
                return counts.error();
            answer.json["isovalue"].push_back(isovalue);
            Json all = countsJson(counts.value(), summary.areCountsExact());
            answer.text += fmt::format("{:>20} {:>10} {:>10} {:>14} {:>8} {:>12}", isovalue, counts.value().components,
                                       tunnelsText(counts.value(), summary.areCountsExact()), counts.value().loops,
                                       counts.value().voids, counts.value().euler);
            if (isMeasured) {
                const topology::SurfaceMeasures measures = summary.curves().at(isovalue);
                all.update(measuresJson(measures));
                answer.text += fmt::format(" {:>12.5g} {:>12.5g} {:>10.0f} {:>12.5g}", measures.area, measures.volume,
                                           measures.triangles, measures.gradient);
            }
            answer.text += '\n';
            for (const auto& [name, value] : all.items())
                answer.json[name].push_back(value);
        }
        return {};
    }

    static Status showIntervals(const topology::TopologySummary& summary, Answer& answer,
                                const std::function<bool(const topology::SurfaceCounts&)>& isWanted) {
        const auto intervals = topology::intervalsWith(summary, isWanted);
        if (!intervals.isOk())
            return intervals.error();
        answer.json["intervals"] = Json::array();
        for (const auto& interval : intervals.value()) {
            answer.json["intervals"].push_back({interval.below, interval.above});
            answer.text += fmt::format("above {} up to {}\n", interval.below, interval.above);
        }
        if (intervals.value().empty())
            answer.text = "no isovalue has so many\n";
        return {};
    }

    static Status showIsovalues(const topology::TopologySummary& summary, Answer& answer,
                                double topology::SurfaceMeasures::*measure, double value) {
        if (summary.curves().isEmpty()) {
            answer.json["isovalues"] = Json();
            answer.text = "not measured: the volume has no surface, or values too large or too close to reckon with\n";
            return {};
        }
        const std::vector<double> isovalues = topology::isovaluesWith(summary.curves(), measure, value);
        answer.json["isovalues"] = isovalues;
        for (const double isovalue : isovalues)
            answer.text += fmt::format("{}\n", isovalue);
        if (isovalues.empty())
            answer.text = "no isovalue has exactly so much\n";
        return {};
    }

    Status showDifference(const topology::TopologySummary& summary, Answer& answer) const {
        const auto found = topology::difference(summary, between_[0], between_[1]);
        if (!found.isOk())
            return found.error();
        const topology::SurfaceDifference& difference = found.value();
        answer.json["from"] = countsJson(difference.from, summary.areCountsExact());
        answer.json["to"] = countsJson(difference.to, summary.areCountsExact());
        answer.json["volume_between"] = summary.curves().isEmpty() ? Json() : Json(difference.volume);
        answer.text =
            fmt::format("{}: {}\n{}: {}\n", between_[0], countsText(difference.from, summary.areCountsExact()),
                        between_[1], countsText(difference.to, summary.areCountsExact()));
        if (summary.hasEvents()) {
            answer.json["events"] = difference.events;
            answer.json["births"] = difference.births;
            answer.json["deaths"] = difference.deaths;
            answer.json["joins"] = difference.joins;
            answer.json["splits"] = difference.splits;
            answer.text +=
                fmt::format("{}: pieces come {}, go {}, join {}, split {}\n", counted(difference.events, "event"),
                            counted(difference.births, "time"), counted(difference.deaths, "time"),
                            counted(difference.joins, "time"), counted(difference.splits, "time"));
        }
        if (!summary.curves().isEmpty())
            answer.text += fmt::format("volume between: about {:.5g}\n", difference.volume);
        return {};
    }

    static Status showSuggestions(const topology::TopologySummary& summary, Answer& answer) {
        const auto suggestions = topology::suggestIsovalues(summary);
        if (!suggestions.isOk())
            return suggestions.error();
        answer.json["suggestions"] = Json::array();
        for (const auto& suggestion : suggestions.value()) {
            answer.json["suggestions"].push_back(
                {{"isovalue", suggestion.isovalue}, {"reason", topology::reasonText(suggestion.reason)}});
            answer.text += fmt::format("{:>20}  {}\n", suggestion.isovalue, topology::reasonText(suggestion.reason));
        }
        if (suggestions.value().empty())
            answer.text = "none: the volume has no surface\n";
        return {};
    }

    std::string path_;
    StandardInput standardInput_;
    std::optional<AskedIsovalue> askedAt_;
    std::optional<double> at_, area_, enclosed_;
    std::int64_t events_ = 0, pieces_ = 0, tunnels_ = 0;
    const CLI::Option *hasEvents_ = nullptr, *hasPieces_ = nullptr, *hasTunnels_ = nullptr;
    bool showsCurves_ = false, suggests_ = false;
    std::vector<AskedIsovalue> askedBetween_;
    std::vector<double> between_;
    VolumeOptions volume_;
};

} // namespace

std::unique_ptr<Command> makeTopologyCommand() { return std::make_unique<TopologyCommand>(); }

} // namespace isoslider::cli
