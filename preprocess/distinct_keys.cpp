#include "preprocess/distinct_keys.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <mutex>
#include <shared_mutex>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_reduce.h>

#include "core/base/check.h"
#include "core/extract/virtual_array.h"
#include "core/grid/classification.h"
#include "preprocess/key_blocks.h"

namespace isoslider::preprocess {
namespace {

template <class Function>
std::uint64_t sumInParallel(std::size_t end, const Function& function) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, end), std::uint64_t{0},
        [&](const auto& range, std::uint64_t sum) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                sum += function(i);
            return sum;
        },
        std::plus<>());
}

} // namespace

// Measured: ns of processor time per sample of 256^3 in spans of 4096, count() included, on one thread and on
// two: 16-bit 0.3 to 0.4; f32 3.4 to 3.8 (15 million distinct values), 2.2 (some thousand); i32 1.6 (2
// million); f64 8.5 (all distinct), 3.4 (some thousand). f32 with a third of the memory it needs: 3.5 in each
// of 5 passes. f32 in bitmaps from the heap, without prefetching, took 6 to 7.

// ---- 16-bit keys: a byte for each, in a table for each thread. Bits would be read again and again right
// after they were written where samples are alike; bytes are only written.

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
    bool needsAnotherPass() const { return false; }
    void beginNextPass() {}
    std::uint64_t count() {
        Table seen{};
        for (const Table& table : tables_)
            for (std::size_t key = 0; key < seen.size(); ++key)
                seen[key] |= table[key];
        return static_cast<std::uint64_t>(std::count(seen.begin(), seen.end(), 1));
    }

private:
    using Table = std::array<std::uint8_t, 1 << 16>;
    tbb::enumerable_thread_specific<Table> tables_{[] { return Table{}; }};
};

// ---- 32-bit keys: a bitmap for each upper half that occurs. At first each thread has its own: an atomic or
// for each new value would cost more than all the rest. When half of the bound is taken, all threads give
// their bitmaps to one shared set and go on in that, atomically; there, upper halves that find no room are
// postponed.

template <>
class DistinctKeySet<std::uint32_t> {
public:
    explicit DistinctKeySet(std::uint64_t memoryBytes)
        : maxBitmaps_(std::clamp<std::uint64_t>(memoryBytes / kBitmapBytes, 1, kPrefixes)),
          memory_(maxBitmaps_ * kWords),
          shared_(kPrefixes) {}

    template <class Sample>
    void add(std::span<const Sample> samples) {
        Lane& lane = lanes_.local();
        if (!lane.isShared && isSharing_.load(std::memory_order_relaxed))
            share(lane);
        for (std::size_t at = 0; at < samples.size(); at += kBatch) {
            std::array<std::uint32_t, kBatch> keys;
            std::size_t count = 0;
            for (const Sample sample : samples.subspan(at, std::min(kBatch, samples.size() - at))) {
                keys[count] = keyOf(sample); // kept unless missing
                count += !isMissing(sample);
            }
            const std::span<const std::uint32_t> batch(keys.data(), count);
            const std::size_t done = lane.isShared ? 0 : addOwn(lane, batch);
            addShared(batch.subspan(done));
        }
    }

    bool needsAnotherPass() const { return !postponed_.empty(); }

    void beginNextPass() {
        endPass();
        for (const std::uint32_t prefix : postponed_)
            shared_[prefix] = nullptr;
        postponed_.clear();
    }

    std::uint64_t count() {
        endPass();
        return count_;
    }

private:
    using Word = std::uint64_t;
    static constexpr std::size_t kPrefixes = std::size_t{1} << 16;
    static constexpr std::size_t kWords = kPrefixes / 64;
    static constexpr std::size_t kBitmapBytes = kWords * sizeof(Word);
    static constexpr std::size_t kBatch = 256;

    // What one thread has seen.
    struct Lane {
        std::vector<Word*> bitmaps; // by prefix; null: not met yet
        std::vector<std::uint32_t> own; // prefixes of those it has to itself
        std::unique_ptr<Word[]> waste; // takes what is counted already, so that nobody has to ask
        bool isShared = false;
    };

    static std::size_t prefixOf(std::uint32_t key) { return key >> 16; }
    // Turned by the prefix: round numbers, alike in their lower halves, would all meet in a few cache lines.
    static std::size_t wordOf(std::uint32_t key) { return (key >> 6 ^ key >> 13) & (kWords - 1); }
    static Word bitOf(std::uint32_t key) { return Word{1} << (key & 63); }

    Lane makeLane() const {
        Lane lane;
        lane.bitmaps.resize(kPrefixes);
        lane.waste = std::make_unique<Word[]>(kWords);
        for (std::size_t prefix = 0; prefix < kPrefixes; ++prefix)
            if (shared_[prefix].load(std::memory_order_relaxed) == closed_.data())
                lane.bitmaps[prefix] = lane.waste.get();
        return lane;
    }

    // Returns how many keys found room.
    std::size_t addOwn(Lane& lane, std::span<const std::uint32_t> keys) {
        std::array<Word*, kBatch> words;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            Word* bitmap = lane.bitmaps[prefixOf(keys[i])];
            if (bitmap == nullptr && (bitmap = openOwn(lane, prefixOf(keys[i]))) == nullptr)
                return 0;
            words[i] = bitmap + wordOf(keys[i]);
            __builtin_prefetch(words[i], 1);
        }
        for (std::size_t i = 0; i < keys.size(); ++i)
            *words[i] |= bitOf(keys[i]);
        return keys.size();
    }

    Word* openOwn(Lane& lane, std::size_t prefix) {
        {
            const std::lock_guard lock(mutex_);
            if (Word* const bitmap = takeBitmap(maxBitmaps_ / 2)) {
                lane.own.push_back(static_cast<std::uint32_t>(prefix));
                return lane.bitmaps[prefix] = bitmap;
            }
        }
        share(lane);
        return nullptr;
    }

    void share(Lane& lane) {
        const std::lock_guard lock(mutex_);
        isSharing_ = true;
        lane.isShared = true;
        for (const std::uint32_t prefix : lane.own) {
            Word* const own = lane.bitmaps[prefix];
            Word* const common = shared_[prefix];
            if (common == nullptr) {
                shared_[prefix].store(own, std::memory_order_release);
                continue;
            }
            if (common != closed_.data())
                for (std::size_t w = 0; w < kWords; ++w)
                    if (own[w] != 0)
                        std::atomic_ref(common[w]).fetch_or(own[w], std::memory_order_relaxed);
            free_.push_back(own);
        }
        lane.bitmaps = {};
    }

    // Of zeros; null when `max` are in use. Under the lock.
    Word* takeBitmap(std::size_t max) {
        if (touched_ - free_.size() >= max)
            return nullptr;
        if (free_.empty())
            return memory_.data() + touched_++ * kWords;
        Word* const bitmap = free_.back();
        free_.pop_back();
        std::fill_n(bitmap, kWords, Word{0});
        return bitmap;
    }

    void addShared(std::span<const std::uint32_t> keys) {
        for (const std::uint32_t key : keys) {
            Word* bitmap = shared_[prefixOf(key)].load(std::memory_order_acquire);
            if (bitmap == nullptr)
                bitmap = openShared(prefixOf(key));
            const std::atomic_ref word(bitmap[wordOf(key)]);
            if ((word.load(std::memory_order_relaxed) & bitOf(key)) == 0)
                word.fetch_or(bitOf(key), std::memory_order_relaxed);
        }
    }

    // A bitmap that is shared is never postponed, and half of the bound is for these: each pass gets on.
    Word* openShared(std::size_t prefix) {
        const std::lock_guard lock(mutex_);
        if (Word* const bitmap = shared_[prefix])
            return bitmap;
        Word* bitmap = takeBitmap(maxBitmaps_);
        if (bitmap == nullptr) {
            postponed_.push_back(static_cast<std::uint32_t>(prefix));
            bitmap = closed_.data();
        }
        shared_[prefix].store(bitmap, std::memory_order_release);
        return bitmap;
    }

    // Counts what is not postponed, gives its memory back and closes all.
    void endPass() {
        count_ += sumInParallel(kPrefixes, [&](std::size_t prefix) { return countPrefix(prefix); });
        lanes_.clear();
        memory_.release(0);
        touched_ = 0;
        free_.clear();
        isSharing_ = false;
        for (std::atomic<Word*>& bitmap : shared_)
            bitmap = closed_.data();
    }

    std::uint64_t countPrefix(std::size_t prefix) {
        const Word* const common = shared_[prefix];
        if (common == closed_.data())
            return 0;
        std::vector<const Word*> all;
        if (common != nullptr)
            all.push_back(common);
        for (const Lane& lane : lanes_)
            if (!lane.isShared && lane.bitmaps[prefix] != nullptr)
                all.push_back(lane.bitmaps[prefix]);
        std::uint64_t count = 0;
        for (std::size_t w = 0; w < kWords && !all.empty(); ++w) {
            Word word = 0;
            for (const Word* words : all)
                word |= words[w];
            count += static_cast<std::uint64_t>(std::popcount(word));
        }
        return count;
    }

    using Closed = std::array<Word, kWords>;
    static Closed makeClosed() {
        Closed closed;
        closed.fill(~Word{0}); // all is seen: nobody ever writes there
        return closed;
    }
    Closed closed_ = makeClosed();

    const std::size_t maxBitmaps_;
    extract::VirtualArray<Word> memory_;
    std::size_t touched_ = 0; // bitmaps of memory_ that were ever taken
    std::vector<Word*> free_;
    std::vector<std::atomic<Word*>> shared_; // by prefix; null: not met yet
    std::vector<std::uint32_t> postponed_;
    std::mutex mutex_; // of all these, but shared_ may be read without
    std::atomic<bool> isSharing_ = false;
    tbb::enumerable_thread_specific<Lane> lanes_{[this] { return makeLane(); }};
    std::uint64_t count_ = 0;
};

// ---- 64-bit keys, mixed so that they are spread evenly: lists of keys in partitions, in which a small table
// finds the distinct ones when all have come. Sets to begin with would wait for main memory at each key. When
// the bound is reached, each list is cut to its distinct keys; if these take most of it, the upper half of
// the range is postponed.

template <>
class DistinctKeySet<std::uint64_t> {
public:
    explicit DistinctKeySet(std::uint64_t memoryBytes)
        : pool_(std::max(memoryBytes, kMinBytes)), partitions_(kPartitions) {}

    template <class Sample>
    void add(std::span<const Sample> samples) {
        std::shared_lock lock(mutex_);
        Lane& lane = lanes_.local();
        for (const Sample sample : samples) {
            if (isMissing(sample))
                continue;
            const std::uint64_t key = mix(keyOf(sample));
            const std::uint64_t p = partitionOf(key);
            if (p >= kPartitions)
                continue;
            std::uint64_t& recent = lane.recent[key >> (64 - kRecentBits)];
            lane.keys[p * kStaged + lane.counts[p]] = key; // always: whether it is new is hard to foretell
            lane.counts[p] += recent != key;
            recent = key;
            if (lane.counts[p] == kStaged)
                unload(lane, p, lock);
        }
    }

    bool needsAnotherPass() const { return endOfRange() != 0; }

    void beginNextPass() {
        const std::uint64_t next = endOfRange();
        endPass();
        begin_ = next;
    }

    std::uint64_t count() {
        endPass();
        return count_;
    }

private:
    static constexpr int kPartitionBits = 9;
    static constexpr std::uint64_t kPartitions = 1 << kPartitionBits;
    static constexpr std::uint64_t kMinBytes = 4 * kPartitions * sizeof(KeyBlock);
    static constexpr std::uint64_t kStaged = KeyBlock::kCapacity;
    static constexpr int kRecentBits = 10;
    static constexpr int kSpareBlocks = 16;
    static constexpr std::size_t kBlocksAhead = 4;

    struct Partition {
        std::mutex mutex;
        std::vector<KeyBlock*> blocks; // full ones, perhaps with others among them
    };
    struct Lane {
        std::vector<std::uint64_t> keys = std::vector<std::uint64_t>(kPartitions * kStaged);
        std::array<std::uint8_t, kPartitions> counts{};
        std::array<std::uint64_t, (1 << kRecentBits)> recent{}; // where values repeat, most end here
        KeyBlock* spare = nullptr;

        std::span<const std::uint64_t> staged(std::uint64_t p) const { return {&keys[p * kStaged], counts[p]}; }
    };

    // One to one, and 0, the key of no finite sample, stays 0.
    static std::uint64_t mix(std::uint64_t key) {
        key *= 0x9e3779b97f4a7c15u;
        key ^= key >> 32;
        return key * 0xd6e8feb86659fd93u;
    }

    // The range of a pass is a power of 2 and starts at a multiple of itself.
    std::uint64_t partitionOf(std::uint64_t key) const { return (key ^ begin_) >> shift_; }
    std::uint64_t endOfRange() const { return begin_ + (kPartitions << shift_); }

    // Full buffers go to the partition in one piece. Afterwards there is room for one key at
    // least.
    void unload(Lane& lane, std::uint64_t p, std::shared_lock<std::shared_mutex>& lock) {
        while (lane.counts[p] == kStaged) {
            if (lane.spare == nullptr)
                lane.spare = pool_.take(kSpareBlocks);
            if (lane.spare == nullptr) {
                lock.unlock();
                makeRoom();
                lock.lock();
                continue; // the buffer may have been emptied, too
            }
            KeyBlock* const block = lane.spare;
            lane.spare = block->next;
            block->count = kStaged;
            std::copy_n(&lane.keys[p * kStaged], kStaged, block->keys.begin());
            lane.counts[p] = 0;
            const std::lock_guard partitionLock(partitions_[p].mutex);
            partitions_[p].blocks.push_back(block);
        }
    }

    void makeRoom() {
        const std::unique_lock lock(mutex_);
        if (!pool_.isEmpty())
            return; // another thread has been here
        for (Lane& lane : lanes_)
            while (lane.spare != nullptr)
                pool_.give(std::exchange(lane.spare, lane.spare->next));
        DistinctFilter filter;
        for (Partition& partition : partitions_)
            removeDoubles(partition, filter);
        while (!pool_.hasMuchRoom())
            halveRange();
    }

    void removeDoubles(Partition& partition, DistinctFilter& filter) {
        addBlocks(partition, filter);
        for (KeyBlock* block : std::exchange(partition.blocks, {}))
            pool_.give(block);
        filter.finish([&](std::uint64_t key) { append(partition, key); });
    }

    static void addBlocks(const Partition& partition, DistinctFilter& filter) {
        for (std::size_t b = 0; b < partition.blocks.size(); ++b) {
            const KeyBlock& block = *partition.blocks[b];
            const char* const soon = reinterpret_cast<const char*>(
                partition.blocks[std::min(b + kBlocksAhead, partition.blocks.size() - 1)]);
            for (std::size_t byte = 0; byte < sizeof block; byte += 64)
                __builtin_prefetch(soon + byte);
            filter.add({block.keys.data(), block.count});
        }
    }

    // The upper half is dropped. What the lanes hold would have to be sorted again; so it goes
    // along.
    void halveRange() {
        ISO_CHECK(shift_ > 0);
        --shift_;
        const auto place = [&](std::span<const std::uint64_t> keys) {
            for (const std::uint64_t key : keys)
                if (const std::uint64_t p = partitionOf(key); p < kPartitions)
                    append(partitions_[p], key);
        };
        std::vector<std::vector<KeyBlock*>> lists;
        for (Partition& partition : partitions_)
            lists.push_back(std::exchange(partition.blocks, {}));
        for (const std::vector<KeyBlock*>& list : lists)
            for (KeyBlock* given : list) {
                const KeyBlock block = *given;
                pool_.give(given);
                place({block.keys.data(), block.count});
            }
        for (Lane& lane : lanes_) {
            for (std::uint64_t p = 0; p < kPartitions; ++p)
                place(lane.staged(p));
            lane.counts.fill(0);
        }
    }

    void append(Partition& partition, std::uint64_t key) {
        if (partition.blocks.empty() || partition.blocks.back()->count == KeyBlock::kCapacity) {
            partition.blocks.push_back(pool_.takeAnyway());
            partition.blocks.back()->count = 0;
        }
        KeyBlock& block = *partition.blocks.back();
        block.keys[block.count++] = key;
    }

    void endPass() {
        tbb::enumerable_thread_specific<DistinctFilter> filters;
        count_ += sumInParallel(kPartitions, [&](std::size_t p) { return countPartition(p, filters.local()); });
        for (Partition& partition : partitions_)
            partition.blocks.clear();
        lanes_.clear();
        pool_.reset();
    }

    std::uint64_t countPartition(std::size_t p, DistinctFilter& filter) const {
        addBlocks(partitions_[p], filter);
        for (const Lane& lane : lanes_)
            filter.add(lane.staged(p));
        std::uint64_t count = 0;
        filter.finish([&](std::uint64_t) { ++count; });
        return count;
    }

    BlockPool pool_;
    std::vector<Partition> partitions_;
    std::uint64_t begin_ = 0;
    int shift_ = 64 - kPartitionBits;
    std::shared_mutex mutex_; // shared while keys are added, exclusive while room is made
    tbb::enumerable_thread_specific<Lane> lanes_;
    std::uint64_t count_ = 0;
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
bool DistinctKeys<Sample>::needsAnotherPass() const {
    return set_->needsAnotherPass();
}

template <class Sample>
void DistinctKeys<Sample>::beginNextPass() {
    ISO_CHECK(needsAnotherPass());
    set_->beginNextPass();
}

template <class Sample>
std::uint64_t DistinctKeys<Sample>::count() {
    ISO_CHECK(!needsAnotherPass());
    return set_->count();
}

#define ISO_INSTANTIATE(Sample, Name) template class DistinctKeys<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
