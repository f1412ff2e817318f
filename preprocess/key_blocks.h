#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/extract/virtual_array.h"

namespace isoslider::preprocess {

/// Keys in a list.
struct KeyBlock {
    static constexpr std::uint64_t kCapacity = 62;
    KeyBlock* next;
    std::uint64_t count;
    std::array<std::uint64_t, kCapacity> keys;
};
static_assert(sizeof(KeyBlock) == 512);

/// The blocks that fit into a bound. take and give: any thread; the others: one thread alone.
class BlockPool {
public:
    explicit BlockPool(std::uint64_t maxBytes)
        : maxBlocks_(maxBytes / sizeof(KeyBlock)), blocks_(maxBlocks_ + kBlocksBeyond) {}

    /// At most `count` in a list, none when the bound is reached.
    KeyBlock* take(int count) {
        const std::lock_guard lock(mutex_);
        KeyBlock* list = nullptr;
        for (; count > 0 && used() < maxBlocks_; --count) {
            KeyBlock* const block = takeOne();
            block->next = list;
            list = block;
        }
        return list;
    }
    /// One even when the bound is reached.
    KeyBlock* takeAnyway() {
        const std::lock_guard lock(mutex_);
        ISO_CHECK(used() < maxBlocks_ + kBlocksBeyond);
        return takeOne();
    }
    void give(KeyBlock* block) {
        const std::lock_guard lock(mutex_);
        block->next = free_;
        free_ = block;
        ++freeCount_;
    }
    /// All come back, without being looked at.
    void reset() {
        touched_ = freeCount_ = 0;
        free_ = nullptr;
    }
    bool isEmpty() const { return used() >= maxBlocks_; }
    bool hasMuchRoom() const { return used() <= maxBlocks_ - maxBlocks_ / 4; }

    /// Of address space only, until they are taken: when room is made, what 500 threads hold may come on top.
    static constexpr std::uint64_t kBlocksBeyond = std::uint64_t{1} << 18;

private:
    std::uint64_t used() const { return touched_ - freeCount_; }

    KeyBlock* takeOne() {
        if (free_ == nullptr)
            return &blocks_[touched_++];
        --freeCount_;
        return std::exchange(free_, free_->next);
    }

    const std::uint64_t maxBlocks_;
    std::mutex mutex_;
    extract::VirtualArray<KeyBlock> blocks_;
    std::uint64_t touched_ = 0; // blocks that were ever taken
    std::uint64_t freeCount_ = 0;
    KeyBlock* free_ = nullptr;
};

/// Finds the distinct ones among keys that are not 0: sorts them into buckets, the table of each of which
/// stays in the nearest cache.
class DistinctFilter {
public:
    void add(std::span<const std::uint64_t> keys) { keys_.insert(keys_.end(), keys.begin(), keys.end()); }

    /// Calls found(key) once for each, and forgets all.
    template <class Function>
    void finish(const Function& found) {
        const int bits = std::min<int>(std::bit_width(keys_.size() / kBucketKeys), kMaxBucketBits);
        std::vector<std::size_t> ends(std::size_t{1} << bits);
        const auto bucketOf = [&](std::uint64_t key) { return bits == 0 ? 0 : spread(key) >> (64 - bits); };
        for (const std::uint64_t key : keys_)
            ++ends[bucketOf(key)];
        std::exclusive_scan(ends.begin(), ends.end(), ends.begin(), std::size_t{0});
        sorted_.resize(keys_.size());
        for (const std::uint64_t key : keys_)
            sorted_[ends[bucketOf(key)]++] = key;
        keys_.clear();
        std::size_t begin = 0;
        for (const std::size_t end : ends) {
            findDistinct({sorted_.data() + begin, end - begin}, bits, found);
            begin = end;
        }
    }

private:
    static constexpr std::size_t kBucketKeys = 512;
    static constexpr int kMaxBucketBits = 11;

    static std::uint64_t spread(std::uint64_t key) { return key * 0x9e3779b97f4a7c15u; }

    template <class Function>
    void findDistinct(std::span<const std::uint64_t> keys, int bucketBits, const Function& found) {
        const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(64, keys.size() * 2));
        const int shift = 64 - std::countr_zero(capacity);
        slots_.assign(capacity, 0);
        for (const std::uint64_t key : keys) {
            std::size_t slot = spread(key) << bucketBits >> shift;
            while (slots_[slot] != key && slots_[slot] != 0)
                slot = (slot + 1) & (capacity - 1);
            if (slots_[slot] == 0) {
                slots_[slot] = key;
                found(key);
            }
        }
    }

    std::vector<std::uint64_t> keys_, sorted_, slots_;
};

} // namespace isoslider::preprocess
