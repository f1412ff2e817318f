#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/command.h"
#include "app/cli/input_kind.h"
#include "app/cli/options.h"
#include "app/cli/progress_bar.h"
#include "core/index/sample_store.h"
#include "core/topology/topology_analysis.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::cli {
namespace {

constexpr std::int64_t kMostEvents = std::int64_t{1} << 40;
constexpr int kCurveSteps = 256;

Json countsJson(const topology::SurfaceCounts& counts) {
    Json json;
    json["components"] = counts.components;
    json["euler"] = counts.euler;
    json["boundary_loops"] = counts.loops;
    json["handles"] = counts.handles();
    json["voids"] = counts.voids;
    return json;
}

Json eventJson(const topology::TopologyEvent& event) {
    Json json;
    json["isovalue"] = event.isovalue;
    json["kind"] = topology::eventKindName(event.kind);
    json["position"] = event.position;
    json["before"] = countsJson(event.below);
    json["after"] = countsJson(event.above);
    json["persistence"] = event.persistence;
    return json;
}

std::string countsText(const topology::SurfaceCounts& counts) {
    return fmt::format("{} pieces, {} tunnels, {} boundary loops, {} voids, Euler number {}", counts.components,
                       counts.handles(), counts.loops, counts.voids, counts.euler);
}

class TopologyCommand final : public Command {
public:
    CLI::App* declare(CLI::App& program) override {
        auto* command = program.add_subcommand(
            "topology", "Isovalues at which pieces, tunnels and boundary loops change, and how many there are");
        command->add_option("FILE", path_, "volume, or index of metacells")->required()->type_name("");
        auto* at = addNumber(*command, "--at", at_, "the counts at one isovalue");
        auto* events = addInteger(*command, "--events", events_, 0, kMostEvents,
                                  "the N most persistent events, ascending; 0: all of them");
        command->add_flag("--curves", showsCurves_, fmt::format("the counts at {} even steps", kCurveSteps + 1))
            ->excludes(at)
            ->excludes(events);
        at->excludes(events);
        hasEvents_ = events;
        addVolumeOptions(*command, volume_);
        return command;
    }

    Outcome run(Session& session) override {
        ProgressBar bar(session.showsProgress, session.stop);
        const JobControl job = bar.job();
        const JobControl reading = job.part(0.0, 0.3), analysing = job.part(0.3, 1.0);
        const auto grid = read(reading);
        if (!grid.isOk())
            return grid.error();
        topology::AnalysisOptions options;
        options.measures = topology::planMeasures(*grid.value());
        const auto curve = topology::analyseTopology(topology::planesOf(*grid.value()), options, analysing);
        bar.wipe();
        if (!curve.isOk()) {
            Error error = curve.error();
            error.path = error.path.empty() ? path_ : error.path;
            return error;
        }
        if (session.isJson)
            session.output.writeJson(jsonOf(curve.value()));
        else
            session.output.write(textOf(curve.value()));
        return {};
    }

private:
    Result<std::shared_ptr<const ScalarGrid>> read(const JobControl& job) const {
        const auto kind = sniffInput(path_, volume_.readOptions());
        if (!kind.isOk())
            return kind.error();
        if (kind.value() == InputKind::Volume)
            return io::readVolume(path_, volume_.readOptions(), job);
        const auto reader = index::IndexReader::open(path_);
        if (!reader.isOk())
            return reader.error();
        if (reader.value()->info().kind != index::IndexKind::Metacells)
            return makeError(ErrorCode::InvalidArgument, "an index of edges holds no samples; give the volume", path_);
        return index::readSamples(*reader.value(), job);
    }

    std::vector<topology::TopologyEvent> chosen(const topology::TopologyCurve& curve) const {
        std::vector<topology::TopologyEvent> events = curve.events();
        const auto count = static_cast<std::size_t>(events_);
        if (events_ == 0 || count >= events.size())
            return events;
        std::stable_sort(events.begin(), events.end(),
                         [](const auto& a, const auto& b) { return a.persistence > b.persistence; });
        events.resize(count);
        std::sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.isovalue < b.isovalue; });
        return events;
    }

    // Even steps from the first event to the last.
    static std::vector<double> stepsOf(const topology::TopologyCurve& curve) {
        std::vector<double> steps;
        if (curve.events().empty())
            return steps;
        const double first = curve.events().front().isovalue, last = curve.events().back().isovalue;
        for (int i = 0; i <= kCurveSteps; ++i) {
            const double part = static_cast<double>(i) / kCurveSteps;
            steps.push_back(first * (1.0 - part) + last * part);
        }
        return steps;
    }

    Json jsonOf(const topology::TopologyCurve& curve) const {
        Json json;
        if (at_) {
            json["isovalue"] = *at_;
            json.update(countsJson(curve.countsAt(*at_)));
        } else if (showsCurves_) {
            for (const char* name : {"isovalue", "components", "euler", "boundary_loops", "handles", "voids"})
                json[name] = Json::array();
            for (const double isovalue : stepsOf(curve)) {
                json["isovalue"].push_back(isovalue);
                const Json counts = countsJson(curve.countsAt(isovalue));
                for (const auto& [name, count] : counts.items())
                    json[name].push_back(count);
            }
        } else {
            json["event_count"] = curve.events().size();
            json["events"] = Json::array();
            if (*hasEvents_)
                for (const auto& event : chosen(curve))
                    json["events"].push_back(eventJson(event));
        }
        return json;
    }

    std::string textOf(const topology::TopologyCurve& curve) const {
        if (at_)
            return fmt::format("isovalue {}: {}\n", *at_, countsText(curve.countsAt(*at_)));
        std::string text;
        if (showsCurves_) {
            text = fmt::format("{:>14} {:>12} {:>12} {:>14} {:>8} {:>12}\n", "isovalue", "pieces", "tunnels",
                               "boundary loops", "voids", "Euler number");
            for (const double isovalue : stepsOf(curve)) {
                const topology::SurfaceCounts counts = curve.countsAt(isovalue);
                text += fmt::format("{:>14.7g} {:>12} {:>12} {:>14} {:>8} {:>12}\n", isovalue, counts.components,
                                    counts.handles(), counts.loops, counts.voids, counts.euler);
            }
            return text;
        }
        if (!*hasEvents_)
            return fmt::format("{} events; see --at, --events and --curves\n", curve.events().size());
        text = fmt::format("{:>14} {:<12} {:>12} {:>18} {:>18} {:>18} {:>20}\n", "isovalue", "kind", "persistence",
                           "pieces", "tunnels", "boundary loops", "near grid point");
        const auto change = [](std::int64_t before, std::int64_t after) {
            return before == after ? fmt::format("{}", before) : fmt::format("{} > {}", before, after);
        };
        for (const auto& event : chosen(curve))
            text += fmt::format("{:>14.7g} {:<12} {:>12.5g} {:>18} {:>18} {:>18} {:>20}\n", event.isovalue,
                                topology::eventKindName(event.kind), event.persistence,
                                change(event.below.components, event.above.components),
                                change(event.below.handles(), event.above.handles()),
                                change(event.below.loops, event.above.loops),
                                fmt::format("{:g} {:g} {:g}", event.position[0], event.position[1], event.position[2]));
        return text;
    }

    std::string path_;
    std::optional<double> at_;
    std::int64_t events_ = 0;
    const CLI::Option* hasEvents_ = nullptr;
    bool showsCurves_ = false;
    VolumeOptions volume_;
};

} // namespace

std::unique_ptr<Command> makeTopologyCommand() { return std::make_unique<TopologyCommand>(); }

} // namespace isoslider::cli
