#include "core/extract/slide_engine.h"

#include <chrono>
#include <cmath>

#include "core/extract/active_surface.h"
#include "core/extract/edge_block_source.h"

namespace isoslider::extract {
namespace {

constexpr std::uint64_t kKeptChanges = 1u << 16;

double millisecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

template <class Sample>
class Engine final : public SlideEngine {
    using Source = EdgeBlockSource<Sample>;
    using Live = typename Source::Live;

public:
    Engine(std::unique_ptr<index::IndexReader> reader, const SlideOptions& options)
        : reader_(std::move(reader)), source_(*reader_, options.cacheBytes),
          surface_(reader_->info().geometry, reader_->meta().missingCells, source_), changes_(reader_->grid().brickCount()),
          position_(source_.lowest()) {}

    const index::IndexInfo& info() const override { return reader_->info(); }

    Result<SlideStats> slideTo(double isovalue, std::stop_token stop) override {
        if (std::isnan(isovalue))
            return makeError(ErrorCode::InvalidArgument, "isovalue is not a number");
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
        lastStats_ = stats;
        return stats;
    }

    void copyFrame(SurfaceFrame& frame) const override {
        surface_.copyFrame(frame);
        frame.isovalue = lastStats_.isovalue;
        frame.stats = lastStats_;
        frame.isFromIndex = true;
        if (lastStats_.hasRebuilt) // everything is new: nothing to point out
            frame.changedIndices.clear();
    }

    SurfaceMesh mesh() const override { return surface_.mesh(lastStats_.isovalue); }

private:
    // From where to start: here, or from the empty surface below or above all values, whichever has
    // fewer edge entries on the way. An emptied surface costs nothing to remove.
    Status move(double isovalue, SlideStats& stats, std::stop_token stop) {
        const KeyThreshold target = source_.threshold(isovalue);
        std::uint64_t best = source_.estimate(position_, target);
        KeyThreshold start = position_;
        bool restarts = false;
        for (const KeyThreshold end : {source_.lowest(), source_.highest()}) {
            const std::uint64_t cost = source_.estimate(end, target);
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
        ISO_TRY(source_.collect(start, target, changes_, stats, stop));
        const std::uint64_t hiddenBytes = source_.hiddenBytesRead();
        ISO_TRY(surface_.apply(changes_, isovalue, stats));
        stats.bytesRead += source_.hiddenBytesRead() - hiddenBytes;
        lastTouched_ = stats.edgesTouched;
        position_ = target;
        return {};
    }

    void dropSurface() {
        surface_.clear();
        changes_.clear();
        position_ = source_.lowest();
    }

    std::unique_ptr<index::IndexReader> reader_;
    Source source_;
    ActiveSurface<Live> surface_;
    ChangeSet<Live> changes_;
    KeyThreshold position_;
    std::uint64_t lastTouched_ = 0;
    SlideStats lastStats_;
};

} // namespace

Result<std::unique_ptr<SlideEngine>> SlideEngine::open(const std::filesystem::path& indexPath, const SlideOptions& options) {
    auto reader = index::IndexReader::open(indexPath);
    if (!reader.isOk())
        return std::move(reader).error();
    const ScalarType type = reader.value()->info().type;
    return visitScalarType(type, [&](auto sample) -> Result<std::unique_ptr<SlideEngine>> {
        return std::unique_ptr<SlideEngine>(std::make_unique<Engine<decltype(sample)>>(std::move(reader).value(), options));
    });
}

} // namespace isoslider::extract
