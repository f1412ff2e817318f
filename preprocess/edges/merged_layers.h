#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/base/job_control.h"
#include "core/extract/live/active_bits.h"
#include "preprocess/edges/leaf_intervals.h"
#include "preprocess/edges/prepared_layer.h"

namespace isoslider::preprocess {

/// An edge of the grid carries a vertex, on a leaf edge of 2^level cells.
template <class Key>
struct CarriedVertex {
    KeyInterval<Key> interval;
    int level = 0;
    friend bool operator==(const CarriedVertex& a, const CarriedVertex& b) {
        return a.interval.after == b.interval.after && a.interval.until == b.interval.until && a.level == b.level;
    }
};

/// The leaves of one layer of bricks and of the layer below it, and what follows of them for edges.
///
/// Of the cells around an active edge the smallest leaf carries its vertex (PAPER 2.2), if the edge lies on an edge of
/// that leaf; in the middle of a leaf's face, or inside one, there is none.
template <class Sample>
class MergedLayers {
public:
    using Key = KeyOf<Sample>;

    MergedLayers(const GridDims& dims, const extract::MergeBound& bound, std::stop_token stop)
        : grid_(dims), bound_(bound), stop_(std::move(stop)) {}

    /// Finds the leaves of a layer's bricks, on all threads; those of the layer before stay. REQUIRES: layers in order.
    /// Errors: Cancelled.
    Status advance(const PreparedLayer<Sample>& layer, std::int64_t number) {
        number_ = number;
        below_.swap(here_);
        here_.resize(static_cast<std::size_t>(grid_.bricks()[0] * grid_.bricks()[1]));
        tbb::enumerable_thread_specific<Block> blocks;
        tbb::parallel_for(std::size_t{0}, here_.size(), [&](std::size_t i) {
            here_[i] = {};
            if (stop_.stop_requested())
                return;
            Block& block = blocks.local();
            if (fill(layer, grid_.brickAt(0, 0, number) + i, block))
                here_[i].template find<Sample>(block.samples.data(), block.masks, bound_);
        });
        return stop_.stop_requested() ? Status(cancelledError()) : Status();
    }

    const LeafIntervals<Key>& of(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const auto i = static_cast<std::size_t>(x + grid_.bricks()[0] * y);
        return z == number_ ? here_[i] : below_[i];
    }
    /// Whether a brick or one that touches it from below has leaves: if not, its edges are as ever.
    bool hasLeavesAround(const std::array<std::int64_t, 3>& brick) const {
        for (int i = 0; i < 8; ++i) {
            const std::int64_t x = brick[0] - (i & 1), y = brick[1] - (i >> 1 & 1), z = brick[2] - (i >> 2);
            if (x >= 0 && y >= 0 && z >= 0 && !of(x, y, z).isEmpty())
                return true;
        }
        return false;
    }

    /// When an edge carries a vertex; ascending. `ends`: the lesser and the greater key of its ends. REQUIRES: its
    /// cells lie in these layers.
    void carriedBy(const std::array<std::int64_t, 3>& start, int axis, const KeyInterval<Key>& ends,
                   std::vector<CarriedVertex<Key>>& carried) const {
        carried.clear();
        const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
        // Around the edge: of each cell the stretches in which it belongs to a merged one.
        std::array<Stretches, 4> cells;
        std::size_t cellCount = 0;
        for (int k = 0; k < 4; ++k) {
            std::array<std::int64_t, 3> cell = start;
            cell[u] -= k & 1;
            cell[v] -= k >> 1;
            if (cell[u] < 0 || cell[v] < 0 || cell[u] + 1 >= grid_.dims()[static_cast<int>(u)] ||
                cell[v] + 1 >= grid_.dims()[static_cast<int>(v)])
                continue;
            findStretches(cell, ends, cells[cellCount++]);
        }
        if (std::all_of(cells.begin(), cells.end(), [](const Stretches& cell) { return cell.empty(); })) {
            carried.push_back({ends, 0});
            return;
        }
        std::vector<Key> breaks{ends.after, ends.until};
        for (std::size_t c = 0; c < cellCount; ++c)
            for (const auto& [interval, level] : cells[c]) {
                breaks.push_back(interval.after);
                breaks.push_back(interval.until);
            }
        std::sort(breaks.begin(), breaks.end());
        breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
        const int aligned = std::countr_zero(static_cast<std::uint64_t>(start[u] | start[v]));
        for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
            int smallest = 4;
            for (std::size_t c = 0; c < cellCount; ++c)
                smallest = std::min(smallest, levelAt(cells[c], breaks[b]));
            if (smallest > aligned)
                continue;
            if (!carried.empty() && carried.back().level == smallest && carried.back().interval.until == breaks[b])
                carried.back().interval.until = breaks[b + 1];
            else
                carried.push_back({{breaks[b], breaks[b + 1]}, smallest});
        }
    }

private:
    struct Block {
        alignas(64) std::array<extract::StoredSample<Sample>, extract::kPaddedPoints> samples;
        extract::BrickMasks masks;
    };
    using Stretches = std::vector<std::pair<KeyInterval<Key>, int>>;

    void findStretches(const std::array<std::int64_t, 3>& cell, const KeyInterval<Key>& ends,
                       Stretches& stretches) const {
        const LeafIntervals<Key>& leaves = of(cell[0] / kBrickSide, cell[1] / kBrickSide, cell[2] / kBrickSide);
        if (leaves.isEmpty())
            return;
        for (int level = 1; level <= 3; ++level)
            for (const KeyInterval<Key>& interval :
                 leaves.of(level, static_cast<int>(cell[0] % kBrickSide), static_cast<int>(cell[1] % kBrickSide),
                           static_cast<int>(cell[2] % kBrickSide)))
                if (interval.after < ends.until && interval.until > ends.after)
                    stretches.push_back(
                        {{std::max(interval.after, ends.after), std::min(interval.until, ends.until)}, level});
    }

    static int levelAt(const Stretches& stretches, Key after) {
        for (const auto& [interval, level] : stretches)
            if (interval.after <= after && after < interval.until)
                return level;
        return 0;
    }

    // The samples of a closed brick, and its valid cells; false if there is none.
    bool fill(const PreparedLayer<Sample>& layer, BrickIndex brick, Block& block) const {
        const auto coords = grid_.brickCoords(brick);
        std::array<int, 3> points{};
        for (std::size_t a = 0; a < 3; ++a)
            points[a] = static_cast<int>(std::min<std::int64_t>(extract::kPointSide, grid_.dims()[static_cast<int>(a)] -
                                                                                         coords[a] * kBrickSide));
        if (std::min({points[0], points[1], points[2]}) < 2)
            return false;
        block.masks.cells = {};
        extract::StoredSample<Sample> any{};
        std::array<bool, extract::kClosedPoints> isThere{};
        bool hasAny = false;
        for (int z = 0; z < points[2]; ++z)
            for (int y = 0; y < points[1]; ++y)
                for (int x = 0; x < points[0]; ++x) {
                    const std::array<std::int64_t, 3> p{coords[0] * kBrickSide + x, coords[1] * kBrickSide + y,
                                                        coords[2] * kBrickSide + z};
                    const std::size_t at = layer.at(p[0], p[1], p[2]);
                    const extract::ClosedPoint local = extract::closedPoint(x, y, z);
                    if (!layer.missing(at)) {
                        isThere[local.index()] = true;
                        block.samples[local.index()] = extract::storedOf(sampleOfKey<Sample>(layer.key(at)));
                        any = block.samples[local.index()];
                        hasAny = true;
                    }
                    const bool isCell = x + 1 < points[0] && y + 1 < points[1] && z + 1 < points[2];
                    if (isCell && (!layer.hasMissing() || layer.isCellValid(p[0], p[1], p[2])))
                        block.masks.cells.set(local);
                }
        for (std::size_t i = 0; i < block.samples.size(); ++i)
            if (i >= isThere.size() || !isThere[i])
                block.samples[i] = any;
        extract::edgesOfCells(block.masks.cells, block.masks.edges);
        return hasAny;
    }

    BrickGrid grid_;
    extract::MergeBound bound_;
    std::stop_token stop_;
    std::int64_t number_ = 0;
    std::vector<LeafIntervals<Key>> here_, below_; ///< by brick of the layer
};

} // namespace isoslider::preprocess
