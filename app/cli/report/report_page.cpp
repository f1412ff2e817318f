#include "app/cli/report/report_page.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/geometry_text.h"
#include "app/cli/index_facts.h"
#include "app/cli/level_json.h"
#include "app/cli/lod_error.h"
#include "app/cli/report/line_plot.h"
#include "app/cli/report/text_table.h"

namespace isoslider::cli {
namespace {

using Measure = extract::MergeBound::Measure;

constexpr double kMega = 1e6;

// PAPER Tables 1 to 3 and Fig. 10.
constexpr const char* kPaper = R"(## The paper's own figures

Chhugani, Vishwanath, Cohen and Kumar, 2003, on a PC of 1.6 GHz. Their Table 3 is the time to update the surface, without
drawing it; their indexes merge cells within the error stated.

| model | resolution | distinct values | mean active edges | error % | build | disk |
|---|---|---:|---:|---:|---:|---:|
| RADMRI | 69 x 261 x 69 | 904,216 | 176,104 | 0.1 | 2.9 min | 21 MB |
| BluntFin | 256 x 256 x 256 | 54,268 | 402,918 | 0.2 | 5.1 min | 320 MB |
| Spherical Shell | 256 x 256 x 256 | 33,743 | 176,504 | 0.2 | 4.5 min | 300 MB |
| Boston Teapot | 256 x 256 x 256 | 236 | 320,382 | 0.7 | 16.4 min | 281 MB |
| CT Head Scan | 512 x 512 x 252 | 259 | 803,113 | 0.8 | 44.6 min | 800 MB |

| model | step % | edges changed | ms |
|---|---:|---:|---:|
| RADMRI | 0.1 | 3,500 | 8 |
| RADMRI | 1 | 29,316 | 70 |
| RADMRI | 5 | 88,481 | 210 |
| RADMRI | 10 | 116,296 | 270 |
| BluntFin | 1 | 64,185 | 140 |
| BluntFin | 2 | 80,068 | 200 |
| BluntFin | 5 | 76,877 | 190 |
| BluntFin | 10 | 71,453 | 170 |

| CT Head Scan, error % | triangles | % |
|---:|---:|---:|
| 0 | 740,249 | 100 |
| 0.3 | 645,153 | 87.2 |
| 0.8 | 536,856 | 72.5 |
| 1.5 | 80,197 | 10.8 |
)";

std::string groupedOrDash(std::uint64_t value) { return value > 0 ? grouped(value) : "-"; }

std::string rounded(double value) { return grouped(static_cast<std::uint64_t>(std::max(0.0, value) + 0.5)); }

// Three digits that count.
std::string timeText(double ms) {
    if (!(ms > 0.0))
        return "-";
    return ms >= 100.0 ? fmt::format("{:.0f}", ms) : fmt::format("{:.3g}", ms);
}

std::string errorText(const extract::MergeError& error) { return error.amount > 0.0 ? plainText(error) : "none"; }

// A pipe would end a cell of the table.
std::string cellText(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '|' || c == '\n' || c == '\r'; }, '_');
    return text;
}

std::string shareText(std::uint64_t part, std::uint64_t whole) {
    return part > 0 && whole > 0 ? fmt::format("{:.3g}", 100.0 * static_cast<double>(part) / static_cast<double>(whole))
                                 : "-";
}

std::string volumesTable(const std::vector<VolumeMeasures>& volumes) {
    TextTable table({"volume", "resolution", "type", "distinct values", "mean active edges", "missing samples", "MB"},
                    3);
    for (const VolumeMeasures& volume : volumes)
        table.add({cellText(volume.name), dimsText(volume.dims), std::string(scalarTypeName(volume.type)),
                   grouped(volume.facts.distinctValues), rounded(meanActiveEdges(volume.facts)),
                   grouped(volume.facts.nanCount),
                   fmt::format("{:.1f}", static_cast<double>(volume.fileBytes) / kMega)});
    return table.asMarkdown();
}

std::string indexesTable(const std::vector<VolumeMeasures>& volumes) {
    TextTable table(
        {"volume", "kind", "build s", "change per value", "levels", "redundancy k", "MB", "bytes/voxel", "x samples"},
        2);
    for (const VolumeMeasures& volume : volumes)
        for (const MeasuredIndex& index : volume.indexes) {
            if (!index.info) {
                table.add({cellText(volume.name), index::indexKindName(index.kind), "too large", "-", "-", "-", "-",
                           "-", "-"});
                continue;
            }
            const index::IndexInfo& info = *index.info;
            table.add(
                {cellText(volume.name), index::indexKindName(index.kind), fmt::format("{:.2f}", index.buildSeconds),
                 fmt::format("{:.1f} {}", meanChange(info), index.kind == index::IndexKind::Edges ? "edges" : "bricks"),
                 std::to_string(info.levels.size()), fmt::format("{:g}", info.redundancyThreshold),
                 fmt::format("{:.1f}", static_cast<double>(info.indexBytes) / kMega),
                 fmt::format("{:.2f}", bytesPerPoint(info, info.indexBytes)),
                 fmt::format("{:.2f}", static_cast<double>(info.indexBytes) / static_cast<double>(volume.fileBytes))});
        }
    return table.asMarkdown();
}

std::string levelsTable(const std::vector<VolumeMeasures>& volumes) {
    TextTable table({"volume", "kind", "level", "blocks", "entries", "redundant", "MB"}, 2);
    for (const VolumeMeasures& volume : volumes)
        for (const MeasuredIndex& index : volume.indexes)
            for (std::size_t level = 0; index.info && level < index.info->levels.size(); ++level) {
                const index::SkipLevelInfo& facts = index.info->levels[level];
                table.add({cellText(volume.name), index::indexKindName(index.kind), std::to_string(level),
                           grouped(facts.blocks), grouped(facts.edges), grouped(facts.redundantRemoved),
                           fmt::format("{:.2f}", static_cast<double>(facts.bytes) / kMega)});
            }
    return table.asMarkdown();
}

const StepCost* costOf(const VolumeMeasures& volume, const MeasuredStep& step, index::IndexKind kind) {
    for (std::size_t k = 0; k < volume.indexes.size(); ++k)
        if (volume.indexes[k].kind == kind && step.byKind[k])
            return &*step.byKind[k];
    return nullptr;
}

std::string stepsTable(const std::vector<VolumeMeasures>& volumes) {
    TextTable table({"volume", "step %", "edges changed", "edges ms", "metacells ms", "afresh ms", "afresh / slide"},
                    1);
    for (const VolumeMeasures& volume : volumes)
        for (const MeasuredStep& step : volume.steps) {
            const StepCost* edges = costOf(volume, step, index::IndexKind::Edges);
            const StepCost* metacells = costOf(volume, step, index::IndexKind::Metacells);
            const StepCost* any = metacells != nullptr ? metacells : edges;
            double least = any != nullptr ? any->ms : 0.0;
            if (edges != nullptr)
                least = std::min(least, edges->ms);
            table.add({cellText(volume.name), fmt::format("{:g}", step.percent),
                       any != nullptr ? rounded(any->changedEdges) : "-", timeText(edges != nullptr ? edges->ms : 0.0),
                       timeText(metacells != nullptr ? metacells->ms : 0.0), timeText(step.freshMs),
                       step.freshMs > 0.0 && least > 0.0 ? fmt::format("{:.1f}", step.freshMs / least) : "-"});
        }
    return table.asMarkdown();
}

std::string errorsTable(const std::vector<VolumeMeasures>& volumes) {
    TextTable table({"volume", "isovalue", "error", "triangles, to 32", "%", "triangles, to 8", "%", "1 % step ms"}, 1);
    for (const VolumeMeasures& volume : volumes)
        for (const MeasuredError& row : volume.errors)
            table.add({cellText(volume.name), fmt::format("{:.6g}", volume.centre), errorText(row.error),
                       groupedOrDash(row.triangles), shareText(row.triangles, volume.errors.front().triangles),
                       groupedOrDash(row.trianglesOfSlide),
                       shareText(row.trianglesOfSlide, volume.errors.front().trianglesOfSlide), timeText(row.ms)});
    return table.asMarkdown();
}

LinePlot activeEdgesPlot(const std::vector<VolumeMeasures>& volumes) {
    LinePlot plot{"Active edges at each isovalue", "isovalue, % of the value range", "active edges", false, true, {}};
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        const auto& counts = volumes[v].facts.activeEdgesPerBin;
        LinePlot::Line line{volumes[v].name, {}, v, false, false};
        for (std::size_t bin = 1; bin < counts.size(); ++bin)
            line.points.emplace_back(100.0 * static_cast<double>(bin) / static_cast<double>(counts.size()),
                                     static_cast<double>(counts[bin]));
        plot.lines.push_back(std::move(line));
    }
    return plot;
}

LinePlot stepsPlot(const std::vector<VolumeMeasures>& volumes) {
    LinePlot plot{"Time of a step; dashed: the surface afresh", "step, % of the value range", "ms", true, true, {}};
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        LinePlot::Line slid{volumes[v].name, {}, v, false, true}, fresh{"", {}, v, true, false};
        for (const MeasuredStep& step : volumes[v].steps) {
            double least = 0.0;
            for (const auto& cost : step.byKind)
                if (cost && (least == 0.0 || cost->ms < least))
                    least = cost->ms;
            slid.points.emplace_back(step.percent, least);
            fresh.points.emplace_back(step.percent, step.freshMs);
        }
        plot.lines.push_back(std::move(slid));
        plot.lines.push_back(std::move(fresh));
    }
    return plot;
}

LinePlot trianglesPlot(const std::vector<VolumeMeasures>& volumes, Measure measure) {
    const bool isInCells = measure == Measure::Distance;
    LinePlot plot{"Triangles against error",
                  isInCells ? "error, cells" : "error, % of the value range",
                  "triangles, % of those without merging",
                  false,
                  false,
                  {}};
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        LinePlot::Line line{volumes[v].name, {}, v, false, true};
        for (const MeasuredError& row : volumes[v].errors) {
            const MeasuredError& whole = volumes[v].errors.front();
            const bool isOfVolume = whole.triangles > 0;
            const std::uint64_t all = isOfVolume ? whole.triangles : whole.trianglesOfSlide;
            if (all > 0 && (!(row.error.amount > 0.0) || row.error.measure == measure))
                line.points.emplace_back(
                    row.error.amount, 100.0 * static_cast<double>(isOfVolume ? row.triangles : row.trianglesOfSlide) /
                                          static_cast<double>(all));
        }
        plot.lines.push_back(std::move(line));
    }
    return plot;
}

Json stepJson(const VolumeMeasures& volume, const MeasuredStep& step) {
    Json json;
    json["percent"] = step.percent;
    for (std::size_t k = 0; k < volume.indexes.size(); ++k) {
        if (!step.byKind[k])
            continue;
        Json& cost = json[index::indexKindName(volume.indexes[k].kind)];
        cost["edges_changed"] = step.byKind[k]->changedEdges;
        cost["ms"] = step.byKind[k]->ms;
    }
    if (volume.isInMemory)
        json["fresh_ms"] = step.freshMs;
    return json;
}

Json errorJson(const VolumeMeasures& volume, const MeasuredError& row) {
    Json json;
    json["error"] = row.error.amount > 0.0 ? unitText(row.error) : "none";
    if (volume.isInMemory)
        json["triangles"] = row.triangles;
    json["triangles_of_slide"] = row.trianglesOfSlide;
    json["step_ms"] = row.ms;
    return json;
}

} // namespace

std::vector<std::string> plotNames(const std::string& stem) {
    return {stem + "_active_edges.svg", stem + "_steps.svg", stem + "_triangles.svg", stem + "_triangles_cells.svg"};
}

std::vector<ReportPlot> plotsOf(const std::vector<VolumeMeasures>& volumes, const std::string& stem) {
    const std::vector<std::string> names = plotNames(stem);
    return {{names[0], activeEdgesPlot(volumes).svg()},
            {names[1], stepsPlot(volumes).svg()},
            {names[2], trianglesPlot(volumes, Measure::Scalar).svg()},
            {names[3], trianglesPlot(volumes, Measure::Distance).svg()}};
}

std::string pageOf(const std::vector<VolumeMeasures>& volumes, const std::vector<ReportPlot>& plots) {
    const auto plot = [&](std::size_t i, std::string_view about) {
        // A target in angle brackets may hold blanks.
        return i < plots.size() ? fmt::format("\n![{}](<{}>)\n", about, plots[i].fileName) : std::string();
    };
    const bool isAllInMemory =
        std::all_of(volumes.begin(), volumes.end(), [](const VolumeMeasures& volume) { return volume.isInMemory; });
    std::string page = "# What these volumes cost and give\n\n";
    page +=
        fmt::format("Written by `isoslider-cli report` {} in the order of Tables 1 to 3 and Fig. 10 of Chhugani, "
                    "Vishwanath, Cohen and Kumar (2003). Times are of the machine that wrote it.{}\n\n",
                    ISOSLIDER_VERSION, isAllInMemory ? "" : " A dash stands for what wants more memory than there is.");
    page += "## Volumes (Table 1)\n\n" + volumesTable(volumes) + plot(0, "active edges at each isovalue");
    page +=
        "\n## Indexes (Table 2)\n\nBuilt without merging cells. The change per value is what comes and goes from one "
        "distinct value to the next: edges, or bricks of 8 x 8 x 8 points.\n\n" +
        indexesTable(volumes);
    page +=
        "\n### Levels of the skip lists\n\nEntries are edges, or bricks; those that cancel out in the blocks of the "
        "next level are redundant.\n\n" +
        levelsTable(volumes);
    page +=
        "\n## Steps (Table 3)\n\nA step ends when all that is drawn is in memory. Its edges changed are those "
        "activated and deactivated; mean of them, median of the times. Afresh: the whole surface from the volume in "
        "memory.\n\n" +
        stepsTable(volumes) + plot(1, "time of a step");
    page += "\n## Triangles against error (Fig. 10)\n\nAt the isovalue with the most active edges in the middle of the "
            "range. Cells are merged to 32 a side from the volume (`extract VOLUME`), to 8 a side while sliding.\n\n" +
            errorsTable(volumes) + plot(2, "triangles against error in % of the range") +
            plot(3, "triangles against error in cells");
    return page + "\n" + kPaper;
}

Json reportJson(const std::vector<VolumeMeasures>& volumes) {
    Json json;
    json["volumes"] = Json::array();
    for (const VolumeMeasures& volume : volumes) {
        Json entry;
        entry["name"] = volume.name;
        entry["dims"] = volume.dims;
        entry["scalar_type"] = scalarTypeName(volume.type);
        entry["distinct_values"] = volume.facts.distinctValues;
        entry["average_active_edges"] = meanActiveEdges(volume.facts);
        entry["isovalue"] = volume.centre;
        entry["indexes"] = Json::array();
        for (const MeasuredIndex& index : volume.indexes) {
            Json built;
            built["kind"] = index::indexKindName(index.kind);
            built["is_built"] = index.info.has_value();
            if (index.info) {
                built["seconds"] = index.buildSeconds;
                built["index_bytes"] = index.info->indexBytes;
                built["average_change"] = meanChange(*index.info);
                built["levels"] = levelsJson(*index.info);
            }
            entry["indexes"].push_back(std::move(built));
        }
        entry["steps"] = Json::array();
        for (const MeasuredStep& step : volume.steps)
            entry["steps"].push_back(stepJson(volume, step));
        entry["errors"] = Json::array();
        for (const MeasuredError& row : volume.errors)
            entry["errors"].push_back(errorJson(volume, row));
        json["volumes"].push_back(std::move(entry));
    }
    return json;
}

} // namespace isoslider::cli
