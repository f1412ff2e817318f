#include "tests/bench/trade.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/index/index_reader.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/bench/timing.h"

namespace isoslider::bench {
namespace {

constexpr std::uint64_t kMega = std::uint64_t{1} << 20;
constexpr std::uint64_t kPredictedFrom = std::uint64_t{1} << 24; // samples of the smaller size, at most
constexpr int kFirstProbes = 3;
constexpr std::uint64_t kMostBytesPerVoxel = 64; // no index of edges is expected to have more

// A way to slide, and how it is opened.
struct Way {
    WayCost cost;
    std::filesystem::path index; // empty: in memory
    std::optional<std::uint64_t> cacheBytes;
};

void say(const std::string& volume, const std::string& what) {
    fmt::print(stderr, "trade_bench: {}: {}\n", volume, what);
}

// One volume while it is measured.
class Trade {
public:
    Trade(BenchVolume volume, const TradeOptions& options) : volume_(std::move(volume)), options_(options) {}

    Result<TradeReport> run() {
        const NoiseWitness noise;
        const Status measured = measure();
        if (!options_.keepsFiles)
            removeFiles();
        if (!measured.isOk())
            return measured.error();
        for (const Way& way : ways_)
            report_.ways.push_back(way.cost);
        report_.othersBusy = noise.othersBusy();
        return std::move(report_);
    }

private:
    Status measure() {
        report_.volume = volume_.name;
        report_.memoryBytes = options_.memoryBytes;
        say(volume_.name, "writing its file");
        auto file = writeVolumeFile(*volume_.grid, options_.folder / (volume_.name + ".raw"));
        if (!file.isOk())
            return std::move(file).error();
        report_.file = std::move(file).value();
        const std::vector<double> isovalues = slide(volume_, 1.0, options_.row.steps);
        const auto predicted = predictEdgesBytes();
        if (!predicted.isOk())
            return predicted.error();
        volume_.grid.reset();
        ISO_TRY(build(predicted.value()));
        for (Way& way : ways_)
            if (!way.cost.isSkipped)
                ISO_TRY(probe(way, isovalues));
        // As the probes have it: without spacing.
        auto grid = io::readVolume(report_.file.path, report_.file.readOptions());
        if (!grid.isOk())
            return std::move(grid).error();
        volume_.grid = std::move(grid).value();
        return measureRows();
    }

    bool wants(const std::string& kind) const {
        return std::find(options_.kinds.begin(), options_.kinds.end(), kind) != options_.kinds.end();
    }

    std::filesystem::path indexPath(const std::string& kind) const {
        return options_.folder / (volume_.name + "." + kind + ".isx");
    }

    // 0 where an index of edges is small enough in any case.
    Result<double> predictEdgesBytes() {
        const std::uint64_t points = report_.file.points();
        if (!wants("edges") || points <= options_.maxEdgesBytes / kMostBytesPerVoxel)
            return 0.0;
        std::int64_t stride = 2;
        while (points / static_cast<std::uint64_t>(stride * stride * stride) > kPredictedFrom)
            ++stride;
        say(volume_.name, fmt::format("predicting its index of edges from every {}. sample", stride));
        const auto file =
            writeVolumeFile(sampledCoarser(*volume_.grid, stride), options_.folder / (volume_.name + ".small.raw"));
        if (!file.isOk())
            return file.error();
        const auto index = indexPath("small");
        const auto bytes = buildIndex(file.value(), index, index::IndexKind::Edges, nullptr);
        std::filesystem::remove(index);
        std::filesystem::remove(file.value().path);
        if (!bytes.isOk())
            return bytes.error();
        return static_cast<double>(bytes.value()) / static_cast<double>(file.value().points()) *
               static_cast<double>(points);
    }

    // Bytes of the index.
    Result<std::uint64_t> buildIndex(const VolumeFile& file, const std::filesystem::path& path, index::IndexKind kind,
                                     BuildProbeResult* result) {
        auto built = probeBuild({file, path, kind, options_.row.threads, options_.memoryBytes});
        if (!built.isOk())
            return std::move(built).error();
        if (result != nullptr)
            *result = built.value();
        const auto reader = index::IndexReader::open(path);
        if (!reader.isOk())
            return reader.error();
        return reader.value()->info().indexBytes;
    }

    Status build(double predictedEdgesBytes) {
        const auto before = measureYardstick(report_.file);
        if (!before.isOk())
            return before.error();
        for (const index::IndexKind kind : {index::IndexKind::Edges, index::IndexKind::Metacells})
            if (wants(index::indexKindName(kind)))
                ISO_TRY(buildKind(kind, kind == index::IndexKind::Edges ? predictedEdgesBytes : 0.0));
        const auto after = measureYardstick(report_.file);
        if (!after.isOk())
            return after.error();
        report_.yardstick = meanOf(before.value(), after.value());
        if (wants("memory")) {
            Way way;
            way.cost.name = "memory";
            way.cost.isInMemory = true;
            way.cost.cacheBytes = report_.file.sizeBytes();
            ways_.push_back(way);
        }
        return {};
    }

    Status buildKind(index::IndexKind kind, double predictedBytes) {
        const std::string name = index::indexKindName(kind);
        Way way;
        way.cost.name = name;
        way.cost.predictedBytes = predictedBytes;
        way.index = indexPath(name);
        if (predictedBytes > static_cast<double>(options_.maxEdgesBytes)) {
            way.cost.isSkipped = true;
            ways_.push_back(way);
            return {};
        }
        say(volume_.name, "building " + name);
        const auto bytes = buildIndex(report_.file, way.index, kind, &way.cost.build);
        if (!bytes.isOk())
            return bytes.error();
        way.cost.indexBytes = bytes.value();
        way.cost.cacheBytes = extract::indexCacheBytes();
        if (options_.caches.empty())
            ways_.push_back(way);
        for (const std::uint64_t cacheBytes : options_.caches) {
            way.cost.name = fmt::format("{} {}M", name, cacheBytes / kMega);
            way.cacheBytes = way.cost.cacheBytes = cacheBytes;
            ways_.push_back(way);
        }
        return {};
    }

    Status probe(Way& way, const std::vector<double>& isovalues) {
        say(volume_.name, "probing " + way.cost.name);
        ProbeRequest request;
        request.index = way.index;
        if (way.cost.isInMemory)
            request.volume = report_.file;
        request.threads = options_.row.threads;
        request.cacheBytes = way.cacheBytes;
        request.isovalues = isovalues;
        const auto probed = probeSlide(request);
        if (!probed.isOk())
            return probed.error();
        way.cost.probe = probed.value();
        request.isovalues.resize(1);
        ISO_TRY(probeFirst(request, false, way.cost.probe.openMs, way.cost.probe.firstSurfaceMs));
        double coldOpenMs = 0.0;
        return options_.isCold ? probeFirst(request, true, coldOpenMs, way.cost.firstColdMs) : Status();
    }

    // Medians: a process that has just been started is easily held up.
    Status probeFirst(const ProbeRequest& request, bool isCold, double& openMs, double& firstMs) const {
        std::vector<double> opens, firsts;
        for (int i = 0; i < kFirstProbes; ++i) {
            if (isCold)
                dropFromMemory(request.volume ? request.volume->path : request.index);
            const auto probed = probeSlide(request);
            if (!probed.isOk())
                return probed.error();
            opens.push_back(probed.value().openMs);
            firsts.push_back(probed.value().firstSurfaceMs);
        }
        openMs = spreadOf(std::move(opens)).median;
        firstMs = spreadOf(std::move(firsts)).median;
        return {};
    }

    Contestant contestant(const Way& way, bool readsAhead = false) const {
        if (!way.cost.isInMemory)
            return contestantOnIndex(way.cost.name, way.index, {way.cacheBytes, readsAhead});
        return {way.cost.name, {}, [grid = volume_.grid] { return preprocess::makeMemoryEngine(grid); }};
    }

    Status measureRows() {
        std::vector<Contestant> all, onIndex;
        for (const Way& way : ways_) {
            if (way.cost.isSkipped)
                continue;
            all.push_back(contestant(way));
            if (!way.cost.isInMemory)
                onIndex.push_back(all.back());
        }
        RowOptions row = options_.row;
        row.withCopy = false;
        report_.peerIsLeftOut = row.withPeer && report_.file.sizeBytes() > options_.peerBytes;
        row.withPeer = row.withPeer && !report_.peerIsLeftOut;
        for (const double percent : options_.percents) {
            if (all.empty())
                break;
            say(volume_.name, fmt::format("steps of {:g} %", percent));
            row.percent = percent;
            TradeRow& measured = report_.rows.emplace_back();
            row.caches = CacheState::AsLeft;
            auto warm = measureRow(volume_, all, row);
            if (!warm.isOk())
                return std::move(warm).error();
            measured.warm = std::move(warm).value();
            if (options_.isCold && !onIndex.empty()) {
                row.caches = CacheState::Empty;
                auto cold = measureRow(volume_, onIndex, row);
                if (!cold.isOk())
                    return std::move(cold).error();
                measured.cold = std::move(cold).value();
            }
            if (options_.measuresAhead)
                ISO_TRY(measureAhead(row, measured));
        }
        return {};
    }

    // Each on its own, with a pause after each step: without reading ahead, and with it.
    Status measureAhead(RowOptions row, TradeRow& measured) const {
        row.caches = CacheState::OnDisk;
        row.withPeer = false;
        row.pauseMs = options_.pauseMs;
        for (const Way& way : ways_) {
            if (way.cost.isSkipped || way.cost.isInMemory)
                continue;
            for (const bool readsAhead : {false, true}) {
                const auto alone = measureRow(volume_, {contestant(way, readsAhead)}, row);
                if (!alone.isOk())
                    return alone.error();
                (readsAhead ? measured.ahead : measured.onDisk).push_back(alone.value().ours());
            }
        }
        return {};
    }

    void removeFiles() const {
        std::filesystem::remove(options_.folder / (volume_.name + ".raw"));
        for (const index::IndexKind kind : {index::IndexKind::Edges, index::IndexKind::Metacells})
            if (wants(index::indexKindName(kind)))
                std::filesystem::remove(indexPath(index::indexKindName(kind)));
    }

    BenchVolume volume_;
    const TradeOptions& options_;
    TradeReport report_;
    std::vector<Way> ways_;
};

} // namespace

Result<TradeReport> measureTrade(BenchVolume volume, const TradeOptions& options) {
    return Trade(std::move(volume), options).run();
}

} // namespace isoslider::bench
