#include "core/extract/slide_engine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/base/memory_limit.h"
#include "core/extract/live/live_surface.h"
#include "core/extract/pieces/piece_tracker.h"
#include "core/extract/sources/brick_source.h"
#include "core/extract/sources/memory_samples.h"
#include "core/extract/sources/stored_samples.h"

namespace isoslider::extract {
namespace {

constexpr std::uint64_t kLeastCacheBytes = std::uint64_t{256} << 20, kMostCacheBytes = std::uint64_t{4} << 30;

double millisecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// What an engine stands on: a reader, and samples where the source needs some. Of the bound on caches the list of
/// changes may take a part; points of bricks that have left are kept in what it and the samples leave.
template <class Sample>
struct MemoryBacking {
    using Source = BrickSource<Sample>;
    std::shared_ptr<const ScalarGrid> grid;
    std::unique_ptr<index::IndexReader> reader;
    MemorySamples<Sample> samples;
    Source source;
    std::uint64_t pointShare;
    static constexpr bool kIsIndex = false;

    MemoryBacking(std::shared_ptr<const ScalarGrid> volume, std::unique_ptr<index::IndexReader> brickList,
                  const SlideOptions& options)
        : grid(std::move(volume)),
          reader(std::move(brickList)),
          samples(*grid),
          source(*reader, samples, options.cacheBytes.value_or(kSmallCacheBytes) / 2),
          pointShare(options.cacheBytes.value_or(kSmallCacheBytes) / 2) {}
    std::uint64_t pointBytes() const { return pointShare; }
    std::uint64_t pointBytesBesideFullList() const { return pointShare; }
};

template <class Sample>
struct StoreBacking {
    using Source = BrickSource<Sample>;
    std::unique_ptr<index::IndexReader> reader;
    StoredSamples<Sample> samples;
    Source source;
    std::uint64_t cacheBytes;
    static constexpr bool kIsIndex = true;
    // Of the cache, a quarter for points at least, and what others leave, up to half of it; but who draws the surface
    // holds all points that it has been given, too.
    static constexpr std::uint64_t kMostPoints = std::uint64_t{512} << 20;
    static std::uint64_t leastPoints(std::uint64_t cacheBytes) { return std::min(cacheBytes / 4, kMostPoints); }
    static std::uint64_t mostPoints(std::uint64_t cacheBytes) { return std::min(cacheBytes / 2, kMostPoints); }
    static std::uint64_t listShare(const index::IndexReader& reader, std::uint64_t cacheBytes) {
        return cacheBytes / (reader.info().kind == index::IndexKind::Edges ? 4 : 8); // a list of bricks is small
    }

    StoreBacking(std::unique_ptr<index::IndexReader> opened, const SlideOptions& options)
        : StoreBacking(std::move(opened), options.cacheBytes ? *options.cacheBytes : indexCacheBytes()) {}
    StoreBacking(std::unique_ptr<index::IndexReader> opened, std::uint64_t bytes)
        : reader(std::move(opened)),
          samples(*reader, bytes - listShare(*reader, bytes) - leastPoints(bytes)),
          source(*reader, samples, listShare(*reader, bytes),
                 boundOf(builtError(reader->info()), reader->info().min, reader->info().max)),
          cacheBytes(bytes) {}

    /// A list of edges is large where the handle goes through it slowly; of jumps little is kept.
    std::uint64_t pointBytes() const { return pointBytesBeside(source.listBytes()); }
    std::uint64_t pointBytesBesideFullList() const { return pointBytesBeside(listShare(*reader, cacheBytes)); }
    std::uint64_t pointBytesBeside(std::uint64_t list) const {
        return std::clamp(cacheBytes - std::min(cacheBytes, list + samples.mostBytes()), leastPoints(cacheBytes),
                          mostPoints(cacheBytes));
    }
};

template <class Backing>
class Engine final : public SlideEngine {
    using Live = typename Backing::Source::Live;

public:
    template <class... Arguments>
    explicit Engine(const SlideOptions& options, Arguments&&... arguments)
        : readsAhead_(options.readsAhead),
          backing_(std::forward<Arguments>(arguments)...),
          surface_(meta().info.geometry, meta().info.type, meta().missingCells,
                   options.keepsGroups || std::is_same_v<Live, double>),
          position_(backing_.source.lowest()),
          wantedBound_(boundOf(builtError(meta().info), meta().info.min, meta().info.max)),
          mergeBound_(wantedBound_) {
        backing_.source.setMergeBound(wantedBound_);
        backing_.source.setBuildsLevels(options.buildsLevels);
        surface_.keepPoints(backing_.pointBytes());
        constexpr std::uint64_t kMostSlack = std::uint64_t{32} << 20;
        surface_.setSlack(std::min(backing_.pointBytesBesideFullList() / 4, kMostSlack));
    }

    const index::IndexInfo& info() const override { return meta().info; }

    Result<SlideStats> slideTo(double isovalue, const JobControl& job) override {
        if (std::isnan(isovalue))
            return makeError(ErrorCode::InvalidArgument, "isovalue is not a number");
        try {
            return moveSurface(isovalue, job);
        } catch (...) { // out of memory: whoever catches it may go on with an empty surface
            dropSurface();
            throw;
        }
    }

    MergeBound mergeBound() const override { return mergeBound_; }
    void setMergeBound(const MergeBound& bound) override {
        backing_.source.setMergeBound(bound);
        wantedBound_ = bound;
    }

    std::optional<BrickBox> region() const override { return region_; }
    void setRegion(const std::optional<BrickBox>& region) override {
        backing_.source.setRegion(region);
        wantedRegion_ = region;
    }

    void waitForPrefetch() override { backing_.source.waitForPrefetch(); }
    void dropCaches() override {
        waitForPrefetch();
        backing_.source.dropCaches();
        surface_.dropKeptPoints();
    }

    void copyFrame(SurfaceFrame& frame, const FrameContents& contents) override {
        frame.geometry = meta().info.geometry;
        frame.isovalue = lastStats_.isovalue;
        frame.stats = lastStats_;
        frame.isFromIndex = Backing::kIsIndex;
        auto picture = surface_.picture(contents.changes && !lastStats_.hasRebuilt);
        if (contents.pieces)
            frame.pieces = piecesOf(*picture, contents.piecesBefore);
        else
            forgetPieces(frame);
        if constexpr (std::is_same_v<Live, float>) {
            frame.bricks = std::move(picture);
            frame.positions.clear();
            frame.normals.clear();
            frame.indices.clear();
            frame.changedIndices.clear();
        } else {
            expandPicture(*picture, frame);
        }
    }

    Result<SurfaceMesh> mesh(const JobControl& job) const override {
        auto mesh = surface_.mesh(lastStats_.isovalue, job);
        if (mesh.isOk())
            mesh.value().mergeBound = mergeBound_;
        return mesh;
    }

private:
    // The surface is worth more than its pieces, where there is no memory for both.
    std::shared_ptr<const SurfacePieces> piecesOf(const BrickPicture<Live>& picture,
                                                  const std::shared_ptr<const SurfacePieces>& before) try {
        pieces_.follow(before);
        return pieces_.update(picture, !meta().missingCells.empty());
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
    void forgetPieces(SurfaceFrame& frame) {
        frame.pieces.reset();
        pieces_.forget();
    }

    Result<SlideStats> moveSurface(double isovalue, const JobControl& job) {
        SlideStats stats;
        stats.isovalue = isovalue;
        const auto start = std::chrono::steady_clock::now();
        const Status moved = move(isovalue, stats, job);
        if (!moved.isOk()) {
            dropSurface();
            Error error = moved.error();
            if (error.path.empty()) // the surface does not know what file its changes are from
                error.path = backing_.reader->pathString();
            return error;
        }
        stats.updateMs = millisecondsSince(start);
        mergeBound_ = wantedBound_;
        region_ = wantedRegion_;
        stats.activeEdges = surface_.activeEdges();
        stats.triangles = surface_.triangles();
        stats.ambiguousCells = surface_.ambiguousCells();
        stats.activeLeaves = surface_.activeLeaves();
        const double previous = lastStats_.isovalue;
        lastStats_ = stats;
        // A handle that moves goes on moving.
        if (const double next = isovalue + (isovalue - previous); readsAhead_ && hasMoved_ && std::isfinite(next))
            backing_.source.prefetch(position_, backing_.source.threshold(next));
        hasMoved_ = true;
        return stats;
    }

    // Where a page turns out to be damaged, there may be a way around it: over lower levels, or from elsewhere. Each
    // round finds damage that was not known, so they come to an end.
    Status move(double isovalue, SlideStats& stats, const JobControl& job) {
        for (;;) {
            const std::uint64_t lost = backing_.source.partsLost();
            Status moved = moveOnce(isovalue, stats, job);
            if (moved.isOk() || moved.isCancelled() || backing_.source.partsLost() == lost)
                return moved;
            const SlideStats failed = std::exchange(stats, {});
            stats.isovalue = isovalue;
            stats.bytesRead = failed.bytesRead;
            stats.hasRebuilt = failed.hasRebuilt || surface_.hasBricks();
            dropSurface();
        }
    }

    // From where to start: here, or from the empty surface below or above all values, whichever has no damage and
    // fewer edge entries on the way. An emptied surface costs nothing to remove.
    Status moveOnce(double isovalue, SlideStats& stats, const JobControl& job) {
        const KeyThreshold target = backing_.source.threshold(isovalue);
        const auto costFrom = [&](KeyThreshold from) {
            return std::pair(backing_.source.isBlocked(from, target), backing_.source.estimate(from, target));
        };
        auto best = costFrom(position_);
        KeyThreshold start = position_;
        bool restarts = false;
        for (const KeyThreshold end : {backing_.source.lowest(), backing_.source.highest()}) {
            const auto cost = costFrom(end);
            if (cost < best) {
                best = cost;
                start = end;
                restarts = true;
            }
        }
        if (restarts) {
            stats.hasRebuilt = stats.hasRebuilt || surface_.hasBricks();
            stats.edgesRemoved += surface_.activeEdges();
            surface_.clear();
        }
        surface_.beginMove();
        ISO_TRY(backing_.source.move({start, target, isovalue}, surface_, stats, job));
        surface_.compact();
        surface_.keepPoints(backing_.pointBytes()); // the move may have read much of the list
        position_ = target;
        return {};
    }

    void dropSurface() {
        position_ = backing_.source.lowest();
        surface_.drop();
    }

    const index::IndexMeta& meta() const { return backing_.reader->meta(); }

    bool readsAhead_;
    Backing backing_;
    LiveSurface<Live> surface_;
    PieceTracker<Live> pieces_;
    KeyThreshold position_;
    SlideStats lastStats_;
    MergeBound wantedBound_, mergeBound_; ///< for the next move, and of the surface
    std::optional<BrickBox> wantedRegion_, region_; ///< likewise
    bool hasMoved_ = false;
};

} // namespace

std::uint64_t indexCacheBytes() { return std::clamp(usableMemoryBytes() / 16, kLeastCacheBytes, kMostCacheBytes); }

MergeError builtError(const index::IndexInfo& info) {
    return {info.isMergeErrorInCells ? MergeBound::Measure::Distance : MergeBound::Measure::Scalar, info.mergeError};
}

Result<std::unique_ptr<SlideEngine>> SlideEngine::open(const std::filesystem::path& indexPath,
                                                       const SlideOptions& options) {
    auto reader = index::IndexReader::open(indexPath);
    if (!reader.isOk())
        return std::move(reader).error();
    const ScalarType type = reader.value()->info().type;
    return visitScalarType(type, [&](auto sample) -> Result<std::unique_ptr<SlideEngine>> {
        return std::unique_ptr<SlideEngine>(
            std::make_unique<Engine<StoreBacking<decltype(sample)>>>(options, std::move(reader).value(), options));
    });
}

std::unique_ptr<SlideEngine> SlideEngine::onVolume(std::shared_ptr<const ScalarGrid> grid,
                                                   std::unique_ptr<index::IndexReader> brickList,
                                                   const SlideOptions& options) {
    return visitScalarType(grid->type(), [&](auto sample) {
        return std::unique_ptr<SlideEngine>(std::make_unique<Engine<MemoryBacking<decltype(sample)>>>(
            options, std::move(grid), std::move(brickList), options));
    });
}

} // namespace isoslider::extract
