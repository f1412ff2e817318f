#include "tests/bench/flat_runner.h"

#include <tbb/task_arena.h>

#include "core/grid/gradient.h"
#include "core/index/sample_store.h"
#include "tests/bench/flat_baseline.h"
#include "tests/bench/flat_changes.h"
#include "tests/bench/timing.h"

namespace isoslider::bench {
namespace {

constexpr std::uint64_t kCacheBytes = std::uint64_t{256} << 20; // as the product has

std::uint64_t averageActiveEdges(const index::IndexInfo& info) {
    std::uint64_t sum = 0;
    for (const std::uint64_t edges : info.activeEdgesPerBin)
        sum += edges;
    return info.activeEdgesPerBin.empty() ? 0 : sum / info.activeEdgesPerBin.size();
}

// What blocks do not state of points, in the order of ids.
template <class Sample>
struct PointsById {
    std::vector<KeyOf<Sample>> keys;
    std::vector<NormalCode> normals;

    PointsById(const ScalarGrid& volume, const BrickGrid& grid)
        : keys(grid.idCount()), normals(grid.idCount(), kNoNormal) {
        const SampleView<Sample> view{volume.values<Sample>().data(), grid.dims()};
        const glm::vec3 inverseSpacing = inverseSpacingOf(volume.geometry());
        for (std::int64_t z = 0; z < grid.dims()[2]; ++z)
            for (std::int64_t y = 0; y < grid.dims()[1]; ++y)
                for (std::int64_t x = 0; x < grid.dims()[0]; ++x) {
                    const Sample sample = view.samples[view.offset(x, y, z)];
                    const std::size_t id = grid.pointId(x, y, z).index();
                    keys[id] = isMissing(sample) ? KeyOf<Sample>(0) : keyOf(sample);
                    if (!isMissing(sample))
                        normals[id] = normalOfGradient(gradientAt(view, x, y, z, inverseSpacing));
                }
    }
};

template <class Sample>
class Runner final : public FlatRunner {
    using Live = extract::LiveOf<Sample>;

public:
    Runner(std::unique_ptr<index::IndexReader> reader, const ScalarGrid& volume)
        : reader_(std::move(reader)),
          points_(volume, reader_->grid()),
          walk_(*reader_, kCacheBytes),
          surface_(reader_->info().geometry, reader_->meta().missingCells, averageActiveEdges(reader_->info())) {}

    Result<FlatStep> slideTo(double isovalue) override {
        FlatStep step;
        Status moved;
        oneThread_.execute([&] {
            const double start = nowMs();
            moved = move(thresholdOf<Sample>(isovalue));
            const double between = nowMs();
            surface_.interpolate(isovalue);
            step.updateMs = between - start;
            step.interpolateMs = nowMs() - between;
        });
        if (!moved.isOk())
            return moved.error();
        step.activeEdges = surface_.activeEdges();
        step.triangles = surface_.triangles();
        step.memoryBytes = surface_.memoryBytes();
        return step;
    }

private:
    Status move(KeyThreshold target) {
        ISO_TRY(collectEdgeChanges<Sample>(walk_, reader_->grid(), position_, target, points_.keys, points_.normals,
                                           changes_));
        surface_.apply(changes_);
        position_ = target;
        return {};
    }

    std::unique_ptr<index::IndexReader> reader_;
    PointsById<Sample> points_;
    extract::BlockWalk<KeyOf<Sample>> walk_;
    EdgeChanges<Live> changes_;
    FlatBaseline<Live> surface_;
    KeyThreshold position_ = 0; // below every sample
    tbb::task_arena oneThread_{1};
};

} // namespace

Result<std::unique_ptr<FlatRunner>> FlatRunner::open(const std::filesystem::path& indexPath) {
    auto reader = index::IndexReader::open(indexPath);
    if (!reader.isOk())
        return std::move(reader).error();
    const auto volume = index::readSamples(*reader.value());
    if (!volume.isOk())
        return volume.error();
    const ScalarType type = reader.value()->info().type;
    return visitScalarType(type, [&](auto sample) -> Result<std::unique_ptr<FlatRunner>> {
        return std::unique_ptr<FlatRunner>(
            std::make_unique<Runner<decltype(sample)>>(std::move(reader).value(), *volume.value()));
    });
}

} // namespace isoslider::bench
