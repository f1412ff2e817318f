#include "preprocess/edges/block_choice.h"

#include <algorithm>
#include <bit>
#include <span>

#include "core/index/format/block_codec.h"
#include "preprocess/build_index.h"
#include "preprocess/levels/level_builder.h"

namespace isoslider::preprocess {

// Of the field, not of the type it is stored in: keys stand for their ranks, so that one field gets the same levels
// in every scalar type. Where nearly all sampled values differ, ranks lie as far apart as in the whole volume.
template <class Key>
double bytesPerEntry(std::vector<index::PointRecord<Key>> sample, const BrickGrid& grid) {
    using Record = index::PointRecord<Key>;
    std::sort(sample.begin(), sample.end(),
              [](const Record& a, const Record& b) { return a.key != b.key ? a.key < b.key : a.id() < b.id(); });
    std::vector<Key> keys;
    for (const Record& record : sample) {
        keys.push_back(record.key);
        forEachEdge(record, [&](int e) { keys.push_back(record.farKeys[e]); });
    }
    const double values = static_cast<double>(keys.size());
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    const bool isSaturated = 2.0 * static_cast<double>(keys.size()) <= values;
    const double apart = isSaturated ? 1.0 : std::max(1.0, static_cast<double>(pointCount(grid.dims())) / values);
    const auto rankOf = [&](Key key) {
        const auto rank = static_cast<double>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
        return static_cast<std::uint32_t>(std::min(rank * apart, 4294967295.0));
    };
    double bytes = 0.0, entries = 0.0;
    std::vector<index::PointRecord<std::uint32_t>> ranked;
    for (std::size_t first = 0; first < sample.size(); first += kValuePagePoints) {
        ranked.clear();
        for (const Record& record :
             std::span<const Record>(sample).subspan(first, std::min(kValuePagePoints, sample.size() - first))) {
            index::PointRecord<std::uint32_t>& out = ranked.emplace_back();
            out.key = rankOf(record.key);
            out.setId(record.id());
            out.edgeMask = record.edgeMask;
            out.form = record.form;
            forEachEdge(record, [&](int e) { out.farKeys[e] = rankOf(record.farKeys[e]); });
            // As the histogram over span space counts them: an interval once for each end.
            entries += record.form == index::record_form::kPoint ? std::popcount(record.edgeMask) : 1;
        }
        bytes += static_cast<double>(
            index::encodePage<std::uint32_t>(ranked, index::PageOrder::Value, index::FarEnds::Directions, grid).size());
    }
    return entries > 0.0 ? bytes / entries : 0.0;
}

BlockChoice chooseBlocks(const SpanHistogram& histogram, const KeyIntervals& bins, int skipLevels,
                         double redundancyThreshold, double bytesPerEntry, double points) {
    constexpr double kHigherLevelCost = 1.4;
    constexpr double kSampleBytes = 2.0; // encoded, about
    if (redundancyThreshold > 0.0)
        return {chooseBlockBegins(histogram, bins, skipLevels, redundancyThreshold), redundancyThreshold};
    std::uint64_t entries = 0;
    for (std::size_t lower = 0; lower < bins.count(); ++lower)
        for (std::size_t upper = lower; upper < bins.count(); ++upper)
            entries += 2 * std::uint64_t{histogram.at(lower, upper)};
    BlockChoice choice;
    for (const double threshold : kRedundancyChoices) {
        choice = {chooseBlockBegins(histogram, bins, skipLevels, threshold), threshold};
        const double above = static_cast<double>(countEntriesAbove(histogram, bins, choice.begins));
        const double bytes = bytesPerEntry * (static_cast<double>(entries) + kHigherLevelCost * above);
        if (bytes <= (kBytesPerVoxelAim - kSampleBytes) * points)
            break;
    }
    return choice;
}

template double bytesPerEntry(std::vector<index::PointRecord<std::uint16_t>>, const BrickGrid&);
template double bytesPerEntry(std::vector<index::PointRecord<std::uint32_t>>, const BrickGrid&);
template double bytesPerEntry(std::vector<index::PointRecord<std::uint64_t>>, const BrickGrid&);

} // namespace isoslider::preprocess
