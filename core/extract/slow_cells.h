#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <limits>
#include <mutex>
#include <vector>

#include "core/cell/cell_states.h"
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
    cell::StateInterval interval{}; ///< isovalues between which no cell of the brick changes its state
    std::vector<AmbiguousCell> ambiguous; ///< in no order
    std::vector<InnerCell> inner;         ///< in no order
    std::uint32_t innerBegin = kNoRun;
    std::uint32_t innerCapacity = 0;
    std::uint32_t innerEnd = 0; ///< vertices handed out, those in holes included
    /// Where cells that are gone have left room for one vertex, or for a tunnel's six.
    std::vector<std::uint16_t> singleHoles, tunnelHoles;
    std::array<cell::StateId, kBrickPoints> state; ///< of the ambiguous cells
    /// For cells in `inner`: their place there.
    std::array<std::uint16_t, kBrickPoints> innerPlace;

    void clear() {
        interval = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        ambiguous.clear();
        inner.clear();
        forgetInnerRun();
    }
    void forgetInnerRun() {
        innerBegin = kNoRun;
        innerCapacity = innerEnd = 0;
        singleHoles.clear();
        tunnelHoles.clear();
    }
    void findInterval() {
        interval = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
        for (const AmbiguousCell& a : ambiguous) {
            interval.below = std::max(interval.below, a.interval.below);
            interval.above = std::min(interval.above, a.interval.above);
        }
    }
    /// REQUIRES: the cell has inner vertices.
    InnerCell& innerOf(LocalPoint cell) { return inner[innerPlace[cell]]; }
    const InnerCell& innerOf(LocalPoint cell) const { return inner[innerPlace[cell]]; }
    void addInner(const InnerCell& added) {
        innerPlace[added.cell] = static_cast<std::uint16_t>(inner.size());
        inner.push_back(added);
    }
    void removeInner(LocalPoint cell) {
        inner[innerPlace[cell]] = inner.back();
        innerPlace[inner.back().cell] = innerPlace[cell];
        inner.pop_back();
    }
};

/// All SlowCells of a surface, and their intervals side by side, so that a move finds the bricks whose
/// cells cross a saddle by reading 16 bytes for each. create() may run on any thread.
class SlowCellTable {
public:
    SlowCells& create(Brick& brick);
    /// REQUIRES here and below: no other thread uses the table.
    void remove(Brick& brick);
    /// Never fails, whatever failed before; bricks that had cells here are gone.
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
