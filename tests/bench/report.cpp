#include "tests/bench/report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include <fmt/format.h>

#include "tests/bench/timing.h"

namespace isoslider::bench {
namespace {

constexpr double kMega = 1024.0 * 1024.0;

std::string shortName(const std::string& name) { return name.size() <= 16 ? name : name.substr(0, 15) + "~"; }

// One line of the table of figures: what is to be reached, and what was.
class FigureTable {
public:
    FigureTable() { fmt::print("\n{:<52} {:>12} {:>12}  {}\n", "figure", "to reach", "measured", "note"); }

    void atLeast(const std::string& what, double target, double measured, const std::string& note) {
        print(what, fmt::format(">= {:g}", target), measured, measured >= target, note);
    }
    void atMost(const std::string& what, double target, double measured, const std::string& note) {
        print(what, fmt::format("<= {:g}", target), measured, measured <= target, note);
    }

private:
    // Nothing is ever 0 that has been measured.
    void print(const std::string& what, const std::string& target, double measured, bool isReached,
               const std::string& note) {
        if (measured > 0.0)
            fmt::print("{:<52} {:>12} {:>12.4g}  {:<12} {}\n", what, target, measured,
                       isReached ? "reached" : "NOT REACHED", note);
        else
            fmt::print("{:<52} {:>12} {:>12}  not measured\n", what, target, "-");
    }
};

// The largest of something over rows or volumes, and where it is.
struct Extreme {
    double value = 0.0;
    std::string where;
    void takeLarger(double candidate, const std::string& at) {
        if (candidate > value) {
            value = candidate;
            where = at;
        }
    }
    void takeSmaller(double candidate, const std::string& at) {
        if (candidate > 0.0 && (value == 0.0 || candidate < value)) {
            value = candidate;
            where = at;
        }
    }
};

std::string placeOf(const SlideRow& row) { return fmt::format("{} {:g} %", row.volume, row.percent); }

/// Of steps whose end is a picture to draw, or arrays of floats.
enum class StepEnd { Picture, Arrays };

double ratioOf(const SlideRow& row, StepEnd end) { return end == StepEnd::Picture ? row.ratio() : row.arraysRatio(); }

std::map<double, std::vector<double>> ratiosByPercent(const std::vector<VolumeReport>& reports, StepEnd end) {
    std::map<double, std::vector<double>> ratios;
    for (const VolumeReport& report : reports)
        for (const SlideRow& row : report.rows)
            if (row.peer && row.ratio() > 0.0)
                ratios[row.percent].push_back(ratioOf(row, end));
    return ratios;
}

struct StepFigures {
    StepEnd end;
    const char* name;
    std::array<std::pair<double, double>, 4> least; ///< by % of the range
    double worst;
};
constexpr StepFigures kStepFigures[] = {
    {StepEnd::Picture, "step of {:g} %", {{{0.01, 40}, {0.1, 20}, {1, 10}, {10, 8}}}, 4},
    {StepEnd::Arrays, "step of {:g} % with V and N as floats", {{{0.01, 15}, {0.1, 12}, {1, 8}, {10, 6}}}, 3},
};

void printStepFigures(const std::vector<VolumeReport>& reports, bool isCold, FigureTable& table) {
    Extreme slowestUpdate, slowestInterpolation;
    for (const StepFigures& figures : kStepFigures) {
        const auto ratios = ratiosByPercent(reports, figures.end);
        for (const auto& [percent, target] : figures.least)
            if (const auto found = ratios.find(percent); !isCold && found != ratios.end())
                table.atLeast(fmt::format(fmt::runtime(figures.name), percent) + ", times the peer's speed", target,
                              geometricMean(found->second),
                              fmt::format("geometric mean of {} volumes", found->second.size()));
        Extreme worst;
        for (const VolumeReport& report : reports)
            for (const SlideRow& row : report.rows)
                worst.takeSmaller(ratioOf(row, figures.end), placeOf(row));
        const char* const kind = figures.end == StepEnd::Picture ? "worst row" : "worst row with V and N as floats";
        table.atLeast(fmt::format("{}{}, times the peer's speed", kind, isCold ? ", cold" : ""),
                      isCold ? 1.0 : figures.worst, worst.value, worst.where);
    }
    std::vector<double> updates, interpolations;
    for (const VolumeReport& report : reports)
        for (const SlideRow& row : report.rows) {
            slowestUpdate.takeLarger(row.ours().nsPerChange, placeOf(row));
            slowestInterpolation.takeLarger(row.withArrays().copyRatio(), placeOf(row));
            if (row.ours().nsPerChange > 0.0)
                updates.push_back(row.ours().nsPerChange);
            if (row.withArrays().copyRatio() > 0.0)
                interpolations.push_back(row.withArrays().copyRatio());
        }
    if (isCold)
        return;
    table.atMost("update, ns per changed edge", 100, geometricMean(updates),
                 fmt::format("geometric mean of rows; worst {:.0f}, {}", slowestUpdate.value, slowestUpdate.where));
    table.atMost("interpolation, times a copy of what it touches", 2, geometricMean(interpolations),
                 fmt::format("geometric mean of rows; worst {:.1f}, {}", slowestInterpolation.value,
                             slowestInterpolation.where));
}

void printVolumeFigures(const std::vector<VolumeReport>& reports, FigureTable& table) {
    Extreme memory, uncached, build, size, open, picture;
    for (const VolumeReport& report : reports) {
        const std::string& name = report.volume.name;
        memory.takeLarger(report.probe.bytesPerEdgeAfterSlide(), name);
        uncached.takeLarger(report.probeWithoutCache.bytesPerEdgeAfterSlide(), name);
        if (report.index.wasBuilt)
            build.takeLarger(report.index.buildSeconds / report.index.sortSeconds, name);
        size.takeLarger(report.index.bytesPerVoxel(), name);
        open.takeLarger(1e-3 * report.probe.firstSurfaceMs, name);
        picture.takeLarger(report.firstPictureSeconds, name);
    }
    table.atMost("memory while exploring, bytes per active edge", 110, memory.value,
                 fmt::format("{}, after a slide of 1 % steps; without page cache {:.0f}, {}", memory.where,
                             uncached.value, uncached.where));
    table.atMost("build, times one std::sort of (value, id)", 8, build.value, build.where);
    table.atMost("index, bytes per voxel", 40, size.value, size.where);
    table.atMost("open an index and show a surface, s", 0.05, open.value, open.where);
    table.atMost("first picture from a headerless file, s", 2, picture.value, picture.where);
}

} // namespace

void printVolume(const VolumeReport& report) {
    const auto& dims = report.volume.grid->dims();
    const PreparedIndex& index = report.index;
    fmt::print("\n{}: {} x {} x {} {}, {} distinct values, range [{:g}, {:g}], slides round {:g}\n", report.volume.name,
               dims[0], dims[1], dims[2], scalarTypeName(report.volume.grid->type()), index.info.distinctValues,
               report.volume.min, report.volume.max, report.volume.centre);
    if (index.wasBuilt)
        fmt::print("  build {:.2f} s, std::sort of (value, id) {:.2f} s, ratio {:.2f}; ", index.buildSeconds,
                   index.sortSeconds, index.buildSeconds / index.sortSeconds);
    else
        fmt::print("  index of an earlier run; ");
    fmt::print("{}: {:.1f} MB, {:.1f} bytes per voxel\n", index::indexKindName(index.info.kind),
               static_cast<double>(index.info.indexBytes) / kMega, index.bytesPerVoxel());
    const ProbeResult& probe = report.probe;
    fmt::print("  open {:.1f} ms, first surface {:.1f} ms after start; first picture of the raw volume {:.2f} s\n",
               probe.openMs, probe.firstSurfaceMs, report.firstPictureSeconds);
    fmt::print(
        "  memory over the empty program: {:.0f} bytes per active edge at the first surface ({} edges), {:.0f} after a slide "
        "of 1 % steps (most: {} edges), {:.0f} and {:.0f} without page cache; peak {:.0f} MB\n",
        probe.bytesPerEdgeAtFirst(), probe.firstEdges, probe.bytesPerEdgeAfterSlide(), probe.mostEdges,
        report.probeWithoutCache.bytesPerEdgeAtFirst(), report.probeWithoutCache.bytesPerEdgeAfterSlide(),
        static_cast<double>(probe.peakBytes) / kMega);
}

void printRowHeading() {
    fmt::print(
        "\n{:<16} {:>6} {:>9} {:>9} {:>7} {:>8} {:>7} {:>7} {:>9} {:>9} {:>7} {:>10} {:>8} {:>6} {:>4} {:>9} {:>8} {:>8}\n",
        "volume", "step %", "ours ms", "peer ms", "ratio", "V+N ms", "ratio", "ns/chg", "K", "changed", "tch/chg",
        "bytes", "sent KB", "/copy", "new", "flat ms", "ambig", "decided");
}

void printRow(const SlideRow& row) {
    const EngineRow& ours = row.ours();
    const auto orDash = [](bool exists, double value, int digits) {
        return exists ? fmt::format("{:.{}f}", value, digits) : std::string("-");
    };
    fmt::print(
        "{:<16} {:>6g} {:>9.2f} {:>9} {:>7} {:>8.2f} {:>7} {:>7} {:>9.0f} {:>9.0f} {:>7} {:>10.0f} {:>8.0f} {:>6.2f} {:>4} {:>9} {:>8.0f} {:>8.0f}{}\n",
        shortName(row.volume), row.percent, ours.times.median,
        orDash(row.peer.has_value(), row.peer ? row.peer->times.median : 0, 2),
        orDash(row.peer.has_value(), row.ratio(), 2), row.arraysMs(),
        orDash(row.peer.has_value(), row.arraysRatio(), 2), orDash(ours.nsPerChange > 0, ours.nsPerChange, 0),
        ours.activeEdges, ours.edgesChanged,
        orDash(ours.edgesChanged > 0, ours.edgesTouched / std::max(1.0, ours.edgesChanged), 2), ours.bytesRead,
        ours.sentBytes / 1024.0, row.withArrays().copyRatio(), ours.rebuilds,
        orDash(row.baseline.has_value(), row.baseline ? row.baseline->median : 0, 2), ours.ambiguousCells,
        ours.cellsResolved, row.disagreements > 0 ? fmt::format("  DISAGREES at {} steps", row.disagreements) : "");
    std::fflush(stdout);
}

void printSummary(const std::vector<VolumeReport>& reports, bool isCold) {
    fmt::print("\ntimes faster than the peer, geometric mean over {} volumes{}\n", reports.size(),
               isCold ? ", cold index" : "");
    for (const auto& [percent, ratios] : ratiosByPercent(reports, StepEnd::Picture))
        fmt::print("  {:>6g} %  {:7.2f}   lowest {:.2f}\n", percent, geometricMean(ratios),
                   *std::min_element(ratios.begin(), ratios.end()));
    FigureTable table;
    printStepFigures(reports, isCold, table);
    printVolumeFigures(reports, table);
    double most = 0.0;
    for (const VolumeReport& report : reports)
        most = std::max(most, report.othersBusy);
    fmt::print("\nother programs kept up to {:.2f} processors busy meanwhile{}\n", most,
               most > 0.3 ? ": ratios are rough, times mean nothing" : "");
}

std::string productCsv(const SlideRow& row, const VolumeReport& report, int threads) {
    const EngineRow& ours = row.ours();
    const Spread& t = ours.times;
    return fmt::format(
        "isoslider,TBB,{},{},{:g},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.0f},{:.0f},1,0.0,{:.1f},{},{}", threads,
        row.volume, row.percent, row.steps, t.median, t.p95, t.max, t.min, ours.firstMs, ours.triangles,
        ours.activeEdges, 1e3 * report.index.buildSeconds, report.probe.emptyBytes >> 20, report.probe.peakBytes >> 20);
}

std::string peerCsv(const SlideRow& row, int threads, std::uint64_t baseBytes) {
    const SlideRow::Peer& peer = *row.peer;
    const Spread& t = peer.times;
    return fmt::format("fe,{},{},{},{:g},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.0f},{:.0f},{},0.0,0.0,{},{}",
                       peer.backend, threads, row.volume, row.percent, row.steps, t.median, t.p95, t.max, t.min,
                       peer.firstMs, peer.triangles, peer.vertices, peer.hasNormals ? 1 : 0, baseBytes >> 20,
                       peakResidentBytes() >> 20);
}

} // namespace isoslider::bench
