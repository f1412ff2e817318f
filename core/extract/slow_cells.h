#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <mutex>
#include <vector>

#include "core/cell/trilinear_cell.h"
#include "core/extract/brick.h"

namespace isoslider::extract {

/// An active cell whose signs do not tell its surface, and the isovalues between which its state lasts:
/// face saddles and body saddles change it where no edge changes.
struct AmbiguousCell {
    cell::StateInterval interval;
    LocalPoint cell;
};

/// A cell with inner vertices: where in the brick's run of those they begin.
struct InnerCell {
    LocalPoint cell;
    std::uint16_t first;
    double hiddenScalar; ///< of the corner that lies on no active edge, where a tunnel depends on it
};

/// What a brick with ambiguous cells needs besides its tables; few bricks of smooth data have one.
/// The brick's inner vertices are a run of V and N of their own.
struct SlowCells {
    Brick* brick = nullptr;
    std::uint32_t listPosition = 0;
    std::vector<AmbiguousCell> ambiguous; ///< in no order
    std::vector<InnerCell> inner;         ///< by `first`
    std::uint32_t innerBegin = kNoRun;
    std::uint32_t innerCapacity = 0;
    std::uint32_t innerCount = 0; ///< vertices

    /// Isovalues between which no cell of the brick changes its state.
    cell::StateInterval interval() const {
        cell::StateInterval all{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        for (const AmbiguousCell& a : ambiguous) {
            all.below = std::max(all.below, a.interval.below);
            all.above = std::min(all.above, a.interval.above);
        }
        return all;
    }
    const InnerCell* findInner(LocalPoint cell) const {
        for (const InnerCell& candidate : inner)
            if (candidate.cell == cell)
                return &candidate;
        return nullptr;
    }
};

/// All SlowCells of a surface, and their intervals side by side, so that a move finds the bricks whose
/// cells cross a saddle by reading 16 bytes for each. create() may run on any thread.
class SlowCellTable {
public:
    SlowCells& create(Brick& brick);
    /// REQUIRES here and below: no other thread uses the table.
    void remove(Brick& brick);
    void clear();
    void refreshInterval(const SlowCells& cells);

    /// Calls visit(Brick&) for each brick with a cell whose state may end before `isovalue`.
    template <class Visit>
    void forEachCrossed(double isovalue, const Visit& visit) const {
        for (std::size_t i = 0; i < intervals_.size(); ++i)
            if (!intervals_[i].contains(isovalue))
                visit(*list_[i]->brick);
    }
    const std::vector<SlowCells*>& list() const { return list_; }
    std::size_t memoryBytes() const;

private:
    std::mutex mutex_;
    std::deque<SlowCells> pool_;
    std::vector<SlowCells*> free_;
    std::vector<SlowCells*> list_;
    std::vector<cell::StateInterval> intervals_;
};

} // namespace isoslider::extract
