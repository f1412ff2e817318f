#include "preprocess/edges/edge_forecast.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include "core/grid/classification.h"
#include "core/grid/scalar_grid.h"
#include "core/index/format/chunk_table.h"
#include "preprocess/edges/block_choice.h"
#include "preprocess/edges/record_generator.h"
#include "preprocess/edges/sample_chunks.h"
#include "preprocess/forecast/scaled_size.h"
#include "preprocess/index_builds.h"
#include "preprocess/levels/level_builder.h"

namespace isoslider::preprocess {
namespace {

constexpr std::int64_t kTileBricks = 4; ///< along x and y; one along z
constexpr std::uint64_t kTilePoints = kTileBricks * kTileBricks * kBrickPoints;
constexpr std::uint64_t kMostLayers = 16;
constexpr std::uint64_t kLeastPoints = 1u << 17, kMostPoints = 1u << 19; ///< one in kPointShare between those
constexpr std::uint64_t kPointShare = 24;
constexpr std::uint64_t kMostSparsePoints = 1u << 21, kLeastRecords = 1u << 16;

template <class Sample>
std::uint64_t unequalPairs(const Sample* a, const Sample* b, std::int64_t count) {
    std::uint64_t pairs = 0;
    for (std::int64_t i = 0; i < count; ++i)
        pairs += a[i] != b[i] && !isMissing(a[i]) && !isMissing(b[i]) ? 1u : 0u;
    return pairs;
}

// Bricks [begin, end) of a layer, and, where the volume has them, one more on every side.
struct Tile {
    std::array<std::int64_t, 3> begin{}, end{}; ///< bricks of the volume
    std::array<std::int64_t, 3> from{}; ///< first brick with its apron
    GridDims dims{}; ///< points with it

    Tile(const BrickGrid& grid, const std::array<std::int64_t, 3>& first) : begin(first) {
        constexpr std::array<std::int64_t, 3> kSides{kTileBricks, kTileBricks, 1};
        for (std::size_t a = 0; a < 3; ++a) {
            const auto axis = static_cast<int>(a);
            end[a] = std::min(begin[a] + kSides[a], grid.bricks()[axis]);
            from[a] = std::max<std::int64_t>(0, begin[a] - 1);
            dims[axis] = std::min((end[a] + 1) * kBrickSide, grid.dims()[axis]) - from[a] * kBrickSide;
        }
    }
    bool holds(const std::array<std::int64_t, 3>& brick) const {
        for (std::size_t a = 0; a < 3; ++a)
            if (brick[a] < begin[a] || brick[a] >= end[a])
                return false;
        return true;
    }
};

template <class Sample>
class EdgeSampler {
public:
    using Key = KeyOf<Sample>;
    using Record = index::PointRecord<Key>;

    EdgeSampler(io::VolumeSource& source, const EdgeCounts& counts, const BuildOptions& options, const JobControl& job)
        : source_(source),
          geometry_(source.info().geometry),
          grid_(geometry_.dims),
          counts_(counts),
          options_(options),
          job_(job),
          lanes_(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), SpanHistogram(1)) {}

    // Where little of the volume has edges, more of it is looked at: few records say little of full pages.
    Status run() {
        const auto all = static_cast<std::uint64_t>(pointCount(geometry_.dims));
        std::uint64_t wanted = std::clamp(all / kPointShare, kLeastPoints, kMostPoints);
        ISO_TRY(sampleAbout(wanted));
        for (; records_.size() < kLeastRecords && points_ < all && wanted < kMostSparsePoints; wanted *= 4) {
            records_.clear();
            missingCells_.clear();
            pairs_ = points_ = chunkPoints_ = chunkBytes_ = 0;
            ISO_TRY(sampleAbout(4 * wanted));
        }
        return {};
    }

    Result<EdgeForecast> forecast(const std::filesystem::path& indexPath) {
        auto scaled = ScaledIndex::begin(indexPath);
        if (!scaled.isOk())
            return std::move(scaled).error();
        index::IndexWriter& writer = scaled.value()->writer();
        const double pointRatio = static_cast<double>(pointCount(geometry_.dims)) / static_cast<double>(points_);
        const double entryRatio =
            pairs_ > 0 ? static_cast<double>(counts_.unequalPairs) / static_cast<double>(pairs_) : pointRatio;
        const auto records = static_cast<double>(records_.size());
        auto levels = buildLevels(writer, std::max(entryRatio, 1e-9));
        if (!levels.isOk())
            return std::move(levels).error();
        index::IndexMeta meta;
        meta.info.levels = std::move(levels).value();
        std::sort(missingCells_.begin(), missingCells_.end(),
                  [](const auto& a, const auto& b) { return a.brick < b.brick; });
        meta.missingCells = std::move(missingCells_);
        const auto bytes = scaled.value()->finish(std::move(meta), entryRatio, pointRatio);
        if (!bytes.isOk())
            return bytes.error();
        EdgeForecast forecast;
        forecast.disk = {static_cast<std::uint64_t>(bytes.value() + bytesOfChunks()),
                         static_cast<std::uint64_t>(records * entryRatio) * sizeof(Record)};
        forecast.bytesPerEntry = bytesPerEntry_;
        return forecast;
    }

private:
    Status sampleAbout(std::uint64_t wanted) {
        const GridDims& bricks = grid_.bricks();
        const SpreadSample layers(static_cast<std::uint64_t>(bricks[2]), kMostLayers);
        const GridDims tiles{(bricks[0] + kTileBricks - 1) / kTileBricks, (bricks[1] + kTileBricks - 1) / kTileBricks,
                             1};
        const SpreadSample places(static_cast<std::uint64_t>(tiles[0] * tiles[1]),
                                  wanted / (kTilePoints * layers.count()) + 1);
        records_.reserve(layers.count() * places.count() * kTilePoints); // growing would hold them twice
        for (std::uint64_t i = 0; i < layers.count(); ++i) {
            job_.report(static_cast<double>(i) / static_cast<double>(layers.count()), "estimating the size");
            const auto layer = static_cast<std::int64_t>(layers.at(i));
            ISO_TRY(readPlanes(layer));
            for (std::uint64_t k = 0; k < places.count(); ++k) {
                if (job_.isStopRequested())
                    return cancelledError();
                const auto at = static_cast<std::int64_t>(places.at(k, static_cast<std::uint64_t>(layer) + 1));
                ISO_TRY(sample(Tile(grid_, {at % tiles[0] * kTileBricks, at / tiles[0] * kTileBricks, layer})));
            }
        }
        return {};
    }

    // The planes that a layer's records depend on; of merged cells those of the layers beside it do, too.
    Status readPlanes(std::int64_t layer) {
        const std::int64_t apron = merges() ? kBrickSide : kLayerApron;
        planesBegin_ = std::max<std::int64_t>(0, layer * kBrickSide - apron);
        planesEnd_ = std::min(geometry_.dims[2], (layer + 1) * kBrickSide + apron);
        planes_.resize(static_cast<std::size_t>(geometry_.dims[0] * geometry_.dims[1] * (planesEnd_ - planesBegin_)));
        return source_.readSlab(planesBegin_, planesEnd_, std::as_writable_bytes(std::span(planes_)));
    }

    // As a separate volume; planes that were not read stay 0.
    std::unique_ptr<io::VolumeSource> cut(const Tile& tile) const {
        GridGeometry geometry = geometry_;
        geometry.dims = tile.dims;
        std::vector<Sample> samples(static_cast<std::size_t>(pointCount(tile.dims)));
        const std::int64_t z0 = tile.from[2] * kBrickSide;
        for (std::int64_t z = std::max(z0, planesBegin_); z < std::min(z0 + tile.dims[2], planesEnd_); ++z)
            for (std::int64_t y = 0; y < tile.dims[1]; ++y) {
                const Sample* row =
                    planes_.data() +
                    geometry_.dims[0] * (tile.from[1] * kBrickSide + y + geometry_.dims[1] * (z - planesBegin_)) +
                    tile.from[0] * kBrickSide;
                std::copy_n(row, tile.dims[0], samples.begin() + tile.dims[0] * (y + tile.dims[1] * (z - z0)));
            }
        return io::makeMemorySource(std::make_shared<const ScalarGrid>(
            ScalarGrid::fromValues<Sample>(geometry, source_.info().type, std::span<const Sample>(samples))));
    }

    Status sample(const Tile& tile) {
        const auto source = cut(tile);
        const GridGeometry& geometry = source->info().geometry;
        const BrickGrid tileGrid(tile.dims);
        SlabWindow<Sample> window(*source, kLayerPlanes);
        std::optional<MergedLayers<Sample>> merged;
        if (merges())
            merged.emplace(tile.dims, extract::boundOf(options_.mergeError, counts_.min, counts_.max), job_.stop);
        const KeyIntervals anyKey({0});
        const std::int64_t last = tile.begin[2] - tile.from[2];
        const auto consume = [&](const LayerRecords<Key>& records) -> Status {
            for (std::size_t i = 0; i < records.bricks.size(); ++i)
                take(tile, tileGrid.brickCoords(records.firstBrick + i), records.bricks[i]);
            for (index::MissingCells missing : records.missingCells) {
                const auto brick = inVolume(tile, tileGrid.brickCoords(missing.brick));
                missing.brick = grid_.brickAt(brick[0], brick[1], brick[2]);
                if (tile.holds(brick))
                    missingCells_.push_back(missing);
            }
            return {};
        };
        for (std::int64_t layer = merges() ? 0 : last; layer <= last; ++layer) {
            ISO_TRY(window.advance(std::max<std::int64_t>(0, layer * kBrickSide - kLayerApron),
                                   std::min(tile.dims[2], (layer + 1) * kBrickSide + kLayerApron)));
            ISO_TRY(generateLayer<Sample>(
                window, geometry, layer, anyKey, lanes_, merged ? &*merged : nullptr,
                layer == last ? ConsumeRecords<Key>(consume) : [](const LayerRecords<Key>&) { return Status(); }));
        }
        countPairs(tile);
        encodeSamplesOf(tile);
        return {};
    }

    // In chunks half as high: a layer has no more planes.
    void encodeSamplesOf(const Tile& tile) {
        const SampleView<Sample> view{planes_.data(),
                                      {geometry_.dims[0], geometry_.dims[1], planesEnd_ - planesBegin_}};
        const std::int64_t z0 = tile.begin[2] * kBrickSide;
        const auto countFrom = [&](int axis, std::int64_t first, std::int64_t end) {
            return static_cast<int>(
                std::min<std::int64_t>({index::kChunkSide, geometry_.dims[axis] - first, end - first}));
        };
        const std::int64_t endX = tile.end[0] * kBrickSide, endY = tile.end[1] * kBrickSide;
        for (std::int64_t y = tile.begin[1] * kBrickSide; y < std::min(endY, geometry_.dims[1]); y += index::kChunkSide)
            for (std::int64_t x = tile.begin[0] * kBrickSide; x < std::min(endX, geometry_.dims[0]);
                 x += index::kChunkSide) {
                const index::ChunkExtent extent{countFrom(0, x, endX), countFrom(1, y, endY),
                                                countFrom(2, z0, z0 + kBrickSide)};
                chunkPoints_ += static_cast<std::uint64_t>(extent[0] * extent[1] * extent[2]);
                chunkBytes_ += encodeSamples<Sample>(view, {x, y, z0 - planesBegin_}, extent).size();
            }
    }
    double bytesOfChunks() const {
        const double ratio = static_cast<double>(pointCount(geometry_.dims)) /
                             static_cast<double>(std::max<std::uint64_t>(1, chunkPoints_));
        return ratio * static_cast<double>(chunkBytes_) +
               static_cast<double>(index::chunkTableBytes(index::ChunkGrid(geometry_.dims)));
    }

    static std::array<std::int64_t, 3> inVolume(const Tile& tile, const std::array<std::int64_t, 3>& brick) {
        return {tile.from[0] + brick[0], tile.from[1] + brick[1], tile.from[2] + brick[2]};
    }

    void take(const Tile& tile, const std::array<std::int64_t, 3>& tileBrick, const std::vector<Record>& records) {
        const auto coords = inVolume(tile, tileBrick);
        if (!tile.holds(coords))
            return;
        const BrickIndex brick = grid_.brickAt(coords[0], coords[1], coords[2]);
        for (Record record : records) {
            record.setId(pointIn(brick, localOf(record.id())));
            records_.push_back(record);
        }
    }

    // As countUnequalPairs() does for the whole volume: pairs whose upper point lies in the tile.
    void countPairs(const Tile& tile) {
        const GridDims& dims = geometry_.dims;
        const auto row = [&](std::int64_t y, std::int64_t z) {
            return planes_.data() + dims[0] * (y + dims[1] * (z - planesBegin_));
        };
        const std::int64_t x0 = tile.begin[0] * kBrickSide, x1 = std::min(dims[0], tile.end[0] * kBrickSide);
        const std::int64_t y1 = std::min(dims[1], tile.end[1] * kBrickSide),
                           z1 = std::min(dims[2], tile.end[2] * kBrickSide);
        for (std::int64_t z = tile.begin[2] * kBrickSide; z < z1; ++z)
            for (std::int64_t y = tile.begin[1] * kBrickSide; y < y1; ++y) {
                const std::int64_t first = std::max<std::int64_t>(1, x0);
                pairs_ += unequalPairs(row(y, z) + first - 1, row(y, z) + first, x1 - first);
                pairs_ += y > 0 ? unequalPairs(row(y - 1, z) + x0, row(y, z) + x0, x1 - x0) : 0;
                pairs_ += z > 0 ? unequalPairs(row(y, z - 1) + x0, row(y, z) + x0, x1 - x0) : 0;
                points_ += static_cast<std::uint64_t>(x1 - x0);
            }
    }

    Result<std::vector<index::SkipLevelInfo>> buildLevels(index::IndexWriter& writer, double entryRatio) {
        const KeyIntervals bins = makeSpanBins(counts_.keys);
        SpanHistogram histogram(bins.count());
        for (const Record& record : records_) {
            const std::size_t bin = bins.find(record.key);
            const bool isPoint = record.form == index::record_form::kPoint;
            forEachEdge(record, [&](int e) {
                if (record.farKeys[e] > record.key && (isPoint || e == index::record_form::kOtherEnd))
                    histogram.add(bin, bins.find(record.farKeys[e]));
            });
        }
        if (!(options_.redundancyThreshold > 0.0))
            bytesPerEntry_ = bytesPerEntry(trialRecords(), grid_);
        const double points = static_cast<double>(pointCount(geometry_.dims)) / entryRatio;
        const BlockChoice choice =
            chooseBlocks(histogram, bins, options_.skipLevels, options_.redundancyThreshold, bytesPerEntry_, points);
        LevelBuilder<Key> builder(writer, grid_, index::FarEnds::Directions, choice.begins);
        std::vector<Record> piece;
        constexpr std::size_t kPieceRecords = 1u << 14;
        for (const std::uint32_t i : sortedOrder()) {
            piece.push_back(records_[i]);
            if (piece.size() < kPieceRecords)
                continue;
            ISO_TRY(builder.add(piece));
            piece.clear();
        }
        ISO_TRY(builder.add(piece));
        std::vector<Record>().swap(records_);
        ISO_TRY(builder.finish());
        return builder.levelInfos();
    }

    // The places of the records by key and id. Records are many times as large: sorting them would need room for half
    // of them once more.
    std::vector<std::uint32_t> sortedOrder() const {
        std::vector<std::uint32_t> order(records_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
            return records_[a].key != records_[b].key ? records_[a].key < records_[b].key
                                                      : records_[a].id() < records_[b].id();
        });
        return order;
    }

    // Whole bricks.
    std::vector<Record> trialRecords() const {
        constexpr std::size_t kTrialRecords = 8 * kValuePagePoints;
        const std::size_t step = records_.size() / kTrialRecords + 1;
        std::vector<Record> trial;
        for (std::size_t i = 0, brick = 0; i < records_.size(); ++i) {
            brick += i > 0 && brickOf(records_[i].id()) != brickOf(records_[i - 1].id());
            if (brick % step == 0 && records_[i].edgeMask != 0)
                trial.push_back(records_[i]);
        }
        return trial;
    }

    bool merges() const { return options_.mergeError.amount > 0.0; }

    io::VolumeSource& source_;
    GridGeometry geometry_;
    BrickGrid grid_;
    const EdgeCounts& counts_;
    const BuildOptions& options_;
    const JobControl& job_;
    std::vector<SpanHistogram> lanes_; ///< what generateLayer counts is not looked at
    std::vector<Sample> planes_; ///< [planesBegin_, planesEnd_)
    std::int64_t planesBegin_ = 0, planesEnd_ = 0;
    std::vector<Record> records_;
    std::vector<index::MissingCells> missingCells_;
    std::uint64_t pairs_ = 0, points_ = 0;
    std::uint64_t chunkPoints_ = 0, chunkBytes_ = 0; ///< of which samples were encoded; the bytes they take
    double bytesPerEntry_ = 0.0;
};

} // namespace

template <class Sample>
std::uint64_t countUnequalPairs(const SlabWindow<Sample>& window, const GridDims& dims, std::int64_t z0,
                                std::int64_t z1) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::int64_t>(z0, z1), std::uint64_t{0},
        [&](const tbb::blocked_range<std::int64_t>& planes, std::uint64_t pairs) {
            for (std::int64_t z = planes.begin(); z < planes.end(); ++z) {
                const Sample* plane = window.plane(z);
                for (std::int64_t y = 0; y < dims[1]; ++y)
                    pairs += unequalPairs(plane + dims[0] * y, plane + dims[0] * y + 1, dims[0] - 1);
                pairs += unequalPairs(plane, plane + dims[0], dims[0] * (dims[1] - 1));
                pairs += z > 0 ? unequalPairs(window.plane(z - 1), plane, dims[0] * dims[1]) : 0;
            }
            return pairs;
        },
        std::plus<>());
}

template <class Sample>
Result<EdgeForecast> forecastEdges(io::VolumeSource& source, const EdgeCounts& counts, const BuildOptions& options,
                                   std::uint64_t sortMemory, const std::filesystem::path& indexPath,
                                   const JobControl& job) {
    using Record = index::PointRecord<KeyOf<Sample>>;
    EdgeSampler<Sample> sampler(source, counts, options, job);
    ISO_TRY(sampler.run());
    auto forecast = sampler.forecast(indexPath);
    if (!forecast.isOk())
        return forecast;
    // Runs of the sort are written where they do not fit into memory, or a checkpoint asks for them.
    std::uint64_t& temporary = forecast.value().disk.temporaryBytes;
    if (isBrief(source.info().geometry.dims, options)) {
        temporary = temporary + temporary / 2 > sortMemory ? temporary : 0;
        return forecast;
    }
    // Two checkpoints: the next one replaces the one before only when it is whole.
    const std::uint64_t bins = std::min<std::uint64_t>(counts.keys.size(), kMaxSpanBins);
    temporary +=
        2 * std::max<std::uint64_t>(bins * bins * sizeof(std::uint32_t),
                                    static_cast<std::uint64_t>(options.skipLevels) * kChunkPoints * sizeof(Record));
    return forecast;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template std::uint64_t countUnequalPairs<Sample>(const SlabWindow<Sample>&, const GridDims&, std::int64_t, \
                                                     std::int64_t); \
    template Result<EdgeForecast> forecastEdges<Sample>(io::VolumeSource&, const EdgeCounts&, const BuildOptions&, \
                                                        std::uint64_t, const std::filesystem::path&, \
                                                        const JobControl&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
