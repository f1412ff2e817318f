#include "preprocess/edges/record_generator.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include <tbb/parallel_for.h>

#include "preprocess/edges/prepared_layer.h"
#include "preprocess/missing_cells.h"

namespace isoslider::preprocess {
namespace {

using index::kPointEdges;
using index::MissingCells;
using index::PointRecord;

template <class Sample>
class BrickGenerator {
public:
    using Key = KeyOf<Sample>;

    BrickGenerator(const PreparedLayer<Sample>& layer, const BrickGrid& grid, const KeyIntervals& bins,
                   const MergedLayers<Sample>* merged)
        : layer_(layer), grid_(grid), bins_(bins), merged_(merged) {}

    void generate(BrickIndex brick, SpanHistogram& histogram, std::vector<PointRecord<Key>>& records,
                  std::vector<std::uint64_t>& withoutEdges) const {
        const auto b = grid_.brickCoords(brick);
        std::int64_t begin[3], end[3];
        for (int a = 0; a < 3; ++a) {
            begin[a] = b[a] * kBrickSide;
            end[a] = std::min(begin[a] + kBrickSide, grid_.dims()[a]);
        }
        const bool isMerged = merged_ != nullptr && merged_->hasLeavesAround(b);
        PointRecord<Key> record;
        for (std::int64_t z = begin[2]; z < end[2]; ++z)
            for (std::int64_t y = begin[1]; y < end[1]; ++y)
                for (std::int64_t x = begin[0]; x < end[0]; ++x) {
                    const std::size_t i = layer_.at(x, y, z);
                    if (layer_.missing(i))
                        continue;
                    if (fill(record, i, x, y, z, withoutEdges)) {
                        const std::size_t at = records.size();
                        records.push_back(record);
                        if (isMerged)
                            carry({x, y, z}, at, histogram, records);
                        count(records[at], histogram);
                    }
                }
        if (isMerged && !merged_->of(b[0], b[1], b[2]).isEmpty()) {
            addLeaves(b, histogram, records);
            std::stable_sort(records.begin(), records.end(),
                             [](const auto& first, const auto& second) { return first.id() < second.id(); });
        }
    }

    // Bit per cell of the brick with a missing corner; false when there is none.
    bool missingCells(BrickIndex brick, MissingCells& out) const {
        return layer_.hasMissing() && findMissingCells(
                                          grid_, brick, [&](auto... cell) { return layer_.isCellValid(cell...); }, out);
    }

private:
    // Takes the edges of a point whose vertices are not theirs alone, all the time, out of its record, and appends
    // those that start at the point as intervals.
    void carry(const std::array<std::int64_t, 3>& point, std::size_t at, SpanHistogram& histogram,
               std::vector<PointRecord<Key>>& records) const {
        thread_local std::vector<CarriedVertex<Key>> carried;
        for (unsigned mask = records[at].edgeMask; mask != 0; mask &= mask - 1) {
            const int e = std::countr_zero(mask);
            std::array<std::int64_t, 3> start = point;
            start[static_cast<std::size_t>(e >> 1)] -= e & 1 ? 0 : 1;
            const Key own = records[at].key, far = records[at].farKeys[e];
            const KeyInterval<Key> ends{std::min(own, far), std::max(own, far)};
            merged_->carriedBy(start, e >> 1, ends, carried);
            if (carried.size() == 1 && carried.front() == CarriedVertex<Key>{ends, 0})
                continue;
            records[at].edgeMask = static_cast<std::uint8_t>(records[at].edgeMask & ~(1u << e));
            if (e & 1)
                for (const CarriedVertex<Key>& vertex : carried)
                    addCarried(start, e >> 1, vertex, histogram, records);
        }
    }

    void addCarried(const std::array<std::int64_t, 3>& start, int axis, const CarriedVertex<Key>& vertex,
                    SpanHistogram& histogram, std::vector<PointRecord<Key>>& records) const {
        namespace form = index::record_form;
        std::array<std::int64_t, 3> lower = start, upper = start;
        const auto along = static_cast<std::size_t>(axis);
        const std::int64_t side = std::int64_t{1} << vertex.level;
        lower[along] &= ~(side - 1);
        upper[along] = lower[along] + side;
        const std::size_t first = layer_.at(lower[0], lower[1], lower[2]),
                          last = layer_.at(upper[0], upper[1], upper[2]);
        PointRecord<Key> record;
        record.form = form::edge(axis, vertex.level);
        record.farKeys[form::kLowerEnd] = layer_.key(first);
        record.farKeys[form::kUpperEnd] = layer_.key(last);
        addInterval(record, grid_.pointId(start[0], start[1], start[2]), vertex.interval, histogram, records);
    }

    void addLeaves(const std::array<std::int64_t, 3>& brick, SpanHistogram& histogram,
                   std::vector<PointRecord<Key>>& records) const {
        merged_->of(brick[0], brick[1], brick[2])
            .forEach([&](int level, int x, int y, int z, const KeyInterval<Key>& interval) {
                PointRecord<Key> record;
                record.form = index::record_form::leaf(level);
                addInterval(
                    record,
                    grid_.pointId(brick[0] * kBrickSide + x, brick[1] * kBrickSide + y, brick[2] * kBrickSide + z),
                    interval, histogram, records);
            });
    }

    // A record at each end.
    void addInterval(PointRecord<Key>& record, PointId id, const KeyInterval<Key>& interval, SpanHistogram& histogram,
                     std::vector<PointRecord<Key>>& records) const {
        record.setId(id);
        record.edgeMask = index::record_form::maskOf(record.form);
        record.key = interval.after;
        record.farKeys[index::record_form::kOtherEnd] = interval.until;
        records.push_back(record);
        std::swap(record.key, record.farKeys[index::record_form::kOtherEnd]);
        records.push_back(record);
        histogram.add(bins_.find(interval.after), bins_.find(interval.until));
    }

    bool fill(PointRecord<Key>& record, std::size_t i, std::int64_t x, std::int64_t y, std::int64_t z,
              std::vector<std::uint64_t>& withoutEdges) const {
        const std::int64_t p[3] = {x, y, z};
        record.key = layer_.key(i);
        record.edgeMask = 0;
        bool hasUnusable = false;
        for (int e = 0; e < kPointEdges; ++e) {
            const int axis = e >> 1;
            const bool up = e & 1;
            record.farKeys[e] = 0;
            if (up ? p[axis] + 1 >= grid_.dims()[axis] : p[axis] == 0)
                continue;
            const std::size_t far = up ? i + static_cast<std::size_t>(layer_.stride(axis))
                                       : i - static_cast<std::size_t>(layer_.stride(axis));
            if (layer_.missing(far)) {
                hasUnusable = true;
                continue;
            }
            if (layer_.key(far) == record.key)
                continue;
            if ((layer_.hasMissing() || isThin()) && !isUsable(p, axis, up)) {
                hasUnusable = true;
                continue;
            }
            record.edgeMask |= static_cast<std::uint8_t>(1 << e);
            record.farKeys[e] = layer_.key(far);
        }
        if (record.edgeMask == 0) {
            if (hasUnusable)
                withoutEdges.push_back(record.key);
            return false;
        }
        record.setId(grid_.pointId(x, y, z));
        return true;
    }

    bool isThin() const { return grid_.dims()[0] < 2 || grid_.dims()[1] < 2 || grid_.dims()[2] < 2; }

    bool isUsable(const std::int64_t (&p)[3], int axis, bool up) const {
        std::int64_t lower[3] = {p[0], p[1], p[2]};
        lower[axis] -= up ? 0 : 1;
        return layer_.hasValidCell(lower[0], lower[1], lower[2], axis);
    }

    void count(const PointRecord<Key>& record, SpanHistogram& histogram) const {
        const std::size_t bin = bins_.find(record.key);
        for (int e = 0; e < kPointEdges; ++e)
            if ((record.edgeMask >> e & 1) && record.farKeys[e] > record.key)
                histogram.add(bin, bins_.find(record.farKeys[e]));
    }

    const PreparedLayer<Sample>& layer_;
    const BrickGrid& grid_;
    const KeyIntervals& bins_;
    const MergedLayers<Sample>* merged_; ///< null: no cells are merged
};

template <class Sample>
void generateBricks(const BrickGenerator<Sample>& generator, std::size_t count, std::span<SpanHistogram> histograms,
                    LayerRecords<KeyOf<Sample>>& out) {
    std::vector<MissingCells> missing(count);
    std::vector<std::uint8_t> hasMissing(count, 0);
    std::vector<std::vector<std::uint64_t>> withoutEdges(count);
    out.bricks.resize(count);
    std::atomic<std::size_t> next = 0;
    tbb::parallel_for(std::size_t{0}, histograms.size(), [&](std::size_t lane) {
        for (std::size_t i; (i = next++) < count;) {
            out.bricks[i].clear();
            const BrickIndex brick = out.firstBrick + i;
            generator.generate(brick, histograms[lane], out.bricks[i], withoutEdges[i]);
            hasMissing[i] = generator.missingCells(brick, missing[i]);
        }
    });
    out.missingCells.clear();
    out.keysWithoutEdges.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (hasMissing[i])
            out.missingCells.push_back(missing[i]);
        out.keysWithoutEdges.insert(out.keysWithoutEdges.end(), withoutEdges[i].begin(), withoutEdges[i].end());
    }
    std::sort(out.keysWithoutEdges.begin(), out.keysWithoutEdges.end());
    out.keysWithoutEdges.erase(std::unique(out.keysWithoutEdges.begin(), out.keysWithoutEdges.end()),
                               out.keysWithoutEdges.end());
}

} // namespace

template <class Sample>
Status generateLayer(const SlabWindow<Sample>& window, const GridGeometry& geometry, std::int64_t layer,
                     const KeyIntervals& bins, std::span<SpanHistogram> histograms, MergedLayers<Sample>* merged,
                     const ConsumeRecords<KeyOf<Sample>>& consume) {
    const BrickGrid grid(geometry.dims);
    const PreparedLayer<Sample> prepared(window, geometry, layer);
    if (merged != nullptr)
        ISO_TRY(merged->advance(prepared, layer));
    const BrickGenerator<Sample> generator(prepared, grid, bins, merged);
    const auto inLayer = static_cast<std::size_t>(grid.bricks()[0] * grid.bricks()[1]);
    LayerRecords<KeyOf<Sample>> records;
    for (std::size_t begin = 0; begin < inLayer; begin += kBricksAtOnce) {
        records.firstBrick = grid.brickAt(0, 0, layer) + begin;
        generateBricks(generator, std::min(kBricksAtOnce, inLayer - begin), histograms, records);
        ISO_TRY(consume(records));
    }
    return {};
}

#define ISO_INSTANTIATE(Sample, Name) \
    template Status generateLayer<Sample>(const SlabWindow<Sample>&, const GridGeometry&, std::int64_t, \
                                          const KeyIntervals&, std::span<SpanHistogram>, MergedLayers<Sample>*, \
                                          const ConsumeRecords<KeyOf<Sample>>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
