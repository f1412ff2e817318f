#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// Changes of counts by brick, of one thread: a table with open addressing, as large as what it holds, in which bricks
/// one behind the other lie in one line of the cache. add() is O(1).
class BrickDeltas {
public:
    struct Delta {
        BrickIndex brick = kNone;
        std::int32_t count = 0;
    };

    BrickDeltas() { places_.reserve(table_.size() / 2); }

    /// A sum that would be larger than any that can be right stays at a limit. REQUIRES: so is no count. Throws
    /// std::bad_alloc; nothing is added then.
    void add(BrickIndex brick, std::int32_t count) {
        std::size_t place = homeOf(brick);
        while (table_[place].brick != brick) {
            if (table_[place].brick == kNone) {
                place = insert(brick);
                break;
            }
            place = (place + 1) & mask();
        }
        std::int32_t& sum = table_[place].count;
        sum = std::clamp(sum + count, -kMost, kMost);
    }
    /// Calls visit(brick, count) for each brick that was added, in the order in which they came first.
    template <class Visit>
    void forEach(const Visit& visit) const {
        for (const std::uint32_t place : places_)
            visit(table_[place].brick, table_[place].count);
    }
    std::size_t size() const { return places_.size(); }
    void clear() {
        for (const std::uint32_t place : places_)
            table_[place] = {};
        places_.clear();
    }
    std::size_t memoryBytes() const {
        return table_.capacity() * sizeof(Delta) + places_.capacity() * sizeof places_[0];
    }

private:
    static constexpr BrickIndex kNone{~std::uint32_t{0}};
    static constexpr std::int32_t kMost = (1 << 30) - 1;
    static constexpr int kLeastBits = 10, kLineBits = 3; ///< deltas in a line of the cache

    std::size_t mask() const { return table_.size() - 1; }
    std::size_t homeOf(BrickIndex brick) const {
        constexpr std::uint32_t kGoldenRatio = 0x9e3779b1u;
        const std::uint32_t line = ((brick.number() >> kLineBits) * kGoldenRatio) >> (32 - bits_ + kLineBits);
        return std::size_t{line} << kLineBits | (brick.number() & ((1u << kLineBits) - 1));
    }
    std::size_t freePlaceFor(BrickIndex brick) const {
        std::size_t place = homeOf(brick);
        while (table_[place].brick != kNone)
            place = (place + 1) & mask();
        return place;
    }
    std::size_t insert(BrickIndex brick) {
        if (2 * (places_.size() + 1) > table_.size())
            grow();
        const std::size_t place = freePlaceFor(brick);
        table_[place].brick = brick;
        places_.push_back(static_cast<std::uint32_t>(place));
        return place;
    }
    void grow() {
        std::vector<Delta> before(2 * table_.size());
        places_.reserve(before.size() / 2); // whatever fails comes first
        before.swap(table_);
        ++bits_;
        for (std::uint32_t& place : places_) {
            const Delta& delta = before[place];
            place = static_cast<std::uint32_t>(freePlaceFor(delta.brick));
            table_[place] = delta;
        }
    }

    int bits_ = kLeastBits; ///< of a place
    std::vector<Delta> table_ = std::vector<Delta>(std::size_t{1} << kLeastBits);
    std::vector<std::uint32_t> places_; ///< of those that are used
};

/// Tables that threads take in turn, so that no memory is cleared for each use; large ones are not kept. Any thread.
class BrickDeltasPool {
public:
    BrickDeltasPool() { spares_.reserve(kMostSpares); }

    /// Clear ones.
    std::unique_ptr<BrickDeltas> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!spares_.empty()) {
                auto deltas = std::move(spares_.back());
                spares_.pop_back();
                return deltas;
            }
        }
        return std::make_unique<BrickDeltas>();
    }
    void giveBack(std::unique_ptr<BrickDeltas> deltas) noexcept {
        if (deltas->memoryBytes() > kMostBytes)
            return;
        deltas->clear();
        const std::lock_guard lock(mutex_);
        if (spares_.size() < kMostSpares)
            spares_.push_back(std::move(deltas));
    }

private:
    static constexpr std::size_t kMostBytes = 1 << 20, kMostSpares = 16;

    std::mutex mutex_;
    std::vector<std::unique_ptr<BrickDeltas>> spares_;
};

} // namespace isoslider::extract
