#include "core/extract/brick_table.h"

#include <algorithm>
#include <new>
#include <type_traits>

namespace isoslider::extract {

static_assert(std::is_trivially_destructible_v<Brick>, "the pool is dropped as a whole");

BrickTable::BrickTable(const BrickGrid& grid, const std::vector<index::MissingCells>& missingCells)
    : grid_(grid), missingCells_(missingCells), leaves_((grid.brickCount() >> kLeafBits) + 1), pool_(grid.brickCount()) {}

BrickTable::~BrickTable() {
    for (auto& leaf : leaves_)
        delete leaf.load();
}

Brick& BrickTable::create(BrickIndex index) {
    const std::lock_guard lock(mutex_);
    std::atomic<Leaf*>& place = leaves_[index >> kLeafBits];
    Leaf* leaf = place.load(std::memory_order_relaxed);
    if (!leaf) {
        leaf = new Leaf;
        place.store(leaf, std::memory_order_release);
    }
    std::atomic<std::uintptr_t>& entry = leaf->bricks[index & kLeafMask];
    if (const std::uintptr_t other = entry.load(std::memory_order_relaxed)) // another thread was first
        return *reinterpret_cast<Brick*>(other & ~kTouchedBit);
    // What may fail for want of memory comes first: afterwards every brick is listed or free.
    bricks_.push_back(nullptr);
    const bool isNew = free_.empty();
    Brick& brick = isNew ? *new (&pool_[poolSize_++]) Brick : *free_.back();
    if (!isNew)
        free_.pop_back();
    reset(brick, index);
    brick.listPosition = static_cast<std::uint32_t>(bricks_.size() - 1);
    bricks_.back() = &brick;
    entry.store(reinterpret_cast<std::uintptr_t>(&brick), std::memory_order_release);
    return brick;
}

void BrickTable::reset(Brick& brick, BrickIndex index) const {
    const auto coords = grid_.brickCoords(index);
    brick.index = index;
    for (int a = 0; a < 3; ++a)
        brick.origin[a] = static_cast<std::int32_t>(coords[a] * kBrickSide);
    brick.vertexBegin = brick.triangleBegin = kNoRun;
    brick.vertexCapacity = brick.vertexCount = brick.triangleCapacity = 0;
    brick.bucketBegin.fill(0);
    brick.bucketRuns.fill(0);
    brick.active = {};
    brick.touched = {};
    brick.activeCells = {};
    brick.changedCells = {};
    brick.slow = nullptr;
    brick.hasMissing = brick.isCleared = false;
    brick.isListedDirty.store(false, std::memory_order_relaxed);
    brick.firstActivated = brick.firstDeactivated = kNoRun;
    brick.activatedCount = brick.deactivatedCount = 0;
    brick.slot.fill(kNoSlot);
    brick.cellSigns.fill(0);

    // Cells start at every point but the last along each axis.
    std::array<int, 3> cells;
    for (int a = 0; a < 3; ++a)
        cells[a] = static_cast<int>(std::clamp<std::int64_t>(grid_.dims()[a] - 1 - brick.origin[a], 0, kBrickSide));
    std::uint64_t plane = 0;
    for (int y = 0; y < cells[1]; ++y)
        plane |= ((std::uint64_t{1} << cells[0]) - 1) << (8 * y);
    for (int z = 0; z < kBrickSide; ++z)
        brick.usableCells[z] = z < cells[2] ? plane : 0;
    const auto missing = std::lower_bound(missingCells_.begin(), missingCells_.end(), index,
                                          [](const index::MissingCells& m, BrickIndex i) { return m.brick < i; });
    if (missing != missingCells_.end() && missing->brick == index)
        for (int z = 0; z < kBrickSide; ++z) {
            brick.usableCells[z] &= ~missing->cells[z];
            brick.hasMissing = brick.hasMissing || missing->cells[z] != 0;
        }
}

void BrickTable::remove(Brick& brick) {
    Leaf* leaf = leaves_[brick.index >> kLeafBits].load();
    leaf->bricks[brick.index & kLeafMask].store(0);
    bricks_[brick.listPosition] = bricks_.back();
    bricks_[brick.listPosition]->listPosition = brick.listPosition;
    bricks_.pop_back();
    free_.push_back(&brick);
}

void BrickTable::clear() {
    for (const Brick* brick : bricks_)
        leaves_[brick->index >> kLeafBits].load()->bricks[brick->index & kLeafMask].store(0);
    bricks_.clear();
    free_.clear();
    poolSize_ = 0;
}

std::size_t BrickTable::memoryBytes() const { return poolSize_ * sizeof(Brick) + leaves_.size() * sizeof(leaves_[0]); }

} // namespace isoslider::extract
