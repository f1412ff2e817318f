#include "core/extract/slices/slice_sampler.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <tbb/parallel_for.h>

#include "core/extract/slices/trilinear_value.h"
#include "core/index/sample_store.h"

namespace isoslider::extract {
namespace {

/// Rows handed to a thread at once.
constexpr int kRowsTogether = 16;

SliceSamples emptySlice(const SlicePlane& plane) {
    return {plane, std::vector<float>(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height),
                                      std::numeric_limits<float>::quiet_NaN())};
}

class MemorySampler final : public SliceSampler {
public:
    explicit MemorySampler(std::shared_ptr<const ScalarGrid> grid) : grid_(std::move(grid)) {}

    const GridGeometry& geometry() const override { return grid_->geometry(); }

    Result<SliceSamples> sample(const SlicePlane& plane, const JobControl& job) override {
        SliceSamples slice = emptySlice(plane);
        grid_->visit([&](auto samples) { fill(samples, slice, job); });
        if (job.isStopRequested())
            return cancelledError();
        return slice;
    }

private:
    template <class Samples>
    void fill(const Samples& samples, SliceSamples& slice, const JobControl& job) const {
        const GridDims& dims = grid_->dims();
        const SlicePlane& plane = slice.plane;
        const auto sampleAt = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
            return samples[static_cast<std::size_t>(x + dims[0] * (y + dims[1] * z))];
        };
        tbb::parallel_for(tbb::blocked_range<int>(0, plane.height, kRowsTogether), [&](const auto& rows) {
            for (int row = rows.begin(); row < rows.end() && !job.isStopRequested(); ++row) {
                float* value = &slice.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(plane.width)];
                for (int column = 0; column < plane.width; ++column, ++value)
                    if (const PlaceInCell cell = cellOf(plane.at(column, row), dims); cell.isInside)
                        *value = trilinearValue(cell, sampleAt);
            }
        });
    }

    std::shared_ptr<const ScalarGrid> grid_;
};

/// A square part of a slice.
struct Tile {
    static constexpr int kSide = 16;
    int column, row;
};

/// Decodes the chunks of samples that a batch of tiles needs, as many as the cache holds, then fills those tiles.
template <class Sample>
class StoredSampler final : public SliceSampler {
public:
    StoredSampler(std::unique_ptr<index::IndexReader> reader, std::uint64_t cacheBytes)
        : reader_(std::move(reader)),
          store_(*reader_),
          dims_(reader_->info().geometry.dims),
          capacity_(std::max<std::size_t>(kChunksOfTile, cacheBytes / (kSamples * sizeof(Sample)))) {}

    const GridGeometry& geometry() const override { return reader_->info().geometry; }

    Result<SliceSamples> sample(const SlicePlane& plane, const JobControl& job) override {
        SliceSamples slice = emptySlice(plane);
        std::vector<Tile> batch;
        Numbers wanted, ofTile;
        for (int row = 0; row < plane.height; row += Tile::kSide)
            for (int column = 0; column < plane.width; column += Tile::kSide) {
                ofTile.clear();
                collect(plane, {column, row}, ofTile);
                if (wanted.size() + ofTile.size() > capacity_) {
                    ISO_TRY(fill(slice, batch, wanted, job));
                    batch.clear();
                    wanted.clear();
                }
                batch.push_back({column, row});
                wanted.insert(ofTile.begin(), ofTile.end());
                if (job.isStopRequested())
                    return cancelledError();
            }
        ISO_TRY(fill(slice, batch, wanted, job));
        return slice;
    }

private:
    static constexpr std::size_t kSamples = index::SampleStore::kChunkSamples;
    static constexpr int kSide = index::kChunkSide;
    static constexpr std::size_t kChunksOfTile = 8 * Tile::kSide * Tile::kSide; // pixels far apart: eight each
    using Numbers = std::unordered_set<std::uint64_t>;
    struct Kept {
        std::unique_ptr<Sample[]> samples;
        std::uint64_t usedAt = 0; ///< the batch that needed it last
    };

    std::uint64_t chunkOf(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return store_.chunks().chunkAt(x / kSide, y / kSide, z / kSide).number();
    }

    /// Adds what chunks the pixels of a tile lie in.
    void collect(const SlicePlane& plane, const Tile& tile, Numbers& chunks) const {
        constexpr std::uint64_t kNoChunk = ~std::uint64_t{0};
        std::pair<std::uint64_t, std::uint64_t> last{kNoChunk, kNoChunk};
        forEachPixel(plane, tile, [&](const PlaceInCell& cell, std::size_t) {
            const auto& low = cell.low;
            const auto step = [&](std::size_t a) { return cell.part[a] > 0.0 ? 1 : 0; };
            const std::pair ends(chunkOf(low[0], low[1], low[2]),
                                 chunkOf(low[0] + step(0), low[1] + step(1), low[2] + step(2)));
            if (std::exchange(last, ends) == ends)
                return;
            for (std::int64_t corner = 0; corner < 8; ++corner)
                chunks.insert(chunkOf(low[0] + (corner & 1) * step(0), low[1] + (corner >> 1 & 1) * step(1),
                                      low[2] + (corner >> 2) * step(2)));
        });
    }

    /// Of the pixels inside the grid, with their place in the slice's values.
    template <class Visit>
    void forEachPixel(const SlicePlane& plane, const Tile& tile, const Visit& visit) const {
        const int endRow = std::min(plane.height, tile.row + Tile::kSide);
        const int endColumn = std::min(plane.width, tile.column + Tile::kSide);
        for (int row = tile.row; row < endRow; ++row)
            for (int column = tile.column; column < endColumn; ++column)
                if (const PlaceInCell cell = cellOf(plane.at(column, row), dims_); cell.isInside)
                    visit(cell, static_cast<std::size_t>(row) * static_cast<std::size_t>(plane.width) +
                                    static_cast<std::size_t>(column));
    }

    Status fill(SliceSamples& slice, const std::vector<Tile>& tiles, const Numbers& wanted, const JobControl& job) {
        ISO_TRY(decode(wanted, job));
        tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t i) {
            std::uint64_t last = ~std::uint64_t{0};
            const Sample* samples = nullptr;
            const auto sampleAt = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
                const std::uint64_t chunk = chunkOf(x, y, z);
                if (std::exchange(last, chunk) != chunk)
                    samples = cache_.find(chunk)->second.samples.get();
                return samples[x % kSide + kSide * (y % kSide + kSide * (z % kSide))];
            };
            forEachPixel(slice.plane, tiles[i], [&](const PlaceInCell& cell, std::size_t pixel) {
                slice.values[pixel] = trilinearValue(cell, sampleAt);
            });
        });
        return job.isStopRequested() ? Status(cancelledError()) : Status();
    }

    Status decode(const Numbers& wanted, const JobControl& job) {
        ++batch_;
        std::vector<index::ChunkIndex> missing;
        for (const std::uint64_t chunk : wanted)
            if (const auto found = cache_.find(chunk); found != cache_.end())
                found->second.usedAt = batch_;
            else
                missing.emplace_back(chunk);
        if (missing.empty())
            return {};
        std::sort(missing.begin(), missing.end());
        makeRoom(missing.size());
        std::uint64_t bytes = 0;
        store_.willNeed(missing, bytes, job.stop);
        std::vector<std::unique_ptr<Sample[]>> decoded(missing.size());
        std::mutex mutex;
        std::optional<Error> error;
        tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) {
            if (job.isStopRequested())
                return;
            std::uint64_t read = 0;
            auto samples = std::make_unique<Sample[]>(kSamples);
            const Status status =
                store_.read<Sample>(missing[i], std::span<Sample, kSamples>(samples.get(), kSamples), read);
            if (status.isOk()) {
                decoded[i] = std::move(samples);
                return;
            }
            const std::lock_guard lock(mutex);
            if (!error)
                error = status.error();
        });
        // What has been decoded is of use to the next slice, whatever became of the rest.
        for (std::size_t i = 0; i < missing.size(); ++i)
            if (decoded[i])
                cache_.emplace(missing[i].number(), Kept{std::move(decoded[i]), batch_});
        if (error)
            return std::move(*error);
        return job.isStopRequested() ? Status(cancelledError()) : Status();
    }

    /// Lets those go that were used the longest time ago.
    void makeRoom(std::size_t count) {
        if (cache_.size() + count <= capacity_)
            return;
        std::vector<std::pair<std::uint64_t, std::uint64_t>> old; // when, and which
        for (const auto& [chunk, kept] : cache_)
            if (kept.usedAt != batch_)
                old.emplace_back(kept.usedAt, chunk);
        const std::size_t leaving = std::min(old.size(), cache_.size() + count - capacity_);
        std::partial_sort(old.begin(), old.begin() + static_cast<std::ptrdiff_t>(leaving), old.end());
        for (std::size_t i = 0; i < leaving; ++i)
            cache_.erase(old[i].second);
    }

    std::unique_ptr<index::IndexReader> reader_;
    index::SampleStore store_;
    GridDims dims_;
    std::size_t capacity_; ///< chunks
    std::unordered_map<std::uint64_t, Kept> cache_;
    std::uint64_t batch_ = 0;
};

} // namespace

std::unique_ptr<SliceSampler> makeSliceSampler(std::shared_ptr<const ScalarGrid> grid) {
    return std::make_unique<MemorySampler>(std::move(grid));
}

Result<std::unique_ptr<SliceSampler>> openSliceSampler(const std::filesystem::path& indexPath,
                                                       std::uint64_t cacheBytes) {
    auto reader = index::IndexReader::open(indexPath);
    if (!reader.isOk())
        return reader.error();
    return visitScalarType(reader.value()->info().type, [&](auto sample) -> std::unique_ptr<SliceSampler> {
        return std::make_unique<StoredSampler<decltype(sample)>>(std::move(reader).value(), cacheBytes);
    });
}

} // namespace isoslider::extract
