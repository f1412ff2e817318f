#include "core/extract/slide_engine.h"

#include <chrono>
#include <cmath>

#include "core/extract/active_surface.h"
#include "core/extract/brick_source.h"
#include "core/extract/edge_block_source.h"
#include "core/extract/memory_samples.h"
#include "core/extract/stored_samples.h"

namespace isoslider::extract {
namespace {

constexpr std::uint64_t kKeptChanges = 1u << 16;

double millisecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// What an engine stands on: a reader, and samples where the source needs some.
template <class Sample>
struct IndexBacking {
    using Source = EdgeBlockSource<Sample>;
    std::unique_ptr<index::IndexReader> reader;
    Source source;
    static constexpr bool kIsIndex = true;

    IndexBacking(std::unique_ptr<index::IndexReader> opened, const SlideOptions& options)
        : reader(std::move(opened)), source(*reader, options.cacheBytes.value_or(kEdgesCacheBytes)) {}
};

template <class Sample>
struct MemoryBacking {
    using Source = BrickSource<Sample>;
    std::shared_ptr<const ScalarGrid> grid;
    std::unique_ptr<index::IndexReader> reader;
    MemorySamples<Sample> samples;
    Source source;
    static constexpr bool kIsIndex = false;

    MemoryBacking(std::shared_ptr<const ScalarGrid> volume, std::unique_ptr<index::IndexReader> brickList,
                  const SlideOptions& options)
        : grid(std::move(volume)), reader(std::move(brickList)), samples(*grid),
          source(*reader, samples, options.cacheBytes.value_or(kEdgesCacheBytes)) {}
};

template <class Sample>
struct StoreBacking {
    using Source = BrickSource<Sample>;
    std::unique_ptr<index::IndexReader> reader;
    StoredSamples<Sample> samples;
    Source source;
    static constexpr bool kIsIndex = true;
    static constexpr std::uint64_t kPagesShare = 8; // of the cache: the list of bricks is small

    StoreBacking(std::unique_ptr<index::IndexReader> opened, const SlideOptions& options)
        : StoreBacking(std::move(opened), options.cacheBytes.value_or(kMetacellsCacheBytes)) {}
    StoreBacking(std::unique_ptr<index::IndexReader> opened, std::uint64_t cacheBytes)
        : reader(std::move(opened)), samples(*reader, cacheBytes - cacheBytes / kPagesShare),
          source(*reader, samples, cacheBytes / kPagesShare) {}
};

template <class Backing>
class Engine final : public SlideEngine {
    using Live = typename Backing::Source::Live;

public:
    template <class... Arguments>
    explicit Engine(const SlideOptions& options, Arguments&&... arguments)
        : readsAhead_(options.readsAhead), backing_(std::forward<Arguments>(arguments)...),
          surface_(meta().info.geometry, meta().missingCells, backing_.source),
          changes_(backing_.reader->grid().brickCount()), position_(backing_.source.lowest()) {}

    const index::IndexInfo& info() const override { return meta().info; }

    Result<SlideStats> slideTo(double isovalue, std::stop_token stop) override {
        if (std::isnan(isovalue))
            return makeError(ErrorCode::InvalidArgument, "isovalue is not a number");
        try {
            return moveAndInterpolate(isovalue, std::move(stop));
        } catch (...) { // out of memory: whoever catches it may go on with an empty surface
            dropSurface();
            throw;
        }
    }

    void settle() override { backing_.source.settle(); }
    void dropCaches() override {
        settle();
        backing_.source.dropCaches();
    }

    void copyFrame(SurfaceFrame& frame) const override {
        surface_.copyFrame(frame);
        frame.isovalue = lastStats_.isovalue;
        frame.stats = lastStats_;
        frame.isFromIndex = Backing::kIsIndex;
        if (lastStats_.hasRebuilt) // everything is new: nothing to point out
            frame.changedIndices.clear();
    }

    SurfaceMesh mesh() const override { return surface_.mesh(lastStats_.isovalue); }

private:
    Result<SlideStats> moveAndInterpolate(double isovalue, std::stop_token stop) {
        SlideStats stats;
        stats.isovalue = isovalue;
        const auto start = std::chrono::steady_clock::now();
        const Status moved = move(isovalue, stats, stop);
        if (!moved.isOk()) {
            dropSurface();
            return moved.error();
        }
        stats.updateMs = millisecondsSince(start);
        const auto interpolationStart = std::chrono::steady_clock::now();
        surface_.interpolate(isovalue);
        stats.interpolateMs = millisecondsSince(interpolationStart);
        stats.activeEdges = surface_.activeEdges();
        stats.triangles = surface_.triangles();
        const double previous = lastStats_.isovalue;
        lastStats_ = stats;
        // A handle that moves goes on moving.
        if (const double next = isovalue + (isovalue - previous); readsAhead_ && hasMoved_ && std::isfinite(next))
            backing_.source.foresee(position_, backing_.source.threshold(next));
        hasMoved_ = true;
        return stats;
    }

    // From where to start: here, or from the empty surface below or above all values, whichever has
    // fewer edge entries on the way. An emptied surface costs nothing to remove.
    Status move(double isovalue, SlideStats& stats, std::stop_token stop) {
        const KeyThreshold target = backing_.source.threshold(isovalue);
        std::uint64_t best = backing_.source.estimate(position_, target);
        KeyThreshold start = position_;
        bool restarts = false;
        for (const KeyThreshold end : {backing_.source.lowest(), backing_.source.highest()}) {
            const std::uint64_t cost = backing_.source.estimate(end, target);
            if (cost < best) {
                best = cost;
                start = end;
                restarts = true;
            }
        }
        if (restarts) {
            stats.hasRebuilt = !surface_.isEmpty();
            stats.edgesRemoved += surface_.activeEdges();
            surface_.clear();
        }
        // What a jump has left in the lists is given back when steps become small.
        if (lastTouched_ > 4 * best + kKeptChanges)
            changes_.trim();
        changes_.clear();
        ISO_TRY(backing_.source.collect(start, target, changes_, stats, stop));
        const std::uint64_t hiddenBytes = backing_.source.hiddenBytesRead();
        ISO_TRY(surface_.apply(changes_, isovalue, stats));
        stats.bytesRead += backing_.source.hiddenBytesRead() - hiddenBytes;
        lastTouched_ = stats.edgesTouched;
        position_ = target;
        return {};
    }

    void dropSurface() {
        surface_.clear();
        changes_.clear();
        position_ = backing_.source.lowest();
    }

    const index::IndexMeta& meta() const { return backing_.reader->meta(); }

    bool readsAhead_;
    Backing backing_;
    ActiveSurface<Live> surface_;
    ChangeSet<Live> changes_;
    KeyThreshold position_;
    std::uint64_t lastTouched_ = 0;
    SlideStats lastStats_;
    bool hasMoved_ = false;
};

} // namespace

Result<std::unique_ptr<SlideEngine>> SlideEngine::open(const std::filesystem::path& indexPath, const SlideOptions& options) {
    auto reader = index::IndexReader::open(indexPath);
    if (!reader.isOk())
        return std::move(reader).error();
    const ScalarType type = reader.value()->info().type;
    return visitScalarType(type, [&](auto sample) -> Result<std::unique_ptr<SlideEngine>> {
        if (reader.value()->info().kind == index::IndexKind::Metacells)
            return std::unique_ptr<SlideEngine>(std::make_unique<Engine<StoreBacking<decltype(sample)>>>(
                options, std::move(reader).value(), options));
        return std::unique_ptr<SlideEngine>(std::make_unique<Engine<IndexBacking<decltype(sample)>>>(
            options, std::move(reader).value(), options));
    });
}

std::unique_ptr<SlideEngine> SlideEngine::onVolume(std::shared_ptr<const ScalarGrid> grid, std::unique_ptr<index::IndexReader> brickList,
                                                   const SlideOptions& options) {
    return visitScalarType(grid->type(), [&](auto sample) {
        return std::unique_ptr<SlideEngine>(std::make_unique<Engine<MemoryBacking<decltype(sample)>>>(
            options, std::move(grid), std::move(brickList), options));
    });
}

} // namespace isoslider::extract
