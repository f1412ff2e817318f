#include "preprocess/index_builds.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <xxhash.h>

#include "core/grid/classification.h"
#include "core/index/index_writer.h"
#include "preprocess/external_sort.h"
#include "preprocess/hidden_page_builder.h"
#include "preprocess/level_builder.h"
#include "preprocess/record_generator.h"
#include "preprocess/value_bins.h"

namespace isoslider::preprocess {
namespace {

// Three passes. 1: counts by key prefix (partitions, span bins, range). 2: records, generated brick
// by brick, distributed by value; hidden corners, written as they come. 3: partitions sorted one after the
// other, cut into blocks, encoded.

constexpr int kPrefixBits = 16;

// Number of distinct finite values, counted along the sorted stream.
class DistinctCounter {
public:
    void setLonelyKeys(std::vector<std::uint64_t> keys) {
        std::sort(keys.begin(), keys.end());
        keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
        lonely_ = std::move(keys);
        count_ = lonely_.size();
    }
    void add(std::uint64_t key) {
        if (hasKey_ && key == lastKey_)
            return;
        hasKey_ = true;
        lastKey_ = key;
        while (next_ < lonely_.size() && lonely_[next_] < key)
            ++next_;
        const bool isCounted = next_ < lonely_.size() && lonely_[next_] == key;
        count_ += !isCounted;
    }
    std::uint64_t count() const { return count_; }

private:
    std::vector<std::uint64_t> lonely_;
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
    static constexpr int kKeyShift = 8 * sizeof(Key) - kPrefixBits;

    EdgeBuild(io::VolumeSource& source, const std::filesystem::path& path, const BuildOptions& options,
              const JobControl& job)
        : source_(source), geometry_(source.info().geometry), grid_(geometry_.dims), path_(path),
          options_(options), job_(job), redundancyThreshold_(options.redundancyThreshold) {}

    Result<index::IndexInfo> run() {
        ISO_TRY(countSamples());
        auto writer = index::IndexWriter::create(path_, seed(), fileSystemOf(options_));
        if (!writer.isOk())
            return std::move(writer).error();
        const SpanBins bins = makeSpanBins(countsByPrefix_, kKeyShift);
        SpanHistogram histogram(bins.count());
        ExternalSort<Key> sort(countsByPrefix_, kKeyShift, sortMemory(), spillPathOf(path_, options_),
                               fileSystemOf(options_));
        ISO_TRY(generateRecords(bins, histogram, sort, *writer.value()));
        LevelBuilder<Key> levels(*writer.value(), grid_, chooseBlocks(histogram, bins));
        ISO_TRY(sort.drain([&](std::span<const Record> records) { return consume(records, levels); },
                           job_.part(0.4, 1.0)));
        ISO_TRY(levels.finish());
        if (job_.isStopRequested())
            return cancelledError();
        return writer.value()->finish(makeMeta(levels.levelInfos()));
    }

private:
    std::int64_t layerCount() const { return grid_.bricks()[2]; }

    Status countSamples() {
        const JobControl share = job_.part(0.0, 0.1);
        countsByPrefix_.assign(std::size_t{1} << kPrefixBits, 0);
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
                ++countsByPrefix_[static_cast<std::size_t>(keyOf(samples[i]) >> kKeyShift)];
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

    Status generateRecords(const SpanBins& bins, SpanHistogram& histogram, ExternalSort<Key>& sort,
                           index::IndexWriter& writer) {
        const JobControl share = job_.part(0.1, 0.4);
        beginHistogram();
        SlabWindow<Sample> window(source_);
        LayerRecords<Key> layerRecords;
        HiddenPageBuilder hiddenPages(writer, source_.info().type);
        std::vector<std::uint64_t> lonely;
        for (std::int64_t layer = 0; layer < layerCount(); ++layer) {
            if (job_.isStopRequested())
                return cancelledError();
            share.report(static_cast<double>(layer) / static_cast<double>(layerCount()), "collecting edges");
            const std::int64_t z0 = std::max<std::int64_t>(0, layer * kBrickSide - kLayerApron);
            const std::int64_t z1 = std::min(geometry_.dims[2], (layer + 1) * kBrickSide + kLayerApron);
            ISO_TRY(window.advance(z0, z1));
            countIntoHistogram(window, layer);
            generateLayer<Sample>(window, geometry_, layer, bins, histogram, layerRecords);
            sampleRecords(layerRecords, grid_.brickAt(0, 0, layer));
            for (const auto& brick : layerRecords.bricks)
                ISO_TRY(sort.add(brick));
            for (const auto& brick : layerRecords.hiddenCorners)
                ISO_TRY(hiddenPages.addBrick(brick));
            missingCells_.insert(missingCells_.end(), layerRecords.missingCells.begin(),
                                 layerRecords.missingCells.end());
            lonely.insert(lonely.end(), layerRecords.lonelyKeys.begin(), layerRecords.lonelyKeys.end());
        }
        if (info_.min == info_.max)
            lonely.push_back(keyOf(static_cast<Sample>(info_.min)));
        ISO_TRY(hiddenPages.finish());
        distinct_.setLonelyKeys(std::move(lonely));
        return {};
    }

    // One brick in kSampleStride is encoded for a trial: bytes per edge entry at level 0, from which those
    // of the levels above follow roughly (they keep fewer edges per point).
    static constexpr std::size_t kSampleStride = 61;
    static constexpr std::size_t kSampleRecords = 8 * kValuePagePoints;
    static constexpr double kHigherLevelCost = 1.4;

    void sampleRecords(const LayerRecords<Key>& layer, std::int64_t firstBrick) {
        for (std::size_t i = 0; i < layer.bricks.size(); ++i)
            if ((static_cast<std::size_t>(firstBrick) + i) % kSampleStride == 0 && sample_.size() < kSampleRecords)
                sample_.insert(sample_.end(), layer.bricks[i].begin(), layer.bricks[i].end());
    }

    double sampledBytesPerEntry() {
        std::sort(sample_.begin(), sample_.end(), [](const Record& a, const Record& b) {
            return a.key != b.key ? a.key < b.key : a.id() < b.id();
        });
        double bytes = 0.0, entries = 0.0;
        for (std::size_t first = 0; first < sample_.size(); first += kValuePagePoints) {
            const auto page = std::span<const Record>(sample_).subspan(
                first, std::min(kValuePagePoints, sample_.size() - first));
            bytes += static_cast<double>(index::encodePage<Key>(page, index::PageOrder::Value, grid_).size());
            for (const Record& record : page)
                entries += std::popcount(record.edgeMask);
        }
        std::vector<Record>().swap(sample_);
        return entries > 0.0 ? bytes / entries : 0.0;
    }

    std::vector<std::vector<std::uint64_t>> chooseBlocks(const SpanHistogram& histogram, const SpanBins& bins) {
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
            for (int e = 0; e < index::kPointEdges; ++e)
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
        info_.sourceName = options_.sourceName;
        info_.lengthUnit = source_.info().lengthUnit;
        info_.levels = std::move(levels);
        index::IndexMeta meta;
        meta.info = info_;
        meta.missingCells = std::move(missingCells_);
        return meta;
    }

    std::uint64_t sortMemory() const {
        // What the window of planes and the layer's records take comes off the budget first.
        const std::uint64_t plane = static_cast<std::uint64_t>(geometry_.dims[0] * geometry_.dims[1]);
        const std::uint64_t working = plane * (12 * sizeof(Sample) + 10 * (sizeof(Key) + 3) +
                                               8 * sizeof(Record) * 3 / 2 + sizeof(index::HiddenCorner));
        const std::uint64_t usable = options_.memoryBytes - options_.memoryBytes / 8;
        return std::max<std::uint64_t>(usable > working ? usable - working : 0, std::uint64_t{16} << 20);
    }

    // Depends on the volume's frame and the parameters: the same input gives the same bytes.
    std::uint64_t seed() const {
        XXH3_state_t* state = XXH3_createState();
        XXH3_64bits_reset(state);
        XXH3_64bits_update(state, geometry_.dims.data(), sizeof geometry_.dims);
        XXH3_64bits_update(state, countsByPrefix_.data(), countsByPrefix_.size() * sizeof countsByPrefix_[0]);
        XXH3_64bits_update(state, &options_.skipLevels, sizeof options_.skipLevels);
        XXH3_64bits_update(state, &redundancyThreshold_, sizeof redundancyThreshold_);
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
