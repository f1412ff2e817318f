#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <queue>
#include <stop_token>
#include <unordered_map>
#include <vector>

#include "core/index/sample_blocks.h"
#include "core/topology/analysis/component_graph.h"
#include "core/topology/cell_saddles.h"

namespace isoslider::topology {

using GridPlace = std::array<std::int64_t, 3>;

/// A set of grid points, by blocks of 8^3.
class PointSet {
public:
    explicit PointSet(const GridDims& dims) {
        for (std::size_t axis = 0; axis < 2; ++axis)
            blocks_[axis] = (dims[axis] + kSide - 1) / kSide;
    }
    PointSet(const PointSet& other) : blocks_(other.blocks_), points_(other.points_) {}
    PointSet& operator=(const PointSet&) = delete;

    /// False if it was there already.
    bool add(const GridPlace& p) {
        std::uint64_t& word = wordOf(p);
        const bool isNew = (word & bitOf(p)) == 0;
        word |= bitOf(p);
        return isNew;
    }
    bool has(const GridPlace& p) const {
        const auto block = points_.find(blockOf(p));
        return block != points_.end() && (block->second[static_cast<std::size_t>(p[2] % kSide)] & bitOf(p)) != 0;
    }
    /// All of another set of the same grid.
    void add(const PointSet& other) {
        for (const auto& [block, bits] : other.points_)
            for (std::size_t z = 0; z < bits.size(); ++z)
                points_[block][z] |= bits[z];
    }

private:
    static constexpr std::int64_t kSide = 8;
    using Bits = std::array<std::uint64_t, kSide>;

    std::int64_t blockOf(const GridPlace& p) const {
        return p[0] / kSide + blocks_[0] * (p[1] / kSide + blocks_[1] * (p[2] / kSide));
    }
    static std::uint64_t bitOf(const GridPlace& p) {
        return std::uint64_t{1} << (p[0] % kSide + kSide * (p[1] % kSide));
    }
    std::uint64_t& wordOf(const GridPlace& p) {
        if (const std::int64_t block = blockOf(p); last_ == nullptr || block != lastBlock_) {
            lastBlock_ = block;
            last_ = &points_[block];
        }
        return (*last_)[static_cast<std::size_t>(p[2] % kSide)];
    }

    std::array<std::int64_t, 2> blocks_{};
    std::unordered_map<std::int64_t, Bits> points_; // its elements stay where they are
    std::int64_t lastBlock_ = 0;
    Bits* last_ = nullptr; ///< the block that was added to last
};

/// What is known of the regions on one side of an isovalue: whether they last long enough.
struct KnownRegions {
    PointSet lasting, shortLived;
};

/// A walk from one grid point through what its side's region is, then through what that joins, in the order of
/// isovalues met: Prim's algorithm on the graph of grid points, edges and joins in cells (TOPOLOGY.md). Within what is
/// there already the highest point comes first, which climbs. What is below is walked with all scalars negated, so
/// that a higher number comes earlier on either side.
class RegionWalk {
public:
    RegionWalk(index::SampleBlocks& samples, Side side, const GridPlace& start, double isovalue);

    /// Ends as soon as the region is known to last that long, which is right for all points of its region then, or when
    /// it meets a known one. `span`: as long as anything lasts. To be called before advance(); `known` must outlive it.
    void endWhenKnown(double least, double span, KnownRegions& known);
    /// Until `points` have been walked to in all, or the end is known. Returns how many were walked to now.
    std::uint64_t advance(std::uint64_t points, const std::stop_token& stop);

    /// Ends a walk that has gone far enough; its region counts as lasting. REQUIRES: endWhenKnown() was called.
    void takeForLasting() {
        if (!isDone_)
            end(true);
    }

    /// The region's end was met, or what endWhenKnown() asks for.
    bool isDone() const { return isDone_; }
    /// Whether the region lasts as long as asked. REQUIRES: isDone(), endWhenKnown() was called.
    bool isLasting() const { return *isLasting_; }
    /// The scalar of the region's first point, and of the join that ends it, as far as they have been walked to.
    double comes() const { return signed_(first_.height); }
    double ends() const { return signed_(level_); }
    double persistence() const { return first_.height - level_; }
    bool lasts() const { return lasts_; } ///< it never joins

private:
    struct Extreme {
        double height;
        GridPlace at;
    };
    struct Waiting {
        double height; ///< the greatest isovalue at which it is joined; of a point that is there: its own
        GridPlace at;
    };
    struct IsLater {
        bool operator()(const Waiting& a, const Waiting& b) const { return a.height < b.height; }
    };
    using Heap = std::priority_queue<Waiting, std::vector<Waiting>, IsLater>;

    double signed_(double scalar) const { return side_ == Side::Above ? scalar : -scalar; }
    double heightOf(const GridPlace& p) const { return signed_(samples_.at(p[0], p[1], p[2])); }
    bool isThere(double height) const;
    void reach(const GridPlace& p, double height);
    void link(const GridPlace& p, double height, double joinedAt);
    void joinNext();
    void expand(const GridPlace& at);
    void end(bool isLasting);
    void endIfLongEnough();

    index::SampleBlocks& samples_;
    Side side_;
    double level_; ///< the isovalue, then that at which what was last joined was
    bool isJoining_ = false, isDone_ = false, lasts_ = false;
    std::uint64_t walked_ = 0;
    Extreme first_{};
    PointSet reached_;
    Heap ready_; ///< reached, there at the level
    Heap waiting_;
    CellHistory history_;
    KnownRegions* known_ = nullptr;
    double least_ = std::numeric_limits<double>::infinity(), span_ = 0.0;
    std::optional<bool> isLasting_;
    std::optional<PointSet> region_; ///< what is in the region itself, once others were joined; kept for `known_`
};

} // namespace isoslider::topology
