#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "core/extract/brick.h"
#include "core/index/index_format.h"

namespace isoslider::extract {

/// Finds live bricks by their place in the grid. A two-level table, filled on demand: memory follows
/// the surface, not the volume. find() and create() may run on any thread; removal may not run beside
/// them.
class BrickTable {
public:
    BrickTable(const BrickGrid& grid, const std::vector<index::MissingCells>& missingCells);
    ~BrickTable();

    Brick* find(BrickIndex brick) const {
        const Leaf* leaf = leaves_[brick >> kLeafBits].load(std::memory_order_acquire);
        return leaf ? leaf->bricks[brick & kLeafMask].load(std::memory_order_acquire) : nullptr;
    }
    Brick& findOrCreate(BrickIndex brick) {
        Brick* found = find(brick);
        return found ? *found : create(brick);
    }
    /// REQUIRES: no other thread uses the table.
    void remove(Brick& brick);
    void clear();

    /// Live bricks in no particular order.
    const std::vector<Brick*>& bricks() const { return bricks_; }
    const BrickGrid& grid() const { return grid_; }
    std::size_t memoryBytes() const;

private:
    static constexpr int kLeafBits = 9;
    static constexpr BrickIndex kLeafMask = (1u << kLeafBits) - 1;
    struct Leaf {
        std::atomic<Brick*> bricks[1u << kLeafBits] = {};
    };

    Brick& create(BrickIndex brick);
    void reset(Brick& brick, BrickIndex index) const;

    BrickGrid grid_;
    const std::vector<index::MissingCells>& missingCells_;
    std::vector<std::atomic<Leaf*>> leaves_;
    std::mutex mutex_;
    std::vector<Brick*> bricks_;
    std::vector<std::unique_ptr<Brick>> owned_;
    std::vector<Brick*> free_;
};

} // namespace isoslider::extract
