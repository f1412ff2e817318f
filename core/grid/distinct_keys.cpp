#include "core/grid/distinct_keys.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <mutex>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/base/spin_lock.h"
#include "core/grid/classification.h"

namespace isoslider {
namespace {

// Sets of keys, all of one part of their range. insert() takes at most kStaged keys and no memory: where they find no
// room it returns false and grow(), which takes grownBytes() and gives bytes() back at its end, makes enough.

/// A bit for each key.
class KeyBitmap {
public:
    using Key = std::uint32_t;
    static constexpr std::size_t kPartitions = 4096, kStaged = 32;
    static std::size_t partitionOf(Key key) { return key >> 20; }
    static Key spread(Key key) { return key; }

    std::uint64_t bytes() const { return words_ ? kWords * sizeof(std::uint64_t) : 0; }
    std::uint64_t grownBytes() const { return kWords * sizeof(std::uint64_t); }
    void grow() { words_ = std::make_unique<std::uint64_t[]>(kWords); }
    bool insert(std::span<const Key> keys) {
        if (!words_)
            return false;
        for (const Key key : keys)
            __builtin_prefetch(&words_[wordOf(key)], 1);
        for (const Key key : keys)
            words_[wordOf(key)] |= std::uint64_t{1} << (key & 63);
        return true;
    }
    std::uint64_t count() const {
        std::uint64_t count = 0;
        for (std::size_t w = 0; words_ && w < kWords; ++w)
            count += static_cast<std::uint64_t>(std::popcount(words_[w]));
        return count;
    }

private:
    static constexpr std::size_t kWords = (std::size_t{1} << 20) / 64;
    static std::size_t wordOf(Key key) { return key >> 6 & (kWords - 1); }

    std::unique_ptr<std::uint64_t[]> words_;
};

/// A list of keys, of which those that are there already are removed when it is full: a table for a whole partition
/// would wait for main memory at every key. 0 is the key of no finite sample.
class KeyList {
public:
    using Key = std::uint64_t;
    static constexpr int kPartitionBits = 10;
    static constexpr std::size_t kPartitions = 1 << kPartitionBits, kStaged = 64;
    static std::size_t partitionOf(Key key) { return key >> (64 - kPartitionBits); }
    /// One to one, and 0 stays 0: keys of doubles that are alike in their upper halves come to lie apart.
    static Key spread(Key key) {
        key *= 0x9e3779b97f4a7c15u;
        key ^= key >> 32;
        return key * 0xd6e8feb86659fd93u;
    }

    std::uint64_t bytes() const { return capacity_ * sizeof(Key); }
    std::uint64_t grownBytes() const { return grown() * sizeof(Key); }
    void grow() {
        keys_.reserve(grown());
        capacity_ = grown();
    }
    bool insert(std::span<const Key> keys) {
        if (keys_.size() + keys.size() > capacity_) {
            removeDuplicates();
            if (keys_.size() > capacity_ / 2 || capacity_ == 0)
                return false;
        }
        keys_.insert(keys_.end(), keys.begin(), keys.end());
        return true;
    }
    std::uint64_t count() {
        removeDuplicates();
        return keys_.size();
    }

private:
    std::size_t grown() const { return std::max(2 * kStaged, 2 * capacity_); }

    void removeDuplicates() {
        thread_local std::vector<Key> table;
        const std::size_t places = std::bit_ceil(std::max<std::size_t>(64, 2 * keys_.size()));
        const int shift = 64 - std::countr_zero(places);
        table.assign(places, 0);
        std::size_t kept = 0;
        for (const Key key : keys_) {
            std::size_t at = key << kPartitionBits >> shift;
            while (table[at] != key && table[at] != 0)
                at = (at + 1) & (places - 1);
            keys_[kept] = key;
            kept += table[at] == 0;
            table[at] = key;
        }
        keys_.resize(kept);
    }

    std::vector<Key> keys_;
    std::size_t capacity_ = 0;
};

} // namespace

// Measured: ns of processor time per sample of 256^3 in spans of 4096, endPass() included, on one thread and on two:
// 16-bit 0.3 to 0.4; f32 5.3 to 5.5 (14 million distinct values), 3.6 to 3.9 (some thousand); i32 2.9 to 3.8 (2
// million); f64 16 to 17 (all distinct), 3.9 to 4.3 (some thousand). f32 with a third of the memory it needs: 3.4 in
// each of 2 passes. Bitmaps of each thread, joined when the bound is near, took f32 to 3.5 and i32 to 1.2, chained
// blocks f64 to 8.6, for three times the code; a hash table for each partition took f64 to 45.

// ---- 16-bit keys: a byte for each, in a table for each thread. Bits would be read again and again right after they
// were written where samples are alike; bytes are only written.

template <>
class DistinctKeySet<std::uint16_t> {
public:
    explicit DistinctKeySet(std::uint64_t) {}

    template <class Sample>
    void add(std::span<const Sample> samples) {
        std::uint8_t* const isSeen = tables_.local().data();
        for (const Sample sample : samples)
            isSeen[keyOf(sample)] = 1;
    }
    bool endPass() {
        Table seen{};
        for (const Table& table : tables_)
            for (std::size_t key = 0; key < seen.size(); ++key)
                seen[key] |= table[key];
        count_ = static_cast<std::uint64_t>(std::count(seen.begin(), seen.end(), 1));
        return true;
    }
    std::uint64_t count() const { return count_; }

private:
    using Table = std::array<std::uint8_t, 1 << 16>;
    tbb::enumerable_thread_specific<Table> tables_{[] { return Table{}; }};
    std::uint64_t count_ = 0;
};

// ---- Wider keys: the range is cut into partitions, each a set under a lock. A thread stages its keys by partition and
// hands over a full stage at once: locks are rare and memory is touched in groups. A set that would grow beyond the
// bound while others hold memory is dropped, and its partition postponed to the next pass; the last one that holds
// memory may grow on, so that each pass finishes at least one.

template <class Set>
class PartitionedKeys {
public:
    explicit PartitionedKeys(std::uint64_t memoryBytes)
        : memoryBytes_(std::max(memoryBytes, kLeastBytes)), partitions_(Set::kPartitions) {}

    template <class Sample>
    void add(std::span<const Sample> samples) {
        Stages& stages = stages_.local();
        for (const Sample sample : samples) {
            if (isMissing(sample))
                continue;
            const Key key = Set::spread(keyOf(sample));
            const std::size_t p = Set::partitionOf(key);
            stages.keys[p * Set::kStaged + stages.counts[p]] = key;
            if (++stages.counts[p] == Set::kStaged)
                insert(p, stages);
        }
    }

    bool endPass() {
        std::atomic<bool> isComplete = true;
        tbb::parallel_for(std::size_t{0}, Set::kPartitions, [&](std::size_t p) {
            for (Stages& stages : stages_)
                insert(p, stages);
            Partition& partition = partitions_[p];
            if (partition.state == State::Postponed) {
                partition.state = State::Open;
                isComplete = false;
            } else if (partition.state == State::Open) {
                count_ += partition.set.count();
                drop(partition, State::Counted);
            }
        });
        usedBytes_ = 0;
        return isComplete;
    }

    std::uint64_t count() const { return count_; }

private:
    using Key = typename Set::Key;
    static constexpr std::uint64_t kLeastBytes = std::uint64_t{1} << 20;
    enum class State : std::uint8_t { Open, Postponed, Counted };

    struct Partition {
        SpinLock lock;
        State state = State::Open;
        Set set;
    };
    struct Stages {
        std::vector<Key> keys = std::vector<Key>(Set::kPartitions * Set::kStaged);
        std::array<std::uint8_t, Set::kPartitions> counts{};
    };

    void insert(std::size_t p, Stages& stages) {
        const std::span<const Key> keys(&stages.keys[p * Set::kStaged], stages.counts[p]);
        stages.counts[p] = 0;
        Partition& partition = partitions_[p];
        const std::lock_guard lock(partition.lock);
        if (keys.empty())
            return;
        while (partition.state == State::Open && !partition.set.insert(keys))
            grow(partition);
    }

    // The old table lives until the new one is filled, so it counts until then. One set at a time: two that postpone
    // each other would leave none.
    void grow(Partition& partition) {
        const std::lock_guard lock(growing_);
        const std::uint64_t had = partition.set.bytes(), growth = partition.set.grownBytes();
        usedBytes_ -= had;
        if (usedBytes_ > 0 && usedBytes_ + had + growth > memoryBytes_) {
            drop(partition, State::Postponed);
            return;
        }
        partition.set.grow();
        usedBytes_ += growth;
    }

    void drop(Partition& partition, State state) {
        partition.set = Set();
        partition.state = state;
    }

    const std::uint64_t memoryBytes_;
    std::vector<Partition> partitions_;
    std::mutex growing_;
    std::uint64_t usedBytes_ = 0;
    tbb::enumerable_thread_specific<Stages> stages_;
    std::atomic<std::uint64_t> count_ = 0;
};

template <>
class DistinctKeySet<std::uint32_t> : public PartitionedKeys<KeyBitmap> {
    using PartitionedKeys::PartitionedKeys;
};

template <>
class DistinctKeySet<std::uint64_t> : public PartitionedKeys<KeyList> {
    using PartitionedKeys::PartitionedKeys;
};

template <class Sample>
DistinctKeys<Sample>::DistinctKeys(std::uint64_t memoryBytes)
    : set_(std::make_unique<DistinctKeySet<KeyOf<Sample>>>(memoryBytes)) {}

template <class Sample>
DistinctKeys<Sample>::~DistinctKeys() = default;

template <class Sample>
void DistinctKeys<Sample>::add(std::span<const Sample> samples) {
    set_->add(samples);
}

template <class Sample>
bool DistinctKeys<Sample>::endPass() {
    return set_->endPass();
}

template <class Sample>
std::uint64_t DistinctKeys<Sample>::count() const {
    return set_->count();
}

#define ISO_INSTANTIATE(Sample, Name) template class DistinctKeys<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider
