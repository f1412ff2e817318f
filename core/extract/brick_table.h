#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "core/extract/brick.h"
#include "core/extract/virtual_array.h"
#include "core/index/index_format.h"

namespace isoslider::extract {

/// Finds live bricks by their place in the grid. A two-level table, filled on demand: memory follows
/// the surface, not the volume. find() and create() may run on any thread; removal may not run beside
/// them.
class BrickTable {
public:
    BrickTable(const BrickGrid& grid, const std::vector<index::MissingCells>& missingCells);
    ~BrickTable();

    /// A live brick, and whether setTouched() has been called for it; known without looking at it.
    struct Entry {
        Brick* brick;
        bool isTouched;
    };
    Entry entry(BrickIndex brick) const {
        const Leaf* leaf = leaves_[brick >> kLeafBits].load(std::memory_order_acquire);
        const std::uintptr_t bits = leaf ? leaf->bricks[brick & kLeafMask].load(std::memory_order_acquire) : 0;
        return {reinterpret_cast<Brick*>(bits & ~kTouchedBit), (bits & kTouchedBit) != 0};
    }
    Brick* find(BrickIndex brick) const { return entry(brick).brick; }
    void setTouched(const Brick& brick, bool isTouched) {
        leaves_[brick.index >> kLeafBits].load(std::memory_order_relaxed)->bricks[brick.index & kLeafMask].store(
            reinterpret_cast<std::uintptr_t>(&brick) | (isTouched ? kTouchedBit : 0), std::memory_order_release);
    }
    Brick& findOrCreate(BrickIndex brick) {
        Brick* found = find(brick);
        return found ? *found : create(brick);
    }
    /// REQUIRES: no other thread uses the table.
    void remove(Brick& brick);
    /// Never fails, whatever failed before.
    void clear();

    /// Live bricks in no particular order.
    const std::vector<Brick*>& bricks() const { return bricks_; }
    const BrickGrid& grid() const { return grid_; }
    std::size_t memoryBytes() const;

private:
    static constexpr int kLeafBits = 9;
    static constexpr BrickIndex kLeafMask = (1u << kLeafBits) - 1;
    static constexpr std::uintptr_t kTouchedBit = 1;
    struct Leaf {
        std::atomic<std::uintptr_t> bricks[1u << kLeafBits] = {};
    };

    Brick& create(BrickIndex brick);
    void reset(Brick& brick, BrickIndex index) const;

    BrickGrid grid_;
    const std::vector<index::MissingCells>& missingCells_;
    std::vector<std::atomic<Leaf*>> leaves_;
    std::mutex mutex_;
    std::vector<Brick*> bricks_;
    VirtualArray<std::aligned_storage_t<sizeof(Brick), 64>> pool_;
    std::size_t poolSize_ = 0;
    std::vector<Brick*> free_;
};

} // namespace isoslider::extract
