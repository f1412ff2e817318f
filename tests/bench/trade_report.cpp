#include "tests/bench/trade_report.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "app/cli/report/text_table.h"
#include "tests/bench/timing.h"

namespace isoslider::bench {
namespace {

using cli::numberOrDash;
using cli::TextTable;

constexpr double kMega = 1024.0 * 1024.0;

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / kMega; }

const EngineRow* find(const std::vector<EngineRow>& rows, const std::string& name) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const EngineRow& row) { return row.name == name; });
    return found == rows.end() ? nullptr : &*found;
}

double medianOf(const EngineRow* row) { return row ? row->times.median : 0.0; }

double ratioOf(const SlideRow& row, const std::string& name) {
    const EngineRow* engine = find(row.engines, name);
    return engine && engine->times.median > 0.0 ? row.ratio(*engine) : 0.0;
}

double coldRatioOf(const TradeRow& row, const std::string& name) { return row.cold ? ratioOf(*row.cold, name) : 0.0; }

double peerMs(const SlideRow& row) { return row.peer ? row.peer->times.median : 0.0; }

std::string render(const TextTable& table, TextForm form) {
    return form == TextForm::Markdown ? table.asMarkdown() : table.asText();
}

// Growth over the largest number of active edges, less what may be kept of the index; 0 within that.
double bytesPerEdgeBeyond(const WayCost& way) {
    const std::uint64_t grown = way.probe.grownBytes();
    return grown > way.cacheBytes && way.probe.mostEdges > 0
               ? static_cast<double>(grown - way.cacheBytes) / static_cast<double>(way.probe.mostEdges)
               : 0.0;
}

std::vector<std::string> skippedLine(const TradeReport& report, const WayCost& way) {
    std::vector<std::string> line(16, "-");
    line[0] = report.volume;
    line[1] = way.name;
    line[2] = fmt::format("~{:.2f}", way.predictedBytes / static_cast<double>(report.file.points()));
    line[3] = fmt::format("~{:.2f}", way.predictedBytes / static_cast<double>(report.file.sizeBytes()));
    line[4] = "skipped";
    return line;
}

std::vector<std::string> costLine(const TradeReport& report, const WayCost& way) {
    if (way.isSkipped)
        return skippedLine(report, way);
    const double seconds = way.build.seconds, index = static_cast<double>(way.indexBytes);
    return {report.volume,
            way.name,
            numberOrDash(index / static_cast<double>(report.file.points()), 2),
            numberOrDash(index / static_cast<double>(report.file.sizeBytes()), 2),
            numberOrDash(seconds, 2),
            numberOrDash(seconds / report.yardstick.referenceSynced(), 2),
            numberOrDash(seconds / report.yardstick.reference(), 2),
            numberOrDash(megabytes(way.build.peakBytes), 0),
            numberOrDash(static_cast<double>(way.build.peakBytes) / static_cast<double>(report.memoryBytes), 2),
            numberOrDash(way.probe.openMs, 1),
            numberOrDash(way.probe.firstSurfaceMs, 1),
            numberOrDash(way.firstColdMs, 1),
            numberOrDash(megabytes(way.probe.grownBytes()), 0),
            numberOrDash(megabytes(way.cacheBytes), 0),
            numberOrDash(way.probe.bytesPerEdgeAfterSlide(), 0),
            numberOrDash(bytesPerEdgeBeyond(way), 0)};
}

std::string costTable(const TradeReport& report, TextForm form) {
    TextTable table({"volume", "kind", "B/voxel", "x raw", "build s", "x synced", "x plain", "peak MB", "/budget",
                     "open ms", "first ms", "cold first", "grown MB", "bound MB", "B/edge", "beyond"},
                    2);
    for (const WayCost& way : report.ways)
        table.add(costLine(report, way));
    return render(table, form);
}

std::string stepTable(const TradeReport& report, TextForm form) {
    TextTable table({"volume", "step %", "kind", "K", "changed", "warm ms", "peer ms", "ratio", "cold ms", "cold peer",
                     "cold ratio", "cold KB", "disk ms", "ahead ms", "ahead KB"},
                    3);
    for (const TradeRow& row : report.rows)
        for (const EngineRow& engine : row.warm.engines) {
            const EngineRow* cold = row.cold ? find(row.cold->engines, engine.name) : nullptr;
            const EngineRow* ahead = find(row.ahead, engine.name);
            table.add({report.volume, fmt::format("{:g}", row.warm.percent), engine.name,
                       fmt::format("{:.0f}", engine.activeEdges), fmt::format("{:.0f}", engine.edgesChanged),
                       numberOrDash(engine.times.median, 2), numberOrDash(peerMs(row.warm), 2),
                       numberOrDash(ratioOf(row.warm, engine.name), 2), numberOrDash(medianOf(cold), 2),
                       numberOrDash(cold ? peerMs(*row.cold) : 0.0, 2), numberOrDash(coldRatioOf(row, engine.name), 2),
                       numberOrDash(cold ? cold->bytesRead / 1024 : 0.0, 0),
                       numberOrDash(medianOf(find(row.onDisk, engine.name)), 2), numberOrDash(medianOf(ahead), 2),
                       numberOrDash(ahead ? ahead->bytesAhead / 1024 : 0.0, 0)});
        }
    return render(table, form);
}

struct Ratios {
    std::vector<double> warm, cold;
};

std::string least(const std::vector<double>& values) {
    return values.empty() ? "-" : fmt::format("{:.2f}", *std::min_element(values.begin(), values.end()));
}

} // namespace

bool TradeRow::agrees() const { return warm.disagreements == 0 && (!cold || cold->disagreements == 0); }

bool TradeReport::agrees() const {
    return std::all_of(rows.begin(), rows.end(), [](const TradeRow& row) { return row.agrees(); });
}

std::string describe(const TradeReport& report, TextForm form) {
    const auto& dims = report.file.dims;
    const Yardstick& yard = report.yardstick;
    const char* heading = form == TextForm::Markdown ? "### " : "";
    std::string out = fmt::format("\n{}{}: {} x {} x {} {}, {:.1f} MB\n\n", heading, report.volume, dims[0], dims[1],
                                  dims[2], scalarTypeName(report.file.type), megabytes(report.file.sizeBytes()));
    out += fmt::format("Copy of its file {:.3f} s, synced {:.3f} s; one pass over its samples {:.3f} s. 2 copies and a "
                       "pass: {:.3f} s synced, {:.3f} s plain. Builds may use {:.0f} MB. Other programs kept {:.2f} "
                       "processors busy.\n",
                       yard.copy, yard.copySynced, yard.pass, yard.referenceSynced(), yard.reference(),
                       megabytes(report.memoryBytes), report.othersBusy);
    for (const WayCost& way : report.ways)
        if (way.isSkipped)
            out += fmt::format("No {}: predicted {:.0f} MB from the same field at a smaller size.\n", way.name,
                               way.predictedBytes / kMega);
    if (report.peerIsLeftOut)
        out += "No peer: the volume is larger than --peer-bytes.\n";
    if (!report.agrees())
        out += "CONTESTANTS DISAGREE on vertices or triangles.\n";
    return out + "\n" + costTable(report, form) + "\n" + stepTable(report, form);
}

std::string summarise(const std::vector<TradeReport>& reports, TextForm form) {
    std::map<double, std::map<std::string, Ratios>> all;
    for (const TradeReport& report : reports)
        for (const TradeRow& row : report.rows)
            for (const EngineRow& engine : row.warm.engines) {
                Ratios& ratios = all[row.warm.percent][engine.name];
                if (const double warm = ratioOf(row.warm, engine.name); warm > 0.0)
                    ratios.warm.push_back(warm);
                if (const double cold = coldRatioOf(row, engine.name); cold > 0.0)
                    ratios.cold.push_back(cold);
            }
    TextTable table({"step %", "kind", "volumes", "warm mean", "warm least", "cold mean", "cold least"}, 2);
    for (const auto& [percent, byName] : all)
        for (const auto& [name, ratios] : byName)
            table.add({fmt::format("{:g}", percent), name, std::to_string(ratios.warm.size()),
                       numberOrDash(geometricMean(ratios.warm), 2), least(ratios.warm),
                       numberOrDash(geometricMean(ratios.cold), 2), least(ratios.cold)});
    const char* heading = form == TextForm::Markdown ? "### " : "";
    return fmt::format("\n{}Times faster than the peer, geometric mean over the volumes\n\n{}", heading,
                       render(table, form));
}

std::string tradeCsvHeading() {
    return "volume,nx,ny,nz,type,kind,threads,pct,steps,index_bytes,predicted_bytes,build_s,copy_s,copy_synced_s,"
           "pass_s,build_peak_bytes,build_memory_bytes,open_ms,first_ms,first_cold_ms,grown_bytes,bound_bytes,"
           "most_edges,edges,changed,warm_ms,warm_p95_ms,peer_ms,cold_ms,cold_p95_ms,cold_peer_ms,cold_bytes,"
           "cold_chunks,disk_ms,ahead_ms,ahead_bytes,others_busy\n";
}

std::string tradeCsv(const TradeReport& report, int threads) {
    std::string out;
    const auto& dims = report.file.dims;
    const Yardstick& yard = report.yardstick;
    for (const WayCost& way : report.ways) {
        const std::string cost =
            fmt::format("{},{:.0f},{:.3f},{:.4f},{:.4f},{:.4f},{},{},{:.2f},{:.2f},{:.2f},{},{},{}", way.indexBytes,
                        way.predictedBytes, way.build.seconds, yard.copy, yard.copySynced, yard.pass,
                        way.build.peakBytes, report.memoryBytes, way.probe.openMs, way.probe.firstSurfaceMs,
                        way.firstColdMs, way.probe.grownBytes(), way.cacheBytes, way.probe.mostEdges);
        for (const TradeRow& row : report.rows) {
            const EngineRow* warm = find(row.warm.engines, way.name);
            const EngineRow none;
            const EngineRow& w = warm ? *warm : none;
            const EngineRow* cold = row.cold ? find(row.cold->engines, way.name) : nullptr;
            const EngineRow& c = cold ? *cold : none;
            const EngineRow* ahead = find(row.ahead, way.name);
            out += fmt::format("{},{},{},{},{},{},{},{:g},{},{},", report.volume, dims[0], dims[1], dims[2],
                               scalarTypeName(report.file.type), way.name, threads, row.warm.percent, row.warm.steps,
                               cost);
            out += fmt::format("{:.0f},{:.0f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.0f},{:.0f},", w.activeEdges,
                               w.edgesChanged, w.times.median, w.times.p95, peerMs(row.warm), c.times.median,
                               c.times.p95, row.cold ? peerMs(*row.cold) : 0.0, c.bytesRead, c.chunksRead);
            out += fmt::format("{:.3f},{:.3f},{:.0f},{:.2f}\n", medianOf(find(row.onDisk, way.name)), medianOf(ahead),
                               ahead ? ahead->bytesAhead : 0.0, report.othersBusy);
        }
    }
    return out;
}

} // namespace isoslider::bench
