#include "preprocess/index_builds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <optional>

#include <tbb/task_arena.h>
#include <xxhash.h>

#include "core/grid/classification.h"
#include "core/index/index_writer.h"
#include "preprocess/edges/hidden_page_builder.h"
#include "preprocess/edges/record_generator.h"
#include "preprocess/levels/external_sort.h"
#include "preprocess/levels/level_builder.h"
#include "preprocess/value_bins.h"

namespace isoslider::preprocess {
namespace {

// Three passes. 1: counts by key (partitions, span bins, range). 2: records, generated brick
// by brick, distributed by value; hidden corners, written as they come. 3: partitions sorted one after the
// other, cut into blocks, encoded.
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
          redundancyThreshold_(options.redundancyThreshold) {}

    Result<index::IndexInfo> run() {
        if (leastMemory() > options_.memoryBytes)
            return makeError(ErrorCode::InvalidArgument,
                             "memory budget is too small for planes of this size: give at least " +
                                 std::to_string((leastMemory() >> 20) + 1) + "M",
                             options_.sourceName);
        KeyCounter<Key> counter(static_cast<std::uint64_t>(pointCount(geometry_.dims)));
        ISO_TRY(countSamples(counter));
        auto writer = index::IndexWriter::create(path_, seed(), fileSystemOf(options_));
        if (!writer.isOk())
            return std::move(writer).error();
        std::vector<KeyCount> counts = counter.takeCounts();
        const KeyIntervals bins = makeSpanBins(counts);
        ExternalSort<Key> sort(counts, sortMemory(), spillPathOf(path_, options_), fileSystemOf(options_));
        std::vector<KeyCount>().swap(counts);
        std::vector<SpanHistogram> histograms(histogramCount(bins), SpanHistogram(bins.count()));
        ISO_TRY(generateRecords(bins, histograms, sort, *writer.value()));
        LevelBuilder<Key> levels(*writer.value(), grid_, chooseBlocks(std::move(histograms), bins));
        ISO_TRY(
            sort.drain([&](std::span<const Record> records) { return consume(records, levels); }, job_.part(0.4, 1.0)));
        ISO_TRY(levels.finish());
        if (job_.isStopRequested())
            return cancelledError();
        ISO_TRY(source_.checkUnchanged());
        return writer.value()->finish(makeMeta(levels.levelInfos()));
    }

private:
    std::int64_t layerCount() const { return grid_.bricks()[2]; }

    Status countSamples(KeyCounter<Key>& counter) {
        const JobControl share = job_.part(0.0, 0.1);
        countsByPrefix_.assign(std::size_t{1} << 16, 0);
        SlabWindow<Sample> window(source_);
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        std::uint64_t finite = 0;
        for (std::int64_t layer = 0; layer < layerCount(); ++layer) {
            if (job_.isStopRequested())
                return cancelledError();
            share.report(static_cast<double>(layer) / static_cast<double>(layerCount()), "reading values");
            const std::int64_t z0 = layer * kBrickSide;
            const std::int64_t z1 = std::min(geometry_.dims[2], z0 + kBrickSide);
            ISO_TRY(window.advance(z0, z1));
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

    Status generateRecords(const KeyIntervals& bins, std::span<SpanHistogram> histograms, ExternalSort<Key>& sort,
                           index::IndexWriter& writer) {
        const JobControl share = job_.part(0.1, 0.4);
        beginHistogram();
        SlabWindow<Sample> window(source_);
        HiddenPageBuilder hiddenPages(writer, source_.info().type);
        std::vector<std::uint64_t> withoutEdges;
        std::optional<MergedLayers<Sample>> merged;
        if (options_.mergeError.amount > 0.0)
            merged.emplace(geometry_.dims, extract::boundOf(options_.mergeError, info_.min, info_.max), job_.stop);
        const auto consume = [&](const LayerRecords<Key>& records) -> Status {
            sampleRecords(records);
            for (const auto& brick : records.bricks)
                ISO_TRY(sort.add(brick));
            for (const auto& brick : records.hiddenCorners)
                ISO_TRY(hiddenPages.addBrick(brick));
            missingCells_.insert(missingCells_.end(), records.missingCells.begin(), records.missingCells.end());
            withoutEdges.insert(withoutEdges.end(), records.keysWithoutEdges.begin(), records.keysWithoutEdges.end());
            return {};
        };
        for (std::int64_t layer = 0; layer < layerCount(); ++layer) {
            if (job_.isStopRequested())
                return cancelledError();
            share.report(static_cast<double>(layer) / static_cast<double>(layerCount()), "collecting edges");
            const std::int64_t z0 = std::max<std::int64_t>(0, layer * kBrickSide - kLayerApron);
            const std::int64_t z1 = std::min(geometry_.dims[2], (layer + 1) * kBrickSide + kLayerApron);
            ISO_TRY(window.advance(z0, z1));
            countIntoHistogram(window, layer);
            ISO_TRY(generateLayer<Sample>(window, geometry_, layer, bins, histograms, merged ? &*merged : nullptr,
                                          consume));
        }
        if (info_.min == info_.max)
            withoutEdges.push_back(keyOf(static_cast<Sample>(info_.min)));
        ISO_TRY(hiddenPages.finish());
        distinct_.setKeysWithoutEdges(std::move(withoutEdges));
        return {};
    }

    // One brick in kSampleStride is encoded for a trial: bytes per edge entry at level 0, from which those
    // of the levels above follow roughly (they keep fewer edges per point).
    static constexpr std::size_t kSampleStride = 61;
    static constexpr std::size_t kSampleRecords = 8 * kValuePagePoints;
    static constexpr double kHigherLevelCost = 1.4;

    void sampleRecords(const LayerRecords<Key>& records) {
        for (std::size_t i = 0; i < records.bricks.size(); ++i)
            if ((records.firstBrick + i).number() % kSampleStride == 0 && sample_.size() < kSampleRecords)
                std::copy_if(records.bricks[i].begin(), records.bricks[i].end(), std::back_inserter(sample_),
                             [](const Record& record) { return record.edgeMask != 0; });
    }

    // Of the field, not of the type it is stored in: keys stand for their ranks, so that one field gets the same levels
    // in every scalar type. Where nearly all sampled values differ, ranks lie as far apart as in the whole volume.
    double sampledBytesPerEntry() {
        std::sort(sample_.begin(), sample_.end(),
                  [](const Record& a, const Record& b) { return a.key != b.key ? a.key < b.key : a.id() < b.id(); });
        std::vector<Key> keys;
        for (const Record& record : sample_) {
            keys.push_back(record.key);
            forEachEdge(record, [&](int e) { keys.push_back(record.farKeys[e]); });
        }
        const double values = static_cast<double>(keys.size());
        std::sort(keys.begin(), keys.end());
        keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        const bool isSaturated = 2.0 * static_cast<double>(keys.size()) <= values;
        const double apart =
            isSaturated ? 1.0 : std::max(1.0, static_cast<double>(pointCount(geometry_.dims)) / values);
        const auto rankOf = [&](Key key) {
            const auto rank = static_cast<double>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
            return static_cast<std::uint32_t>(std::min(rank * apart, 4294967295.0));
        };
        double bytes = 0.0, entries = 0.0;
        std::vector<index::PointRecord<std::uint32_t>> ranked;
        for (std::size_t first = 0; first < sample_.size(); first += kValuePagePoints) {
            ranked.clear();
            for (const Record& record :
                 std::span<const Record>(sample_).subspan(first, std::min(kValuePagePoints, sample_.size() - first))) {
                index::PointRecord<std::uint32_t>& out = ranked.emplace_back();
                out.key = rankOf(record.key);
                out.setId(record.id());
                out.normal = record.normal;
                out.edgeMask = record.edgeMask;
                out.form = record.form;
                forEachEdge(record, [&](int e) {
                    out.farKeys[e] = rankOf(record.farKeys[e]);
                    out.farNormals[e] = record.farNormals[e];
                });
                // As the histogram over span space counts them: an interval once for each end.
                entries += record.form == index::record_form::kPoint ? std::popcount(record.edgeMask) : 1;
            }
            bytes +=
                static_cast<double>(index::encodePage<std::uint32_t>(ranked, index::PageOrder::Value, grid_).size());
        }
        std::vector<Record>().swap(sample_);
        return entries > 0.0 ? bytes / entries : 0.0;
    }

    template <class Visit>
    static void forEachEdge(const Record& record, const Visit& visit) {
        for (unsigned mask = record.edgeMask; mask != 0; mask &= mask - 1)
            visit(std::countr_zero(mask));
    }

    std::vector<std::vector<std::uint64_t>> chooseBlocks(std::vector<SpanHistogram> histograms,
                                                         const KeyIntervals& bins) {
        SpanHistogram& histogram = histograms.front();
        for (std::size_t i = 1; i < histograms.size(); ++i)
            histogram.merge(histograms[i]);
        histograms.resize(1, histogram);
        if (redundancyThreshold_ > 0.0)
            return chooseBlockBegins(histogram, bins, options_.skipLevels, redundancyThreshold_);
        const double bytesPerEntry = sampledBytesPerEntry();
        std::uint64_t entries = 0;
        for (std::size_t lower = 0; lower < bins.count(); ++lower)
            for (std::size_t upper = lower; upper < bins.count(); ++upper)
                entries += 2 * std::uint64_t{histogram.at(lower, upper)};
        std::vector<std::vector<std::uint64_t>> begins;
        for (const double choice : kRedundancyChoices) {
            redundancyThreshold_ = choice;
            begins = chooseBlockBegins(histogram, bins, options_.skipLevels, choice);
            const double above = static_cast<double>(countEntriesAbove(histogram, bins, begins));
            const double bytes = bytesPerEntry * (static_cast<double>(entries) + kHigherLevelCost * above);
            if (bytes <= kBytesPerVoxelAim * static_cast<double>(pointCount(geometry_.dims)))
                break;
        }
        return begins;
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
        return plane * (12 * sizeof(Sample) + 10 * (sizeof(Key) + sizeof(NormalCode) + 1)) +
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
    std::vector<Record> sample_;
    DistinctCounter distinct_;
    ValueBins<Sample> valueBins_;
    std::size_t nextBin_ = 0;
    std::int64_t activeEdges_ = 0;
};

} // namespace

Result<index::IndexInfo> buildEdges(io::VolumeSource& source, const std::filesystem::path& indexPath,
                                    const BuildOptions& options, const JobControl& job) {
    return visitScalarType(source.info().type, [&](auto sample) {
        return EdgeBuild<decltype(sample)>(source, indexPath, options, job).run();
    });
}

} // namespace isoslider::preprocess
