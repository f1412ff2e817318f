#include "preprocess/metacells/metacell_forecast.h"

#include <algorithm>
#include <atomic>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/base/memory_file_system.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/format/chunk_table.h"
#include "core/index/format/point_record.h"
#include "preprocess/forecast/scaled_size.h"
#include "preprocess/metacells/chunk_scan.h"

namespace isoslider::preprocess {
namespace {

constexpr std::uint64_t kMostSlabs = 16;
constexpr std::uint64_t kLeastChunks = 256, kMostChunks = 2048; ///< one in kChunkShare between those
constexpr std::uint64_t kChunkShare = 32;

template <class Sample>
class ChunkSampler {
public:
    using Key = KeyOf<Sample>;

    ChunkSampler(io::VolumeSource& source, BrickSpans<Key>& spans, const JobControl& job)
        : source_(source),
          dims_(source.info().geometry.dims),
          bricks_(dims_),
          chunks_(dims_),
          spans_(spans),
          job_(job),
          workers_([this] { return Worker(dims_); }) {}

    Status run() {
        const SpreadSample slabs(static_cast<std::uint64_t>(chunks_.chunks()[2]), kMostSlabs);
        const std::uint64_t all = chunks_.chunkCount();
        const std::uint64_t wanted = std::clamp(all / kChunkShare, kLeastChunks, kMostChunks);
        for (std::uint64_t i = 0; i < slabs.count(); ++i) {
            if (job_.isStopRequested())
                return cancelledError();
            job_.report(static_cast<double>(i) / static_cast<double>(slabs.count()), "estimating the size");
            ISO_TRY(sample(static_cast<std::int64_t>(slabs.at(i)), (wanted + slabs.count() - 1) / slabs.count()));
        }
        for (const Worker& worker : workers_) {
            bytes_ += worker.bytes;
            missingCells_.insert(missingCells_.end(), worker.missingCells.begin(), worker.missingCells.end());
        }
        return {};
    }

    /// Of all chunks, as many as one that was looked at stands for.
    double ratio() const { return static_cast<double>(chunks_.chunkCount()) / static_cast<double>(seen_.size()); }
    double chunkBytes() const {
        return ratio() * static_cast<double>(bytes_) + static_cast<double>(index::chunkTableBytes(chunks_));
    }
    std::vector<index::MissingCells> takeMissingCells() {
        std::sort(missingCells_.begin(), missingCells_.end(),
                  [](const auto& a, const auto& b) { return a.brick < b.brick; });
        return std::move(missingCells_);
    }

    /// Of the bricks in those chunks, side by side: so they lie as close as all of them in the whole volume.
    BrickSpans<Key> seenSpans() const {
        BrickSpans<Key> seen;
        constexpr std::int64_t kSide = index::ChunkGrid::kBricksPerSide;
        for (const index::ChunkIndex chunk : seen_) {
            const auto c = chunks_.chunkCoords(chunk);
            for (std::int64_t k = 0; k < kSide * kSide * kSide; ++k) {
                const std::array<std::int64_t, 3> b{c[0] * kSide + k % kSide, c[1] * kSide + k / kSide % kSide,
                                                    c[2] * kSide + k / (kSide * kSide)};
                if (b[0] >= bricks_.bricks()[0] || b[1] >= bricks_.bricks()[1] || b[2] >= bricks_.bricks()[2])
                    continue;
                const std::size_t at = bricks_.brickAt(b[0], b[1], b[2]).index();
                seen.least.push_back(spans_.least[at]);
                seen.greatest.push_back(spans_.greatest[at]);
            }
        }
        return seen;
    }

private:
    struct Worker {
        explicit Worker(const GridDims& dims) : scan(dims) {}
        ChunkScan<Sample> scan;
        std::vector<index::MissingCells> missingCells;
        std::uint64_t bytes = 0;
    };

    Status sample(std::int64_t slab, std::uint64_t wanted) {
        const std::int64_t begin = std::max<std::int64_t>(0, slab * index::kChunkSide - 1);
        const std::int64_t end = std::min<std::int64_t>(dims_[2], (slab + 1) * index::kChunkSide + 1);
        const auto plane = static_cast<std::size_t>(dims_[0] * dims_[1]);
        planes_.resize(plane * static_cast<std::size_t>(end - begin));
        ISO_TRY(source_.readSlab(begin, end, std::as_writable_bytes(std::span(planes_))));
        const GridDims& sides = chunks_.chunks();
        const SpreadSample places(static_cast<std::uint64_t>(sides[0] * sides[1]), wanted);
        const std::size_t first = seen_.size();
        for (std::uint64_t i = 0; i < places.count(); ++i) {
            const auto at = static_cast<std::int64_t>(places.at(i, static_cast<std::uint64_t>(slab) + 1));
            seen_.push_back(chunks_.chunkAt(at % sides[0], at / sides[0], slab));
        }
        const auto planeAt = [&](std::int64_t z) {
            return planes_.data() + plane * static_cast<std::size_t>(z - begin);
        };
        tbb::parallel_for(first, seen_.size(), [&](std::size_t i) {
            Worker& worker = workers_.local();
            worker.scan.load(seen_[i], planeAt);
            worker.scan.spans(spans_);
            worker.scan.missingCells(worker.missingCells);
            worker.bytes += index::encodeChunk<Sample>(worker.scan.packed(), worker.scan.extent()).size();
        });
        return {};
    }

    io::VolumeSource& source_;
    GridDims dims_;
    BrickGrid bricks_;
    index::ChunkGrid chunks_;
    BrickSpans<Key>& spans_;
    const JobControl& job_;
    tbb::enumerable_thread_specific<Worker> workers_;
    std::vector<Sample> planes_;
    std::vector<index::ChunkIndex> seen_;
    std::uint64_t bytes_ = 0;
    std::vector<index::MissingCells> missingCells_;
};

} // namespace

template <class Sample>
Result<DiskForecast> forecastMetacells(io::VolumeSource& source, BrickSpans<KeyOf<Sample>>& spans,
                                       const BrickListOptions& list, const std::filesystem::path& indexPath,
                                       const JobControl& job) {
    using Key = KeyOf<Sample>;
    ChunkSampler<Sample> sampler(source, spans, job);
    ISO_TRY(sampler.run());
    auto scaled = ScaledIndex::begin(indexPath);
    if (!scaled.isOk())
        return std::move(scaled).error();
    const BrickSpans<Key> seen = sampler.seenSpans();
    MemoryFileSystem memory;
    index::IndexMeta meta;
    ISO_TRY(writeBrickList(seen, {static_cast<std::int64_t>(seen.least.size()) * kBrickSide, kBrickSide, kBrickSide},
                           list, "bricks.sort", memory, scaled.value()->writer(), meta.info.levels, job));
    meta.info.kind = index::IndexKind::Metacells;
    meta.missingCells = sampler.takeMissingCells();
    const double ratio = sampler.ratio();
    const auto other = scaled.value()->finish(std::move(meta), ratio, ratio);
    if (!other.isOk())
        return other.error();
    DiskForecast forecast;
    forecast.indexBytes = static_cast<std::uint64_t>(sampler.chunkBytes() + other.value());
    // The list of bricks is sorted on disk where it does not fit into memory.
    const std::uint64_t records = BrickGrid(source.info().geometry.dims).brickCount() * 2;
    const std::uint64_t bytes = records * sizeof(index::PointRecord<Key>);
    forecast.temporaryBytes = bytes + bytes / 2 > list.memoryBytes ? bytes : 0;
    return forecast;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template Result<DiskForecast> forecastMetacells<Sample>(io::VolumeSource&, BrickSpans<KeyOf<Sample>>&, \
                                                            const BrickListOptions&, const std::filesystem::path&, \
                                                            const JobControl&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
