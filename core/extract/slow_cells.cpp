#include "core/extract/slow_cells.h"

namespace isoslider::extract {

SlowCells& SlowCellTable::create(Brick& brick) {
    const std::lock_guard lock(mutex_);
    if (free_.empty())
        free_.push_back(&pool_.emplace_back());
    SlowCells& cells = *free_.back();
    cells.clear();
    intervals_.push_back(cells.interval);
    try {
        list_.push_back(&cells);
    } catch (...) { // both or neither: they are walked together
        intervals_.pop_back();
        throw;
    }
    free_.pop_back();
    cells.brick = &brick;
    cells.listPosition = static_cast<std::uint32_t>(list_.size() - 1);
    brick.slow = &cells;
    return cells;
}

void SlowCellTable::remove(Brick& brick) {
    SlowCells& cells = *brick.slow;
    list_[cells.listPosition] = list_.back();
    intervals_[cells.listPosition] = intervals_.back();
    list_[cells.listPosition]->listPosition = cells.listPosition;
    list_.pop_back();
    intervals_.pop_back();
    cells.clear();
    cells.brick = nullptr;
    brick.slow = nullptr;
    free_.push_back(&cells);
}

void SlowCellTable::clear() {
    list_.clear();
    intervals_.clear();
    free_.clear();
    pool_.clear();
}

void SlowCellTable::refreshInterval(const SlowCells& cells) { intervals_[cells.listPosition] = cells.interval; }

std::size_t SlowCellTable::memoryBytes() const {
    std::size_t bytes = pool_.size() * sizeof(SlowCells) + intervals_.size() * sizeof(intervals_[0]);
    for (const SlowCells& cells : pool_)
        bytes += cells.ambiguous.capacity() * sizeof(AmbiguousCell) + cells.inner.capacity() * sizeof(InnerCell);
    return bytes;
}

} // namespace isoslider::extract
