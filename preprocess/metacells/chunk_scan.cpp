#include "preprocess/metacells/chunk_scan.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/grid/classification.h"
#include "core/grid/edge_cells.h"
#include "preprocess/missing_cells.h"

namespace isoslider::preprocess {
namespace {

constexpr int kChunk = index::kChunkSide;

template <class Sample>
using SameWidth =
    std::conditional_t<sizeof(Sample) == 1, std::int8_t,
                       std::conditional_t<sizeof(Sample) == 2, std::int16_t,
                                          std::conditional_t<sizeof(Sample) == 4, std::int32_t, std::int64_t>>>;

// Greater neighbours minus smaller ones of 16 samples in a row. Missing ones are neither.
template <class Sample>
void changesOfRow(const Sample* row, std::ptrdiff_t toRow, std::ptrdiff_t toPlane,
                  std::array<SameWidth<Sample>, kChunk>& out) {
    using Int = SameWidth<Sample>;
    for (int x = 0; x < kChunk; ++x) {
        const Sample here = row[x];
        Int change = 0;
        for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, toRow, toPlane}) {
            const Sample before = row[x - step], after = row[x + step];
            change = static_cast<Int>(change + Int(before > here) - Int(before < here) + Int(after > here) -
                                      Int(after < here));
        }
        out[static_cast<std::size_t>(x)] = change;
    }
}

} // namespace

template <class Sample>
void ValueCounts<Sample>::merge(const ValueCounts& other) {
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        counts_[i].samples += other.counts_[i].samples;
        counts_[i].change += other.counts_[i].change;
    }
}

template <class Sample>
bool ValueCounts<Sample>::range(Key& least, Key& greatest) const {
    const auto hasSamples = [](const Count& count) { return count.samples > 0; };
    const auto first = std::find_if(counts_.begin(), counts_.end(), hasSamples);
    if (first == counts_.end())
        return false;
    const auto last = std::find_if(counts_.rbegin(), counts_.rend(), hasSamples);
    least = static_cast<Key>(first - counts_.begin());
    greatest = static_cast<Key>(counts_.rend() - last - 1);
    return true;
}

template <class Sample>
std::uint64_t ValueCounts<Sample>::distinct() const {
    return static_cast<std::uint64_t>(
        std::count_if(counts_.begin(), counts_.end(), [](const Count& count) { return count.samples > 0; }));
}

template <class Sample>
std::uint64_t ValueCounts<Sample>::samples() const {
    std::uint64_t sum = 0;
    for (const Count& count : counts_)
        sum += count.samples;
    return sum;
}

template <class Sample>
void ValueCounts<Sample>::fill(index::IndexInfo& info, const ValueBins<Sample>& bins) const {
    constexpr std::size_t kBins = ValueBins<Sample>::kCount;
    std::array<Count, kBins> byBin{};
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        std::size_t bin = i, curveBin = i;
        if constexpr (kByKey) {
            if (counts_[i].samples == 0)
                continue;
            bin = bins.binOf(sampleOfKey<Sample>(static_cast<Key>(i)));
            curveBin = bins.curveBinOf(sampleOfKey<Sample>(static_cast<Key>(i)), bin);
        }
        byBin[bin].samples += counts_[i].samples;
        byBin[curveBin].change += counts_[i].change;
    }
    info.histogram.min = info.min;
    info.histogram.max = info.max;
    info.histogram.counts.assign(kBins, 0);
    info.activeEdgesPerBin.assign(kBins, 0);
    std::int64_t active = 0;
    for (std::size_t b = 0; b < kBins; ++b) {
        info.histogram.counts[b] = byBin[b].samples;
        info.activeEdgesPerBin[b] = static_cast<std::uint64_t>(active);
        active += byBin[b].change;
    }
}

template <class Sample>
void ChunkScan<Sample>::load(index::ChunkIndex chunk, const PlaneAt& planeAt) {
    const auto c = chunks_.chunkCoords(chunk);
    extent_ = chunks_.extent(chunk);
    for (std::size_t a = 0; a < 3; ++a)
        origin_[a] = c[a] * kChunk;
    // Along x from `begin` to `end` of the block's row the samples are there.
    const int begin = origin_[0] > 0 ? 0 : 1;
    const int end = static_cast<int>(std::min<std::int64_t>(kSide, dims_[0] - origin_[0] + 1));
    Sample* row = block_.data();
    for (int z = -1; z <= kChunk; ++z) {
        const Sample* plane = planeAt(std::clamp<std::int64_t>(origin_[2] + z, 0, dims_[2] - 1));
        for (int y = -1; y <= kChunk; ++y, row += kSide) {
            const Sample* from =
                plane + dims_[0] * std::clamp<std::int64_t>(origin_[1] + y, 0, dims_[1] - 1) + origin_[0] - 1;
            if (begin == 0 && end == kSide) {
                std::memcpy(row, from, kSide * sizeof(Sample));
                continue;
            }
            std::memcpy(row + begin, from + begin, static_cast<std::size_t>(end - begin) * sizeof(Sample));
            std::fill(row, row + begin, row[begin]);
            std::fill(row + end, row + kSide, row[end - 1]);
        }
    }
    hasMissing_ = false;
    if constexpr (std::is_floating_point_v<Sample>) {
        using Bits = std::make_unsigned_t<SameWidth<Sample>>;
        constexpr Bits kExponent = std::bit_cast<Bits>(std::numeric_limits<Sample>::infinity());
        Bits any = 0; // NaN and infinities have all bits of the exponent set
        for (const Sample sample : block_)
            any |= static_cast<Bits>((std::bit_cast<Bits>(sample) & kExponent) == kExponent);
        hasMissing_ = any != 0;
    }
}

template <class Sample>
std::span<const Sample> ChunkScan<Sample>::packed() {
    Sample* out = packed_.data();
    const bool isWide = extent_[0] == kChunk;
    for (int z = 0; z < extent_[2]; ++z)
        for (int y = 0; y < extent_[1]; ++y, out += extent_[0])
            std::memcpy(out, at(0, y, z),
                        (isWide ? std::size_t{kChunk} : static_cast<std::size_t>(extent_[0])) * sizeof(Sample));
    return {packed_.data(), static_cast<std::size_t>(out - packed_.data())};
}

template <class Sample>
template <class Visit>
void ChunkScan<Sample>::forEachBrick(const Visit& visit) const {
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i)
                if (i * kBrickSide < extent_[0] && j * kBrickSide < extent_[1] && k * kBrickSide < extent_[2])
                    visit(bricks_.brickAt(origin_[0] / kBrickSide + i, origin_[1] / kBrickSide + j,
                                          origin_[2] / kBrickSide + k),
                          i * kBrickSide, j * kBrickSide, k * kBrickSide);
}

template <class Sample>
void ChunkScan<Sample>::spans(BrickSpans<KeyOf<Sample>>& spans) const {
    using Key = KeyOf<Sample>;
    forEachBrick([&](BrickIndex brick, int x0, int y0, int z0) {
        // Lane by lane, so that rows are compared in whole vectors; repeated samples change nothing.
        std::array<Sample, kBrickSide + 1> least, greatest;
        least.fill(std::numeric_limits<Sample>::max());
        greatest.fill(std::numeric_limits<Sample>::lowest());
        bool isEmpty = hasMissing_;
        for (int z = z0; z <= z0 + kBrickSide; ++z)
            for (int y = y0; y <= y0 + kBrickSide; ++y) {
                const Sample* row = at(x0, y, z);
                if (hasMissing_) {
                    for (std::size_t x = 0; x < least.size(); ++x) {
                        if (isMissing(row[x]))
                            continue;
                        isEmpty = false;
                        least[x] = std::min(least[x], row[x]);
                        greatest[x] = std::max(greatest[x], row[x]);
                    }
                    continue;
                }
                for (std::size_t x = 0; x < least.size(); ++x) {
                    least[x] = row[x] < least[x] ? row[x] : least[x];
                    greatest[x] = row[x] > greatest[x] ? row[x] : greatest[x];
                }
            }
        spans.least[brick.index()] =
            isEmpty ? std::numeric_limits<Key>::max() : keyOf(*std::min_element(least.begin(), least.end()));
        spans.greatest[brick.index()] = isEmpty ? Key(0) : keyOf(*std::max_element(greatest.begin(), greatest.end()));
    });
}

template <class Sample>
bool ChunkScan<Sample>::isCellValid(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::array<std::int64_t, 3> cell{x, y, z};
    for (std::size_t a = 0; a < 3; ++a)
        if (origin_[a] + cell[a] < 0 || origin_[a] + cell[a] + 1 >= dims_[a])
            return false;
    for (int c = 0; c < 8; ++c)
        if (isMissing(
                *at(static_cast<int>(x) + (c & 1), static_cast<int>(y) + (c >> 1 & 1), static_cast<int>(z) + (c >> 2))))
            return false;
    return true;
}

template <class Sample>
void ChunkScan<Sample>::missingCells(std::vector<index::MissingCells>& cells) const {
    if (!hasMissing_)
        return;
    forEachBrick([&](BrickIndex brick, int, int, int) {
        index::MissingCells missing;
        const auto isWhole = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
            return isCellValid(x - origin_[0], y - origin_[1], z - origin_[2]);
        };
        if (findMissingCells(bricks_, brick, isWhole, missing))
            cells.push_back(missing);
    });
}

// As changesOfRow, of edges that have a valid cell only.
template <class Sample>
std::int64_t ChunkScan<Sample>::changeAt(int x, int y, int z) const {
    const Sample here = *at(x, y, z);
    std::int64_t change = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
            const std::array<int, 3> n{x + (axis == 0) * step, y + (axis == 1) * step, z + (axis == 2) * step};
            const Sample there = *at(n[0], n[1], n[2]);
            const int start = step < 0 ? step : 0;
            const auto isWhole = [&](std::int64_t cx, std::int64_t cy, std::int64_t cz) {
                return isCellValid(cx, cy, cz);
            };
            if (!isMissing(there) && hasValidCell<std::int64_t>(x + (axis == 0) * start, y + (axis == 1) * start,
                                                                z + (axis == 2) * start, axis, isWhole))
                change += (there > here) - (there < here);
        }
    return change;
}

template <class Sample>
void ChunkScan<Sample>::countValues(const ValueBins<Sample>& bins, ValueCounts<Sample>& counts) const {
    const bool isThin = std::min({dims_[0], dims_[1], dims_[2]}) < 2; // no cells, so no edges
    std::array<SameWidth<Sample>, kChunk> changes{};
    for (int z = 0; z < extent_[2]; ++z)
        for (int y = 0; y < extent_[1]; ++y) {
            const Sample* row = at(0, y, z);
            if (hasMissing_ || isThin) {
                for (int x = 0; x < extent_[0]; ++x)
                    if (!isMissing(row[x]))
                        counts.add(row[x], isThin ? 0 : changeAt(x, y, z), bins);
                continue;
            }
            changesOfRow<Sample>(row, kSide, kSide * kSide, changes);
            if (extent_[0] == kChunk)
                counts.addRow(row, changes, bins);
            else
                for (int x = 0; x < extent_[0]; ++x)
                    counts.add(row[x], changes[static_cast<std::size_t>(x)], bins);
        }
}

#define ISO_INSTANTIATE(Sample, Name) \
    template class ValueCounts<Sample>; \
    template class ChunkScan<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
