#include "preprocess/index_builds.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>

#include <tbb/task_arena.h>
#include <xxhash.h>

#include "core/grid/classification.h"
#include "core/index/index_writer.h"
#include "preprocess/edges/block_choice.h"
#include "preprocess/edges/edge_forecast.h"
#include "preprocess/edges/record_generator.h"
#include "preprocess/edges/sample_chunks.h"
#include "preprocess/forecast/topology_bytes.h"
#include "preprocess/levels/external_sort.h"
#include "preprocess/levels/level_builder.h"
#include "preprocess/resume/build_checkpoints.h"
#include "preprocess/value_bins.h"

namespace isoslider::preprocess {
namespace {

// Three passes over the volume. 1: counts by key (partitions, span bins, range). 2: samples, written as they come.
// 3: records, generated brick by brick, distributed by value. Then partitions are sorted one after the other, cut into
// blocks, encoded.
//
// Memory: the window of planes and what a layer makes of them, the records of kBricksAtOnce bricks, histograms over
// span space, and the sort, which gets what is left. A budget that has no room for the least of these is refused.

// Number of distinct finite values, counted along the sorted stream.
class DistinctCounter {
public:
    void setKeysWithoutEdges(std::vector<std::uint64_t> keys) {
        std::sort(keys.begin(), keys.end());
        keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        withoutEdges_ = std::move(keys);
        count_ = withoutEdges_.size();
    }
    void add(std::uint64_t key) {
        if (hasKey_ && key == lastKey_)
            return;
        hasKey_ = true;
        lastKey_ = key;
        while (next_ < withoutEdges_.size() && withoutEdges_[next_] < key)
            ++next_;
        const bool isCounted = next_ < withoutEdges_.size() && withoutEdges_[next_] == key;
        count_ += !isCounted;
    }
    std::uint64_t count() const { return count_; }
    void state(StateArchive& archive) {
        archive(withoutEdges_);
        archive(next_);
        archive(hasKey_);
        archive(lastKey_);
        archive(count_);
    }

private:
    std::vector<std::uint64_t> withoutEdges_;
    std::size_t next_ = 0;
    bool hasKey_ = false;
    std::uint64_t lastKey_ = 0;
    std::uint64_t count_ = 0;
};

template <class Sample>
class EdgeBuild {
public:
    using Key = KeyOf<Sample>;
    using Record = index::PointRecord<Key>;

    EdgeBuild(io::VolumeSource& source, const std::filesystem::path& path, const BuildOptions& options,
              const JobControl& job)
        : source_(source),
          geometry_(source.info().geometry),
          grid_(geometry_.dims),
          path_(path),
          options_(options),
          job_(job),
          redundancyThreshold_(options.redundancyThreshold),
          checkpoints_(path, BuildIdentity::of(source, options), options) {}

    Result<index::IndexInfo> run() {
        if (leastMemory() > options_.memoryBytes)
            return makeError(ErrorCode::InvalidArgument,
                             "memory budget is too small for planes of this size: give at least " +
                                 std::to_string((leastMemory() >> 20) + 1) + "M",
                             options_.sourceName);
        auto left = checkpoints_.load();
        if (!left.isOk())
            return std::move(left).error();
        if (left.value())
            return resume(*left.value());
        KeyCounter<Key> counter(static_cast<std::uint64_t>(pointCount(geometry_.dims)));
        ISO_TRY(countSamples(counter));
        std::vector<KeyCount> counts = counter.takeCounts();
        ISO_TRY(makeForecast(counts));
        ISO_TRY(checkRoom({}));
        auto writer = index::IndexWriter::create(path_, seed(), fileSystemOf(options_));
        if (!writer.isOk())
            return std::move(writer).error();
        writer_ = std::move(writer).value();
        checkpoints_.own(false);
        bins_.emplace(makeSpanBins(counts));
        sort_ = std::make_unique<ExternalSort<Key>>(counts, sortMemory(), spillPathOf(path_, options_),
                                                    fileSystemOf(options_));
        std::vector<KeyCount>().swap(counts);
        beginHistogram();
        makeHistograms();
        return storeSamples(0);
    }

    bool isResumed() const { return isResumed_; }
    const DiskForecast& forecast() const { return forecast_; }

private:
    enum class Phase : std::uint8_t { Samples, Collecting, Sorting };

    Status makeForecast(const std::vector<KeyCount>& counts) {
        const auto forecast = forecastEdges<Sample>(source_, {counts, unequalPairs_, info_.min, info_.max}, options_,
                                                    sortMemory(), path_, job_.part(0.08, 0.1));
        if (!forecast.isOk())
            return forecast.error();
        forecast_ = forecast.value().disk;
        if (options_.withTopology)
            ISO_TRY(addTopology(source_, job_, forecast_));
        bytesPerEntry_ = forecast.value().bytesPerEntry;
        return {};
    }
    Status checkRoom(const DiskForecast& there) const {
        return preprocess::checkRoom(forecast_.less(there), path_, spillPathOf(path_, options_),
                                     fileSystemOf(options_));
    }

    Result<index::IndexInfo> storeSamples(std::int64_t firstSlab) {
        ISO_TRY(writeSamples<Sample>(source_, *writer_, firstSlab, job_.part(0.1, 0.18), [this](std::int64_t next) {
            return checkpoints_.isDue() ? makeCheckpoint(Phase::Samples, next, {}) : Status();
        }));
        return collectAndSort(0);
    }

    Result<index::IndexInfo> collectAndSort(std::int64_t firstLayer) {
        ISO_TRY(generateRecords(firstLayer));
        blockBegins_ = chooseBlocks(std::move(histograms_));
        levels_.emplace(*writer_, grid_, index::FarEnds::Directions, blockBegins_);
        return sortAndFinish({});
    }

    Result<index::IndexInfo> sortAndFinish(typename ExternalSort<Key>::Place begin) {
        ISO_TRY(sort_->drain([&](std::span<const Record> records) { return consume(records, *levels_); },
                             job_.part(0.42, 1.0), begin,
                             [&](const typename ExternalSort<Key>::Place& place) {
                                 return checkpoints_.isDue() ? makeCheckpoint(Phase::Sorting, 0, place) : Status();
                             }));
        ISO_TRY(levels_->finish());
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(source_.checkUnchanged());
        auto info = writer_->finish(makeMeta(levels_->levelInfos()));
        if (info.isOk()) {
            checkpoints_.finish();
            sort_->removeRuns();
        }
        return info;
    }

    // ---- going on after a stop (RESUME.md)

    // `next`: the slab of chunks or the layer to go on with.
    Status makeCheckpoint(Phase phase, std::int64_t next, typename ExternalSort<Key>::Place place) {
        const auto begin = std::chrono::steady_clock::now();
        StateArchive archive;
        archive(phase);
        ISO_TRY(writer_->suspend(archive));
        ISO_TRY(sort_->suspend(archive));
        state(phase, next, place, archive);
        ISO_TRY(checkpoints_.save(archive.bytes(), writer_->sizeBytes(), begin));
        if (options_.resumes) { // from now on there is something to go on with
            writer_->keepUnfinished();
            sort_->keepUnfinished();
        }
        return {};
    }

    Result<index::IndexInfo> resume(const std::vector<std::byte>& left) {
        StateArchive archive(left);
        Phase phase{};
        archive(phase);
        auto writer = index::IndexWriter::resume(path_, archive, fileSystemOf(options_));
        if (!writer.isOk())
            return std::move(writer).error();
        writer_ = std::move(writer).value();
        checkpoints_.own(true);
        auto sort =
            ExternalSort<Key>::resume(archive, sortMemory(), spillPathOf(path_, options_), fileSystemOf(options_));
        if (!sort.isOk())
            return std::move(sort).error();
        sort_ = std::move(sort).value();
        isResumed_ = true;
        std::int64_t next = 0;
        typename ExternalSort<Key>::Place place;
        state(phase, next, place, archive);
        if (archive.hasFailed() || archive.remaining() != 0)
            return makeError(ErrorCode::Corruption, "the state of an unfinished build is damaged", path_.string());
        ISO_TRY(checkRoom({writer_->sizeBytes(), sort_->spilledBytes() + left.size()}));
        valueBins_ = ValueBins<Sample>(static_cast<Sample>(info_.min), static_cast<Sample>(info_.max));
        return phase == Phase::Samples      ? storeSamples(next)
               : phase == Phase::Collecting ? collectAndSort(next)
                                            : sortAndFinish(place);
    }

    void state(Phase phase, std::int64_t& next, typename ExternalSort<Key>::Place& place, StateArchive& archive) {
        for (double* value :
             {&info_.min, &info_.max, &info_.histogram.min, &info_.histogram.max, &redundancyThreshold_})
            archive(*value);
        archive(info_.nanCount);
        archive(forecast_);
        archive(info_.histogram.counts);
        archive(info_.activeEdgesPerBin);
        archive(missingCells_);
        archive(withoutEdges_);
        archive(next);
        archive(place);
        if (phase == Phase::Sorting)
            stateOfSorting(archive);
        else
            stateOfCollecting(archive);
    }

    void stateOfCollecting(StateArchive& archive) {
        std::vector<std::uint64_t> begins;
        for (std::size_t i = 0; bins_ && i < bins_->count(); ++i)
            begins.push_back(bins_->begin(i));
        archive(begins);
        if (archive.isLoading()) {
            if (begins.empty())
                return; // it has failed
            bins_.emplace(std::move(begins));
            makeHistograms();
        }
        for (std::size_t i = 1; i < histograms_.size() && !archive.isLoading(); ++i) {
            histograms_[0].merge(histograms_[i]);
            histograms_[i] = SpanHistogram(bins_->count());
        }
        histograms_[0].state(archive);
        archive(bytesPerEntry_);
    }

    void stateOfSorting(StateArchive& archive) {
        std::size_t levels = blockBegins_.size();
        archive(levels);
        if (archive.isLoading())
            blockBegins_.resize(levels < index::kMaxSkipLevels ? levels : 0);
        for (auto& begins : blockBegins_)
            archive(begins);
        if (archive.isLoading())
            levels_.emplace(*writer_, grid_, index::FarEnds::Directions, blockBegins_);
        levels_->state(archive);
        distinct_.state(archive);
        archive(nextBin_);
        archive(activeEdges_);
    }

    // ---- the passes

    std::int64_t layerCount() const { return grid_.bricks()[2]; }

    Status countSamples(KeyCounter<Key>& counter) {
        const JobControl share = job_.part(0.0, 0.08);
        countsByPrefix_.assign(std::size_t{1} << 16, 0);
        SlabWindow<Sample> window(source_, kBrickSide + 1);
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        std::uint64_t finite = 0;
        for (std::int64_t layer = 0; layer < layerCount(); ++layer) {
            if (job_.isStopRequested())
                return cancelledError();
            share.report(static_cast<double>(layer) / static_cast<double>(layerCount()), "reading values");
            const std::int64_t z0 = layer * kBrickSide;
            const std::int64_t z1 = std::min(geometry_.dims[2], z0 + kBrickSide);
            ISO_TRY(window.advance(std::max<std::int64_t>(0, z0 - 1), z1));
            unequalPairs_ += countUnequalPairs(window, geometry_.dims, z0, z1);
            const Sample* samples = window.plane(z0);
            const std::size_t count = static_cast<std::size_t>((z1 - z0) * geometry_.dims[0] * geometry_.dims[1]);
            for (std::size_t i = 0; i < count; ++i) {
                if (isMissing(samples[i]))
                    continue;
                ++finite;
                const Key key = keyOf(samples[i]);
                counter.add(key);
                ++countsByPrefix_[static_cast<std::size_t>(key >> (8 * sizeof(Key) - 16))];
                low = std::min(low, static_cast<double>(samples[i]));
                high = std::max(high, static_cast<double>(samples[i]));
            }
        }
        if (finite == 0)
            return makeError(ErrorCode::InvalidArgument, "the volume has no finite sample", options_.sourceName);
        info_.min = low + 0.0;
        info_.max = high + 0.0;
        info_.nanCount = static_cast<std::uint64_t>(pointCount(geometry_.dims)) - finite;
        return {};
    }

    void makeHistograms() { histograms_.assign(histogramCount(*bins_), SpanHistogram(bins_->count())); }

    Status generateRecords(std::int64_t firstLayer) {
        const JobControl share = job_.part(0.18, 0.42);
        SlabWindow<Sample> window(source_, kLayerPlanes);
        std::optional<MergedLayers<Sample>> merged;
        if (options_.mergeError.amount > 0.0)
            merged.emplace(geometry_.dims, extract::boundOf(options_.mergeError, info_.min, info_.max), job_.stop);
        const auto consume = [&](const LayerRecords<Key>& records) -> Status {
            for (const auto& brick : records.bricks)
                ISO_TRY(sort_->add(brick));
            missingCells_.insert(missingCells_.end(), records.missingCells.begin(), records.missingCells.end());
            withoutEdges_.insert(withoutEdges_.end(), records.keysWithoutEdges.begin(), records.keysWithoutEdges.end());
            return {};
        };
        for (std::int64_t layer = firstLayer; layer < layerCount(); ++layer) {
            if (job_.isStopRequested())
                return cancelledError();
            // Merged cells of two layers depend on each other.
            if (!merged && layer > firstLayer && checkpoints_.isDue())
                ISO_TRY(makeCheckpoint(Phase::Collecting, layer, {}));
            share.report(static_cast<double>(layer) / static_cast<double>(layerCount()), "collecting edges");
            const std::int64_t z0 = std::max<std::int64_t>(0, layer * kBrickSide - kLayerApron);
            const std::int64_t z1 = std::min(geometry_.dims[2], (layer + 1) * kBrickSide + kLayerApron);
            ISO_TRY(window.advance(z0, z1));
            countIntoHistogram(window, layer);
            ISO_TRY(generateLayer<Sample>(window, geometry_, layer, *bins_, histograms_, merged ? &*merged : nullptr,
                                          consume));
        }
        if (info_.min == info_.max)
            withoutEdges_.push_back(keyOf(static_cast<Sample>(info_.min)));
        distinct_.setKeysWithoutEdges(std::move(withoutEdges_));
        return {};
    }

    std::vector<std::vector<std::uint64_t>> chooseBlocks(std::vector<SpanHistogram> histograms) {
        SpanHistogram& histogram = histograms.front();
        for (std::size_t i = 1; i < histograms.size(); ++i)
            histogram.merge(histograms[i]);
        histograms.resize(1, histogram);
        BlockChoice choice = preprocess::chooseBlocks(histogram, *bins_, options_.skipLevels, redundancyThreshold_,
                                                      bytesPerEntry_, static_cast<double>(pointCount(geometry_.dims)));
        redundancyThreshold_ = choice.redundancyThreshold;
        return std::move(choice.begins);
    }

    void beginHistogram() {
        valueBins_ = ValueBins<Sample>(static_cast<Sample>(info_.min), static_cast<Sample>(info_.max));
        info_.histogram.min = info_.min;
        info_.histogram.max = info_.max;
        info_.histogram.counts.assign(ValueBins<Sample>::kCount, 0);
        info_.activeEdgesPerBin.assign(ValueBins<Sample>::kCount, 0);
    }

    void countIntoHistogram(const SlabWindow<Sample>& window, std::int64_t layer) {
        const std::int64_t z0 = layer * kBrickSide;
        const std::int64_t z1 = std::min(geometry_.dims[2], z0 + kBrickSide);
        const Sample* samples = window.plane(z0);
        const std::size_t count = static_cast<std::size_t>((z1 - z0) * geometry_.dims[0] * geometry_.dims[1]);
        for (std::size_t i = 0; i < count; ++i)
            if (!isMissing(samples[i]))
                ++info_.histogram.counts[valueBins_.binOf(samples[i])];
    }

    Status consume(std::span<const Record> records, LevelBuilder<Key>& levels) {
        for (const Record& record : records) {
            while (nextBin_ < ValueBins<Sample>::kCount && record.key >= valueBins_.threshold(nextBin_))
                info_.activeEdgesPerBin[nextBin_++] = static_cast<std::uint64_t>(activeEdges_);
            distinct_.add(record.key);
            if (index::record_form::isEdge(record.form))
                activeEdges_ += record.farKeys[index::record_form::kOtherEnd] > record.key ? 1 : -1;
            for (int e = 0; record.form == index::record_form::kPoint && e < index::kPointEdges; ++e)
                if (record.edgeMask >> e & 1)
                    activeEdges_ += record.farKeys[e] > record.key ? 1 : -1;
        }
        return levels.add(records);
    }

    index::IndexMeta makeMeta(std::vector<index::SkipLevelInfo> levels) {
        info_.geometry = geometry_;
        info_.type = source_.info().type;
        info_.distinctValues = distinct_.count();
        info_.redundancyThreshold = redundancyThreshold_;
        info_.mergeError = options_.mergeError.amount;
        info_.isMergeErrorInCells = options_.mergeError.measure == extract::MergeBound::Measure::Distance;
        info_.sourceName = options_.sourceName;
        info_.lengthUnit = source_.info().lengthUnit;
        info_.isPatientSpace = source_.info().isPatientSpace;
        if (const auto& resampled = source_.info().resampling)
            info_.resampling = io::lossText(*resampled, source_.info().geometry.dims);
        info_.levels = std::move(levels);
        index::IndexMeta meta;
        meta.info = info_;
        meta.missingCells = std::move(missingCells_);
        return meta;
    }

    // What comes off the budget before the sort gets its share, histograms besides.
    std::uint64_t workingMemory() const {
        const auto plane = static_cast<std::uint64_t>(geometry_.dims[0] * geometry_.dims[1]);
        const auto bricks = std::min<std::uint64_t>(kBricksAtOnce, plane / (kBrickSide * kBrickSide) + 1);
        constexpr std::uint64_t kElsewhere = std::uint64_t{8} << 20; // pages of the levels
        return plane * std::max(kLayerPlanes * (sizeof(Sample) + sizeof(Key) + 1), kSlabPlanes * sizeof(Sample)) +
               bricks * kBrickPoints * sizeof(Record) * 3 / 2 * (options_.mergeError.amount > 0.0 ? 4 : 1) +
               leafMemory() + kElsewhere;
    }
    // Two layers of bricks, each with some hundred intervals.
    std::uint64_t leafMemory() const {
        constexpr std::uint64_t kIntervals = 256;
        if (!(options_.mergeError.amount > 0.0))
            return 0;
        return static_cast<std::uint64_t>(2 * grid_.bricks()[0] * grid_.bricks()[1]) *
               (sizeof(LeafIntervals<Key>) + kIntervals * sizeof(KeyInterval<Key>));
    }
    std::uint64_t leastMemory() const {
        constexpr std::uint64_t kLeastForSort = std::uint64_t{8} << 20;
        return (workingMemory() + kLeastForSort) * kHistogramShare / (kHistogramShare - 1);
    }
    std::uint64_t sortMemory() const {
        return (options_.memoryBytes - options_.memoryBytes / kHistogramShare - workingMemory()) * 3 / 4;
    }

    // As many threads collect edges as there are histograms.
    static constexpr std::uint64_t kHistogramShare = 8;
    std::size_t histogramCount(const KeyIntervals& bins) const {
        const std::uint64_t room = options_.memoryBytes / kHistogramShare / SpanHistogram(bins.count()).memoryBytes();
        const auto most = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
        return static_cast<std::size_t>(std::clamp<std::uint64_t>(room, 1, most));
    }

    // Depends on the volume's frame, how often its keys begin with which 16 bits, and the parameters: the same input
    // gives the same bytes.
    std::uint64_t seed() const {
        XXH3_state_t* state = XXH3_createState();
        XXH3_64bits_reset(state);
        XXH3_64bits_update(state, geometry_.dims.data(), sizeof geometry_.dims);
        XXH3_64bits_update(state, countsByPrefix_.data(), countsByPrefix_.size() * sizeof countsByPrefix_[0]);
        XXH3_64bits_update(state, &options_.skipLevels, sizeof options_.skipLevels);
        XXH3_64bits_update(state, &redundancyThreshold_, sizeof redundancyThreshold_);
        if (options_.mergeError.amount > 0.0) {
            XXH3_64bits_update(state, &options_.mergeError.measure, sizeof options_.mergeError.measure);
            XXH3_64bits_update(state, &options_.mergeError.amount, sizeof options_.mergeError.amount);
        }
        const std::uint64_t digest = XXH3_64bits_digest(state);
        XXH3_freeState(state);
        return digest;
    }

    io::VolumeSource& source_;
    GridGeometry geometry_;
    BrickGrid grid_;
    const std::filesystem::path& path_;
    const BuildOptions& options_;
    const JobControl& job_;
    double redundancyThreshold_;
    index::IndexInfo info_;
    std::vector<std::uint64_t> countsByPrefix_;
    std::vector<index::MissingCells> missingCells_;
    double bytesPerEntry_ = 0.0; ///< at level 0, of a sample
    std::uint64_t unequalPairs_ = 0; ///< of neighbours
    DiskForecast forecast_;
    DistinctCounter distinct_;
    ValueBins<Sample> valueBins_;
    std::size_t nextBin_ = 0;
    std::int64_t activeEdges_ = 0;
    bool isResumed_ = false;
    std::vector<std::uint64_t> withoutEdges_; ///< keys of points without a record
    std::optional<KeyIntervals> bins_;
    std::vector<SpanHistogram> histograms_;
    std::vector<std::vector<std::uint64_t>> blockBegins_;
    std::unique_ptr<ExternalSort<Key>> sort_;
    std::unique_ptr<index::IndexWriter> writer_;
    std::optional<LevelBuilder<Key>> levels_;
    BuildCheckpoints checkpoints_; ///< gone before the writer, whose partial file is locked
};

} // namespace

Status buildEdges(io::VolumeSource& source, const std::filesystem::path& indexPath, const BuildOptions& options,
                  const JobControl& job, BuildReport& report) {
    return visitScalarType(source.info().type, [&](auto sample) -> Status {
        EdgeBuild<decltype(sample)> build(source, indexPath, options, job);
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
