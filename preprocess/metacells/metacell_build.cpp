#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <xxhash.h>

#include "core/grid/classification.h"
#include "core/grid/distinct_keys.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/index_writer.h"
#include "core/index/sample_store.h"
#include "preprocess/forecast/topology_bytes.h"
#include "preprocess/index_builds.h"
#include "preprocess/metacells/brick_list.h"
#include "preprocess/metacells/chunk_scan.h"
#include "preprocess/metacells/metacell_forecast.h"
#include "preprocess/metacells/plane_ring.h"
#include "preprocess/resume/build_checkpoints.h"

namespace isoslider::preprocess {
namespace {

// One pass over the samples: each chunk is looked at while it is in the nearest cache, encoded, and written
// in order, while the next slab is read. 32- and 64-bit samples need their range before they can be counted:
// a first pass that does nothing else. The list of bricks follows the samples.
//
// Memory: 18 planes, 16 more where the budget allows, rows of encoded chunks on their way to the disk, least and
// greatest key of each brick (1/256 of the samples for 16-bit ones), and the sets of distinct values, which keep to
// what is left. A budget that has no room for the least of these is refused.

template <class Sample>
class MetacellBuild {
public:
    using Key = KeyOf<Sample>;

    MetacellBuild(io::VolumeSource& source, const std::filesystem::path& path, const BuildOptions& options,
                  const JobControl& job)
        : source_(source),
          geometry_(source.info().geometry),
          bricks_(geometry_.dims),
          chunks_(geometry_.dims),
          path_(path),
          options_(options),
          job_(job),
          readsAhead_(PlaneRing<Sample>::memoryBytes(geometry_.dims, true) <= options.memoryBytes / 4),
          distinct_(distinctMemory()),
          checkpoints_(path, BuildIdentity::of(source, options), options) {}

    bool isResumed() const { return isResumed_; }
    const DiskForecast& forecast() const { return forecast_; }

    Result<index::IndexInfo> run() {
        if (leastMemory() > options_.memoryBytes)
            return makeError(ErrorCode::InvalidArgument,
                             "memory budget is too small for planes of this size: give at least " +
                                 std::to_string((leastMemory() >> 20) + 1) + "M",
                             options_.sourceName);
        spans_.least.resize(bricks_.brickCount());
        spans_.greatest.resize(bricks_.brickCount());
        auto left = checkpoints_.load();
        if (!left.isOk())
            return std::move(left).error();
        if (left.value())
            return resume(*left.value());
        double done = 0.03;
        ISO_TRY(makeForecast(job_.part(0.0, done)));
        ISO_TRY(checkRoom({}));
        if constexpr (!ValueCounts<Sample>::kByKey) {
            ISO_TRY(findRange(job_.part(done, 0.2)));
            done = 0.2;
        }
        ISO_TRY(storeSamples(0, job_.part(done, 0.9)));
        return finish();
    }

private:
    Result<index::IndexInfo> resume(const std::vector<std::byte>& left) {
        StateArchive archive(left);
        auto writer = index::IndexWriter::resume(path_, archive, fileSystemOf(options_));
        if (!writer.isOk())
            return std::move(writer).error();
        writer_ = std::move(writer).value();
        checkpoints_.own(true);
        isResumed_ = true;
        std::int64_t slab = 0;
        state(slab, archive);
        if (archive.hasFailed() || archive.remaining() != 0)
            return makeError(ErrorCode::Corruption, "the state of an unfinished build is damaged", path_.string());
        ISO_TRY(checkRoom({writer_->sizeBytes(), left.size()}));
        // Kept is how many distinct values there were, not which.
        if constexpr (!ValueCounts<Sample>::kByKey)
            ISO_TRY(forEachSlab(job_.part(0.0, 0.1), "counting values", 0, slab, countingSamples()));
        ISO_TRY(storeSamples(slab, job_.part(0.1, 0.9)));
        return finish();
    }

    BrickListOptions listOptions() const {
        BrickListOptions list;
        list.skipLevels = options_.skipLevels;
        list.redundancyThreshold =
            options_.redundancyThreshold > 0.0 ? options_.redundancyThreshold : list.redundancyThreshold;
        list.memoryBytes = options_.memoryBytes / 2;
        return list;
    }

    Status makeForecast(const JobControl& job) {
        const auto forecast = forecastMetacells<Sample>(source_, spans_, listOptions(), path_, job);
        if (!forecast.isOk())
            return forecast.error();
        forecast_ = forecast.value();
        if (options_.withTopology)
            ISO_TRY(addTopology(source_, job, forecast_));
        // Two checkpoints: the next one replaces the one before only when it is whole.
        constexpr std::uint64_t kCounts = (std::uint64_t{1} << 16) * 16 + 4096;
        if (!isBrief(geometry_.dims, options_))
            forecast_.temporaryBytes += 2 * (bricks_.brickCount() * 2 * sizeof(Key) + kCounts);
        return {};
    }
    Status checkRoom(const DiskForecast& there) const {
        return preprocess::checkRoom(forecast_.less(there), path_, spillPathOf(path_, options_),
                                     fileSystemOf(options_));
    }

    Result<index::IndexInfo> finish() {
        ISO_TRY(countDistinct(job_.part(0.9, 0.95)));
        const BrickListOptions list = listOptions();
        info_.redundancyThreshold = list.redundancyThreshold;
        ISO_TRY(writeBrickList(spans_, geometry_.dims, list, spillPathOf(path_, options_), fileSystemOf(options_),
                               *writer_, info_.levels, job_.part(0.95, 1.0)));
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(source_.checkUnchanged());
        auto info = writer_->finish(makeMeta());
        if (info.isOk())
            checkpoints_.finish();
        return info;
    }

    // All that slabs before `slab` have left, whichever thread looked at them.
    void state(std::int64_t& slab, StateArchive& archive) {
        archive(slab);
        const std::int64_t layers = std::min(bricks_.bricks()[2], slab * PlaneRing<Sample>::kThickness / kBrickSide);
        const auto count =
            static_cast<std::size_t>(bricks_.bricks()[0] * bricks_.bricks()[1] * std::max<std::int64_t>(0, layers));
        archive.fixed(std::span(spans_.least).first(count));
        archive.fixed(std::span(spans_.greatest).first(count));
        archive(missingCells_);
        archive(forecast_);
        counts_.state(archive);
        if constexpr (!ValueCounts<Sample>::kByKey) {
            archive(info_.min);
            archive(info_.max);
            bins_ = ValueBins<Sample>(static_cast<Sample>(info_.min), static_cast<Sample>(info_.max));
        }
    }

    Status makeCheckpoint(std::int64_t nextSlab) {
        const auto begin = std::chrono::steady_clock::now();
        StateArchive archive;
        ISO_TRY(writer_->suspend(archive));
        state(nextSlab, archive);
        ISO_TRY(checkpoints_.save(archive.bytes(), writer_->sizeBytes(), begin));
        if (options_.resumes) // from now on there is something to go on with
            writer_->keepUnfinished();
        return {};
    }

    std::uint64_t planesAndSpans(bool readsAhead) const {
        return PlaneRing<Sample>::memoryBytes(geometry_.dims, readsAhead) + bricks_.brickCount() * 2 * sizeof(Key);
    }
    // Samples of a row of chunks, as large as their encoded form gets.
    std::uint64_t rowBytes() const {
        return static_cast<std::uint64_t>(chunks_.chunks()[0]) * index::SampleStore::kChunkSamples * sizeof(Sample);
    }
    std::uint64_t leastMemory() const {
        constexpr std::uint64_t kElsewhere = std::uint64_t{16} << 20; // counts of each thread, pages, the program's own
        return planesAndSpans(false) + 2 * rowBytes() + kElsewhere;
    }
    std::uint64_t distinctMemory() const {
        const std::uint64_t taken = planesAndSpans(readsAhead_) + options_.memoryBytes / 4;
        return std::max<std::uint64_t>(options_.memoryBytes / 16,
                                       options_.memoryBytes > taken ? (options_.memoryBytes - taken) / 2 : 0);
    }
    std::size_t rowsInFlight() const {
        const auto most = static_cast<std::uint64_t>(4 * tbb::this_task_arena::max_concurrency());
        return static_cast<std::size_t>(std::clamp<std::uint64_t>(options_.memoryBytes / 8 / rowBytes(), 2, most));
    }

    Error noSamples() const {
        return makeError(ErrorCode::InvalidArgument, "the volume has no finite sample", options_.sourceName);
    }

    // Calls work(slab, planes) for slab after slab, with progress.
    template <class Work>
    Status forEachSlab(const JobControl& job, std::string_view stage, const Work& work) {
        return forEachSlab(job, stage, 0, slabCount(), work);
    }
    template <class Work>
    Status forEachSlab(const JobControl& job, std::string_view stage, std::int64_t begin, std::int64_t end,
                       const Work& work) {
        PlaneRing<Sample> ring(source_, readsAhead_, job.stop, begin);
        for (std::int64_t slab = begin; slab < end; ++slab) {
            if (job.isStopRequested())
                return cancelledError();
            job.report(static_cast<double>(slab - begin) / static_cast<double>(end - begin), stage);
            ISO_TRY(ring.advance(slab));
            ISO_TRY(work(slab, ring));
        }
        return {};
    }

    std::int64_t slabCount() const { return chunks_.chunks()[2]; }

    // Least and greatest sample, lane by lane, so that whole vectors are compared; missing ones are beyond the ends.
    struct Range {
        static constexpr std::size_t kLanes = 16;
        static constexpr Sample kLowest = std::numeric_limits<Sample>::lowest(),
                                kGreatest = std::numeric_limits<Sample>::max();
        std::array<Sample, kLanes> low, high;

        Range() {
            low.fill(kGreatest);
            high.fill(kLowest);
        }
        void add(std::span<const Sample> samples) {
            const std::size_t whole = samples.size() - samples.size() % kLanes;
            for (std::size_t i = 0; i < whole; i += kLanes)
                for (std::size_t lane = 0; lane < kLanes; ++lane)
                    add(lane, samples[i + lane]);
            for (std::size_t i = whole; i < samples.size(); ++i)
                add(0, samples[i]);
        }
        void add(std::size_t lane, Sample sample) {
            const bool isFinite = sample >= kLowest && sample <= kGreatest;
            low[lane] = isFinite && sample < low[lane] ? sample : low[lane];
            high[lane] = isFinite && sample > high[lane] ? sample : high[lane];
        }
    };

    Status findRange(const JobControl& job) {
        tbb::enumerable_thread_specific<Range> ranges;
        std::atomic<bool> anyFinite = false;
        const auto plane = static_cast<std::size_t>(geometry_.dims[0] * geometry_.dims[1]);
        const auto take = [&](std::int64_t slab, const PlaneRing<Sample>& ring) -> Status {
            const std::int64_t begin = slab * ring.kThickness,
                               end = std::min(geometry_.dims[2], begin + ring.kThickness);
            tbb::parallel_for(begin, end, [&](std::int64_t z) {
                const std::span<const Sample> samples(ring.plane(z), plane);
                ranges.local().add(samples);
                if (!anyFinite.load(std::memory_order_relaxed) &&
                    std::any_of(samples.begin(), samples.end(), [](Sample sample) { return !isMissing(sample); }))
                    anyFinite = true;
            });
            return {};
        };
        ISO_TRY(forEachSlab(job, "reading values", take));
        if (!anyFinite)
            return noSamples();
        Sample low = Range::kGreatest, high = Range::kLowest;
        for (const Range& range : ranges) {
            low = std::min(low, *std::min_element(range.low.begin(), range.low.end()));
            high = std::max(high, *std::max_element(range.high.begin(), range.high.end()));
        }
        bins_ = ValueBins<Sample>(low, high);
        setRange(low, high);
        return {};
    }

    void setRange(Sample low, Sample high) {
        info_.min = static_cast<double>(low) + 0.0;
        info_.max = static_cast<double>(high) + 0.0;
    }

    // What one thread works with.
    struct Worker {
        explicit Worker(const GridDims& dims) : scan(dims) {}
        ChunkScan<Sample> scan;
        ValueCounts<Sample> counts;
        std::vector<index::MissingCells> missingCells;
    };

    using EncodedChunk = std::vector<std::byte>;
    using Row = std::vector<EncodedChunk>;

    Status storeSamples(std::int64_t firstSlab, const JobControl& job) {
        tbb::enumerable_thread_specific<Worker> workers([this] { return Worker(geometry_.dims); });
        const auto store = [&](std::int64_t slab, const PlaneRing<Sample>& ring) -> Status {
            if (slab == 0)
                ISO_TRY(createWriter(ring));
            ISO_TRY(storeSlab(slab, ring, workers));
            if (!checkpoints_.isDue())
                return {};
            collect(workers);
            return makeCheckpoint(slab + 1);
        };
        ISO_TRY(forEachSlab(job, "storing samples", firstSlab, slabCount(), store));
        ISO_TRY(writer_->endChunks());
        collect(workers);
        std::sort(missingCells_.begin(), missingCells_.end(),
                  [](const index::MissingCells& a, const index::MissingCells& b) { return a.brick < b.brick; });
        ValueCounts<Sample>& counts = counts_;
        if constexpr (ValueCounts<Sample>::kByKey) {
            Key least = 0, greatest = 0;
            if (!counts.range(least, greatest))
                return noSamples();
            bins_ = ValueBins<Sample>(sampleOfKey<Sample>(least), sampleOfKey<Sample>(greatest));
            setRange(sampleOfKey<Sample>(least), sampleOfKey<Sample>(greatest));
            info_.distinctValues = counts.distinct();
        }
        counts.fill(info_, bins_);
        info_.nanCount = static_cast<std::uint64_t>(pointCount(geometry_.dims)) - counts.samples();
        return {};
    }

    void collect(tbb::enumerable_thread_specific<Worker>& workers) {
        for (Worker& worker : workers) {
            counts_.merge(worker.counts);
            worker.counts = {};
            missingCells_.insert(missingCells_.end(), worker.missingCells.begin(), worker.missingCells.end());
            worker.missingCells.clear();
        }
    }

    Status storeSlab(std::int64_t slab, const PlaneRing<Sample>& ring,
                     tbb::enumerable_thread_specific<Worker>& workers) {
        const GridDims& sides = chunks_.chunks();
        std::int64_t nextRow = 0;
        Status written;
        const auto planeAt = [&ring](std::int64_t z) { return ring.plane(z); };
        std::atomic<bool> hasFailed = false; // `written` is the last filter's
        tbb::parallel_pipeline(
            rowsInFlight(),
            tbb::make_filter<void, std::int64_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
                if (nextRow == sides[1] || hasFailed || job_.isStopRequested())
                    control.stop();
                return nextRow++;
            }) & tbb::make_filter<std::int64_t, Row>(tbb::filter_mode::parallel, [&](std::int64_t cy) {
                Row row(static_cast<std::size_t>(sides[0]));
                Worker& worker = workers.local();
                for (std::int64_t cx = 0; cx < sides[0]; ++cx)
                    row[static_cast<std::size_t>(cx)] = encode(chunks_.chunkAt(cx, cy, slab), planeAt, worker);
                return row;
            }) & tbb::make_filter<Row, void>(tbb::filter_mode::serial_in_order, [&](const Row& row) {
                for (const EncodedChunk& chunk : row)
                    if (written.isOk())
                        written = writer_->addChunk(chunk);
                hasFailed = !written.isOk();
            }));
        if (job_.isStopRequested())
            return cancelledError();
        return written;
    }

    EncodedChunk encode(index::ChunkIndex chunk, const typename ChunkScan<Sample>::PlaneAt& planeAt, Worker& worker) {
        ChunkScan<Sample>& scan = worker.scan;
        scan.load(chunk, planeAt);
        scan.spans(spans_);
        scan.missingCells(worker.missingCells);
        scan.countValues(bins_, worker.counts);
        const std::span<const Sample> samples = scan.packed();
        if constexpr (!ValueCounts<Sample>::kByKey)
            distinct_.add(samples);
        return index::encodeChunk<Sample>(samples, scan.extent());
    }

    auto countingSamples() {
        return [this](std::int64_t slab, const PlaneRing<Sample>& ring) -> Status {
            const std::int64_t begin = slab * ring.kThickness,
                               end = std::min(geometry_.dims[2], begin + ring.kThickness);
            const auto row = static_cast<std::size_t>(geometry_.dims[0]);
            tbb::parallel_for(begin, end, [&](std::int64_t z) {
                for (std::int64_t y = 0; y < geometry_.dims[1]; ++y)
                    distinct_.add(std::span(ring.plane(z) + row * static_cast<std::size_t>(y), row));
            });
            return {};
        };
    }

    // What did not fit into memory is counted in further passes.
    Status countDistinct(const JobControl& job) {
        if constexpr (!ValueCounts<Sample>::kByKey) {
            while (!distinct_.endPass())
                ISO_TRY(forEachSlab(job, "counting values", countingSamples()));
            info_.distinctValues = distinct_.count();
        }
        return {};
    }

    // The seed of the checksums depends on the volume's frame and first slab and on the parameters: same input, same
    // bytes.
    Status createWriter(const PlaneRing<Sample>& ring) {
        XXH3_state_t* state = XXH3_createState();
        XXH3_64bits_reset(state);
        XXH3_64bits_update(state, geometry_.dims.data(), sizeof geometry_.dims);
        XXH3_64bits_update(state, &geometry_.spacing, sizeof geometry_.spacing);
        const ScalarType type = source_.info().type;
        XXH3_64bits_update(state, &type, sizeof type);
        XXH3_64bits_update(state, options_.sourceName.data(), options_.sourceName.size());
        const std::int64_t planes = std::min(geometry_.dims[2], ring.kThickness);
        XXH3_64bits_update(state, ring.plane(0),
                           static_cast<std::size_t>(geometry_.dims[0] * geometry_.dims[1] * planes) * sizeof(Sample));
        XXH3_64bits_update(state, &options_.skipLevels, sizeof options_.skipLevels);
        XXH3_64bits_update(state, &options_.redundancyThreshold, sizeof options_.redundancyThreshold);
        const std::uint64_t seed = XXH3_64bits_digest(state);
        XXH3_freeState(state);
        auto writer = index::IndexWriter::create(path_, seed, fileSystemOf(options_));
        if (!writer.isOk())
            return std::move(writer).error();
        writer_ = std::move(writer).value();
        checkpoints_.own(false);
        return {};
    }

    index::IndexMeta makeMeta() {
        info_.kind = index::IndexKind::Metacells;
        info_.geometry = geometry_;
        info_.type = source_.info().type;
        info_.sourceName = options_.sourceName;
        info_.lengthUnit = source_.info().lengthUnit;
        info_.isPatientSpace = source_.info().isPatientSpace;
        if (const auto& resampled = source_.info().resampling)
            info_.resampling = io::lossText(*resampled, source_.info().geometry.dims);
        index::IndexMeta meta;
        meta.info = std::move(info_);
        meta.missingCells = std::move(missingCells_);
        return meta;
    }

    io::VolumeSource& source_;
    GridGeometry geometry_;
    BrickGrid bricks_;
    index::ChunkGrid chunks_;
    const std::filesystem::path& path_;
    const BuildOptions& options_;
    const JobControl& job_;
    bool readsAhead_;
    index::IndexInfo info_;
    ValueBins<Sample> bins_;
    ValueCounts<Sample> counts_;
    BrickSpans<Key> spans_;
    DistinctKeys<Sample> distinct_;
    std::vector<index::MissingCells> missingCells_;
    bool isResumed_ = false;
    DiskForecast forecast_;
    std::unique_ptr<index::IndexWriter> writer_;
    BuildCheckpoints checkpoints_; ///< gone before the writer, whose partial file is locked
};

} // namespace

Status buildMetacells(io::VolumeSource& source, const std::filesystem::path& indexPath, const BuildOptions& options,
                      const JobControl& job, BuildReport& report) {
    return visitScalarType(source.info().type, [&](auto sample) -> Status {
        MetacellBuild<decltype(sample)> build(source, indexPath, options, job);
        auto info = build.run();
        if (!info.isOk())
            return std::move(info).error();
        report.info = std::move(info).value();
        report.isResumed = build.isResumed();
        report.forecast = build.forecast();
        return {};
    });
}

} // namespace isoslider::preprocess
