#include "tests/bench/slide_row.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>
#include <unordered_map>
#include <utility>

#include <tbb/parallel_for.h>

#include "core/extract/edge_interpolation.h"
#include "core/extract/live/brick_picture.h"
#include "core/grid/brick_grid.h"
#include "tests/bench/flat_runner.h"
#include "tests/bench/peer_flying_edges.h"
#include "tests/bench/volume_file.h"

namespace isoslider::bench {
namespace {

#if ISOSLIDER_BENCH_HAS_PEER
std::unique_ptr<FlyingEdges> makePeer(const BenchVolume& volume, const RowOptions& options) {
    PeerVolume view;
    view.samples = volume.grid->bytes().data();
    for (std::size_t axis = 0; axis < 3; ++axis)
        view.dims[axis] = static_cast<int>(volume.grid->dims()[axis]);
    switch (volume.grid->type()) {
        case ScalarType::U8: view.type = PeerSample::U8; break;
        case ScalarType::I8: view.type = PeerSample::I8; break;
        case ScalarType::U16: view.type = PeerSample::U16; break;
        case ScalarType::I16: view.type = PeerSample::I16; break;
        case ScalarType::I32: view.type = PeerSample::I32; break;
        case ScalarType::F32: view.type = PeerSample::F32; break;
        case ScalarType::F64: view.type = PeerSample::F64; break;
    }
    return std::make_unique<FlyingEdges>(view, options.threads, options.peerBackend);
}
#endif

// What interpolation reads and writes for an active edge: what a vertex is made from; V, N.
std::size_t interpolationBytes(ScalarType type) {
    const std::size_t group =
        realType(type) == ScalarType::F64 ? sizeof(extract::VertexGroup<double>) : sizeof(extract::VertexGroup<float>);
    return group / extract::kGroupSize + 2 * sizeof(glm::vec3);
}

// Copies bytes, one piece per thread.
class CopyWitness {
public:
    double copyMs(std::size_t bytes, int threads) {
        if (from_.size() < bytes) {
            from_.assign(bytes + bytes / 4, std::byte{1});
            to_.assign(from_.size(), std::byte{2});
        }
        const std::size_t pieces = static_cast<std::size_t>(threads);
        const double start = nowMs();
        tbb::parallel_for(
            std::size_t{0}, pieces,
            [&](std::size_t piece) {
                const std::size_t begin = bytes * piece / pieces, end = bytes * (piece + 1) / pieces;
                std::memcpy(to_.data() + begin, from_.data() + begin, end - begin);
            },
            tbb::static_partitioner{});
        return nowMs() - start;
    }

private:
    std::vector<std::byte> from_, to_;
};

// One contestant while its slide runs.
class RunningEngine {
public:
    explicit RunningEngine(const Contestant& contestant) : contestant_(contestant) { row_.name = contestant.name; }

    Status open() {
        auto engine = contestant_.open();
        if (!engine.isOk())
            return std::move(engine).error();
        engine_ = std::move(engine).value();
        return {};
    }

    /// A step that is not measured.
    Status visit(double isovalue) {
        const auto moved = engine_->slideTo(isovalue);
        return moved.isOk() ? Status() : Status(moved.error());
    }

    Result<extract::SlideStats> step(double isovalue, bool isFirst, CacheState caches) {
        if (caches == CacheState::Empty)
            engine_->dropCaches();
        if (caches != CacheState::AsLeft && !contestant_.file.empty())
            dropFromMemory(contestant_.file);
        // As in the window: the picture before stays until there is another.
        extract::SurfaceFrame frame;
        const double start = nowMs();
        auto moved = engine_->slideTo(isovalue);
        if (!moved.isOk())
            return moved;
        engine_->copyFrame(frame);
        const double elapsed = nowMs() - start;
        if (isFirst)
            row_.firstMs = elapsed;
        else
            add(moved.value(), elapsed);
        const double sent = frame.bricks ? sentBytes(*frame.bricks) : 0.0;
        row_.sentBytes += isFirst ? 0.0 : sent;
        if (contestant_.makesArrays && frame.bricks && !isFirst) {
            const double before = nowMs();
            expandVertices(*frame.bricks, isovalue, positions_, normals_);
            arrayTimes_.push_back(nowMs() - before);
        }
        frame_ = std::move(frame);
        return moved;
    }

    void addCopy(double elapsedMs) { copies_.push_back(elapsedMs); }

    EngineRow finish(int steps) {
        row_.times = spreadOf(times_);
        row_.updateMs = spreadOf(updates_).median;
        row_.arraysMs = spreadOf(arrayTimes_).median;
        row_.copyMs = spreadOf(copies_).median;
        row_.nsPerChange = spreadOf(nsPerChange_).median;
        for (double* sum : {&row_.activeEdges, &row_.triangles, &row_.edgesChanged, &row_.edgesTouched, &row_.bytesRead,
                            &row_.bytesAhead, &row_.bricksRead, &row_.chunksRead, &row_.ambiguousCells,
                            &row_.cellsResolved, &row_.sentBytes})
            *sum /= steps;
        return row_;
    }

private:
    // Points that are still where they were sent stay there.
    double sentBytes(const extract::BrickPicture<float>& picture) {
        const auto now = picture.bricks();
        if (!frame_.bricks || frame_.bricks->series() != picture.series())
            sentPoints_.clear();
        const auto before = frame_.bricks && frame_.bricks->series() == picture.series()
                                ? frame_.bricks->bricks()
                                : std::span<const extract::PictureBrick>();
        double bytes = 0.0;
        for (std::size_t slot = 0; slot < now.size(); ++slot)
            if (const bool isNew = slot >= before.size(); now[slot].indexCount > 0) {
                const std::uint32_t version = now[slot].pointsVersion;
                bytes += static_cast<double>(
                    picture.bytesOf(now[slot], isNew || now[slot] != before[slot],
                                    std::exchange(sentPoints_[now[slot].firstPointLine], version) != version));
            }
        return bytes;
    }

    void add(const extract::SlideStats& stats, double elapsedMs) {
        times_.push_back(elapsedMs);
        updates_.push_back(stats.updateMs);
        row_.rebuilds += stats.hasRebuilt ? 1 : 0;
        const std::uint64_t changed = stats.edgesAdded + stats.edgesRemoved;
        if (changed > 0)
            nsPerChange_.push_back(1e6 * stats.updateMs / static_cast<double>(changed));
        row_.activeEdges += static_cast<double>(stats.activeEdges);
        row_.triangles += static_cast<double>(stats.triangles);
        row_.edgesChanged += static_cast<double>(changed);
        row_.edgesTouched += static_cast<double>(stats.edgesTouched);
        row_.bytesRead += static_cast<double>(stats.bytesRead);
        row_.bytesAhead += static_cast<double>(stats.bytesAhead);
        row_.bricksRead += static_cast<double>(stats.bricksRead);
        row_.chunksRead += static_cast<double>(stats.chunksRead);
        row_.ambiguousCells += static_cast<double>(stats.ambiguousCells);
        row_.cellsResolved += static_cast<double>(stats.cellsResolved);
    }

    const Contestant& contestant_;
    EngineRow row_;
    std::unique_ptr<extract::SlideEngine> engine_;
    extract::SurfaceFrame frame_; ///< the last one
    std::unordered_map<std::uint32_t, std::uint32_t> sentPoints_; ///< their versions, by their first lines
    std::vector<glm::vec3> positions_, normals_; ///< the same as floats
    std::vector<double> times_, updates_, arrayTimes_, copies_, nsPerChange_;
};

// One slide while it runs.
class Slide {
public:
    Slide(const BenchVolume& volume, const RowOptions& options) : volume_(volume), options_(options) {
        row_.volume = volume.name;
        row_.percent = options.percent;
        row_.steps = options.steps;
    }

    Status open(const std::vector<Contestant>& contestants) {
        for (const Contestant& contestant : contestants) {
            engines_.emplace_back(contestant);
            ISO_TRY(engines_.back().open());
        }
        if (options_.withBaseline) {
            auto flat = FlatRunner::open(contestants.front().file);
            if (!flat.isOk())
                return std::move(flat).error();
            flat_ = std::move(flat).value();
        }
#if ISOSLIDER_BENCH_HAS_PEER
        if (options_.withPeer) {
            peer_ = makePeer(volume_, options_);
            row_.peer.emplace().backend = peer_->backend();
        }
#endif
        return {};
    }

    // There and back, so that the slide finds what an earlier one has left.
    Status goBefore(std::vector<double> isovalues) {
        for (int way = 0; way < 2; ++way) {
            for (const double isovalue : isovalues)
                for (RunningEngine& engine : engines_)
                    ISO_TRY(engine.visit(isovalue));
            std::reverse(isovalues.begin(), isovalues.end());
        }
        return {};
    }

    // Contestants with a copy each, peer, baseline: each finds the processor's caches as the others left them.
    Status step(double isovalue, bool isFirst) {
        std::optional<extract::SlideStats> first;
        for (RunningEngine& engine : engines_) {
            const auto moved = engine.step(isovalue, isFirst, options_.caches);
            if (!moved.isOk())
                return moved.error();
            const extract::SlideStats& stats = moved.value();
            if (!first)
                first = stats;
            row_.disagreements +=
                first->activeEdges == stats.activeEdges && first->triangles == stats.triangles ? 0 : 1;
            runCopy(engine, isFirst, stats);
            if (options_.pauseMs > 0)
                std::this_thread::sleep_for(std::chrono::milliseconds(options_.pauseMs));
        }
        runPeer(isovalue, isFirst, *first);
        return runBaseline(isovalue, isFirst, *first);
    }

    SlideRow finish() {
        for (RunningEngine& engine : engines_)
            row_.engines.push_back(engine.finish(options_.steps));
        if (row_.peer) {
            row_.peer->times = spreadOf(peers_);
            row_.peer->vertices /= options_.steps;
            row_.peer->triangles /= options_.steps;
        }
        if (flat_)
            row_.baseline = spreadOf(flats_);
        return row_;
    }

private:
    void runCopy(RunningEngine& engine, bool isFirst, const extract::SlideStats& stats) {
        if (!options_.withCopy)
            return;
        const double copied =
            witness_.copyMs(stats.activeEdges * interpolationBytes(volume_.grid->type()), options_.threads);
        if (!isFirst)
            engine.addCopy(copied);
    }

    void runPeer([[maybe_unused]] double isovalue, [[maybe_unused]] bool isFirst,
                 [[maybe_unused]] const extract::SlideStats& stats) {
#if ISOSLIDER_BENCH_HAS_PEER
        if (!peer_)
            return;
        const double start = nowMs();
        const FlyingEdges::Surface surface = peer_->extract(isovalue);
        const double elapsed = nowMs() - start;
        const bool agrees =
            volume_.hasMissing ? surface.vertices >= stats.activeEdges : surface.vertices == stats.activeEdges;
        row_.disagreements += agrees ? 0 : 1;
        if (isFirst) {
            row_.peer->firstMs = elapsed;
            return;
        }
        peers_.push_back(elapsed);
        row_.peer->vertices += static_cast<double>(surface.vertices);
        row_.peer->triangles += static_cast<double>(surface.triangles);
        row_.peer->hasNormals = row_.peer->hasNormals && surface.hasNormals;
#endif
    }

    Status runBaseline(double isovalue, bool isFirst, const extract::SlideStats& stats) {
        if (!flat_)
            return {};
        const auto moved = flat_->slideTo(isovalue);
        if (!moved.isOk())
            return moved.error();
        const FlatStep& flat = moved.value();
        row_.disagreements += flat.activeEdges == stats.activeEdges && flat.triangles == stats.triangles ? 0 : 1;
        if (!isFirst)
            flats_.push_back(flat.updateMs + flat.interpolateMs);
        return {};
    }

    const BenchVolume& volume_;
    const RowOptions& options_;
    SlideRow row_;
    std::vector<RunningEngine> engines_;
    std::unique_ptr<FlatRunner> flat_;
#if ISOSLIDER_BENCH_HAS_PEER
    std::unique_ptr<FlyingEdges> peer_;
#endif
    CopyWitness witness_;
    std::vector<double> peers_, flats_;
};

} // namespace

bool hasPeer() { return ISOSLIDER_BENCH_HAS_PEER != 0; }

Contestant contestantOnIndex(std::string name, const std::filesystem::path& path,
                             const extract::SlideOptions& options) {
    return {std::move(name), path, [path, options] { return extract::SlideEngine::open(path, options); }};
}

Result<SlideRow> measureRow(const BenchVolume& volume, const std::vector<Contestant>& contestants,
                            const RowOptions& options) {
    Slide run(volume, options);
    ISO_TRY(run.open(contestants));
    if (options.isSecondSlide)
        ISO_TRY(run.goBefore(slide(volume, options.percent, options.steps)));
    bool isFirst = true;
    for (const double isovalue : slide(volume, options.percent, options.steps)) {
        ISO_TRY(run.step(isovalue, isFirst));
        isFirst = false;
    }
    return run.finish();
}

} // namespace isoslider::bench
