#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/spin_lock.h"
#include "core/extract/live/chunked_array.h"

namespace isoslider::extract {

/// A part of an arena: `count` elements from `begin` on are in use, `capacity` belong to the run.
struct ArenaRun {
    std::uint32_t begin = 0;
    std::uint32_t capacity = 0;
};

/// Elements of many bricks in one growing array; each brick owns one run. Runs are whole granules, never cross a
/// chunk of the array, and are used again: the smallest free one that is large enough. Adjacent free runs are joined
/// before the array grows because a larger one is missing. Safe from any thread.
///
/// Where much of it is free, the array is made shorter: evacuate() leaves runs below a place to be taken only, those
/// that reach above are for their owners to move there, some at a time, and once none is left the array ends there.
template <class T, std::uint32_t Granule, int ChunkBits>
class RunArena {
public:
    static constexpr std::uint32_t kGranule = Granule;
    static constexpr int kChunkBits = ChunkBits;
    static constexpr std::uint64_t kMost = std::uint64_t{1} << 32;

    explicit RunArena(std::uint64_t maxCount = kMost) : elements_(maxCount), limit_(maxCount) {}

    /// Free runs that one thread has taken for itself, a few of each size it needs: the arena's own lists are in
    /// another thread's cache most of the time, and a look at them costs more than making a small run. Belongs to the
    /// arena until takeBack() or clear().
    class Ahead {
    public:
        void clear() {
            for (Sized& sized : bySize_)
                sized.count = 0;
        }

    private:
        friend RunArena;
        struct alignas(64) Sized {
            std::uint32_t count = 0;
            std::array<std::uint32_t, 15> begins;
        };
        std::vector<Sized> bySize_; ///< by granules
    };

    /// Gives `run` room for `count` elements; keeps it as it is where there is room already, and not more than twice as
    /// much. What the run held is lost. Throws std::bad_alloc.
    void resize(ArenaRun& run, std::uint32_t count) {
        if (isFit(run, count))
            return;
        const std::uint32_t wanted = wholeGranules(count);
        const std::lock_guard lock(mutex_); // once: several threads want it all the time
        giveBack(std::exchange(run, {}));
        if (wanted > 0)
            run = {allocate(wanted), wanted};
    }
    /// The same where several threads want runs all the time, each with its own `ahead`.
    void resize(ArenaRun& run, std::uint32_t count, Ahead& ahead) {
        if (isFit(run, count))
            return;
        const std::uint32_t granules = wholeGranules(count) / Granule;
        if (run.capacity > 0 || granules == 0 || granules >= kMostAhead)
            return resize(run, count);
        if (ahead.bySize_.empty())
            ahead.bySize_.resize(kMostAhead);
        typename Ahead::Sized& sized = ahead.bySize_[granules];
        if (sized.count == 0)
            take(granules, sized);
        run = {sized.begins[--sized.count], granules * Granule};
    }
    void takeBack(Ahead& ahead) {
        const std::lock_guard lock(mutex_);
        for (std::uint32_t granules = 0; granules < ahead.bySize_.size(); ++granules) {
            typename Ahead::Sized& sized = ahead.bySize_[granules];
            for (std::uint32_t k = 0; k < sized.count; ++k)
                giveBack({sized.begins[k], granules * Granule});
            sized.count = 0;
        }
    }
    void release(ArenaRun& run) {
        if (run.capacity == 0)
            return;
        const std::lock_guard lock(mutex_);
        giveBack(std::exchange(run, {}));
    }
    /// Of each of `owners` the run that is a member of it.
    template <class Owner>
    void releaseEach(std::span<const Owner> owners, ArenaRun Owner::*run) {
        const std::lock_guard lock(mutex_);
        for (const Owner& owner : owners)
            giveBack(owner.*run);
    }
    /// Begins to empty the array from where what is in use would fit below, with an eighth of that to spare, or a
    /// quarter or a half where less was too little the last times. Does nothing where it would end further up.
    /// REQUIRES: no thread has runs ahead.
    void evacuate() {
        const std::lock_guard lock(mutex_);
        const std::uint64_t from = used_ + (used_ >> (kLeastSpare - timesGivenUp_)) + kSparseSlack;
        if (isEvacuating() || from >= top_)
            return;
        std::vector<ArenaRun> all = std::move(freeLarge_);
        for (std::size_t granules = 0; granules < kMostSizes; ++granules)
            for (const std::uint32_t begin : freeBySize_[granules])
                all.push_back({begin, static_cast<std::uint32_t>(granules) * Granule});
        forgetFree();
        evacuatedFrom_ = from / Granule * Granule;
        usedAbove_ = top_ - evacuatedFrom_;
        for (const ArenaRun& run : all)
            freeOrSetAside(run);
    }
    bool isEvacuating() const { return evacuatedFrom_ != kNone; }
    /// Whether the run is one to be moved.
    bool reachesAbove(const ArenaRun& run) const {
        return run.capacity > 0 && std::uint64_t{run.begin} + run.capacity > evacuatedFrom_;
    }
    /// A run as large as `run` below; without room nothing, and the array is not emptied any more. REQUIRES: it is.
    std::optional<ArenaRun> takeBelow(const ArenaRun& run) {
        const std::lock_guard lock(mutex_);
        const std::optional<std::uint32_t> begin = takeListed(run.capacity, freedSinceJoined_ > 0);
        if (!begin) {
            giveUpEvacuation();
            timesGivenUp_ = std::min(timesGivenUp_ + 1, kMostGivenUp);
            return std::nullopt;
        }
        used_ += run.capacity;
        return ArenaRun{*begin, run.capacity};
    }
    /// Ends the array where nothing is left above, and gives the memory back; whether that was so. Other threads may
    /// read runs.
    bool finishEvacuation() {
        if (!isEvacuating() || usedAbove_ > 0)
            return false;
        top_ = std::exchange(evacuatedFrom_, kNone);
        setAside_.clear();
        timesGivenUp_ = 0;
        elements_.shrinkToPages(top_);
        return true;
    }

    /// Forgets all runs. Their memory is kept for others: to get it from the system again costs as much as filling it.
    void clear() {
        forgetFree();
        setAside_.clear();
        evacuatedFrom_ = kNone;
        timesGivenUp_ = 0;
        top_ = used_ = 0;
    }
    /// Gives memory back that lies above all runs.
    void trim() { elements_.shrink(top_); }

    T* at(std::uint32_t index) { return elements_.at(index); }
    const T* at(std::uint32_t index) const { return elements_.at(index); }
    /// One past the last element that belongs to a run or did so.
    std::uint64_t top() const { return top_; }
    /// Whether no more than `parts` in `of` of the elements below top() belong to a run.
    bool isSparse(std::uint64_t parts, std::uint64_t of) const { return parts * top_ > of * used_ + kSparseSlack; }

    std::uint64_t usedBytes() const { return used_ * sizeof(T); }
    std::uint64_t unusedBytes() const { return (top_ - used_) * sizeof(T); }

private:
    static constexpr std::uint64_t kChunk = ChunkedArray<T, ChunkBits>::kChunk;
    static_assert(kChunk % Granule == 0);

    static std::uint32_t wholeGranules(std::uint32_t count) { return (count + Granule - 1) / Granule * Granule; }
    static bool isFit(const ArenaRun& run, std::uint32_t count) {
        return count <= run.capacity && (count >= run.capacity / 2 || wholeGranules(count) == run.capacity);
    }

    // REQUIRES for this and what follows, but take(): the mutex is held.
    void giveBack(const ArenaRun& run) {
        if (run.capacity == 0)
            return;
        used_ -= run.capacity;
        freeOrSetAside(run);
    }
    // What lies above the place from which the array is emptied is not to be taken again.
    void freeOrSetAside(const ArenaRun& run) {
        const std::uint64_t end = std::uint64_t{run.begin} + run.capacity;
        if (end <= evacuatedFrom_)
            return free(run.begin, run.capacity);
        const auto first = static_cast<std::uint32_t>(std::max<std::uint64_t>(run.begin, evacuatedFrom_));
        const auto above = static_cast<std::uint32_t>(end - first);
        setAside_.push_back({first, above});
        usedAbove_ -= above;
        if (run.begin < first)
            free(run.begin, first - run.begin);
    }
    void giveUpEvacuation() {
        evacuatedFrom_ = kNone;
        for (const ArenaRun& run : setAside_)
            free(run.begin, run.capacity);
        setAside_.clear();
        freedSinceJoined_ = freeRuns_; // runs end where the array was cut
    }
    // Half of the runs of just that size at most: another thread wants such ones too.
    void take(std::uint32_t granules, typename Ahead::Sized& sized) {
        const std::uint32_t size = granules * Granule;
        const std::lock_guard lock(mutex_);
        const std::size_t free = freeBySize_[granules].size();
        const auto count = static_cast<std::uint32_t>(std::clamp<std::size_t>(free / 2, 1, sized.begins.size()));
        for (; sized.count < count; ++sized.count)
            sized.begins[sized.count] = allocate(size);
    }
    // `joins`: free runs, where none has room.
    std::optional<std::uint32_t> takeListed(std::uint32_t size, bool joins) {
        std::optional<std::uint32_t> begin = takeFree(size);
        if (!begin && joins) {
            joinFree();
            begin = takeFree(size);
        }
        return begin;
    }
    std::uint32_t allocate(std::uint32_t size) {
        std::optional<std::uint32_t> begin = takeListed(size, isWorthJoining());
        if (!begin && isEvacuating()) {
            giveUpEvacuation();
            begin = takeListed(size, isWorthJoining());
        }
        if (!begin) {
            const std::uint64_t grown = top_ + size + (kChunk - top_ % kChunk < size ? kChunk - top_ % kChunk : 0);
            if (grown > limit_)
                throw std::bad_alloc();
            elements_.grow(grown);
            if (const std::uint64_t first = grown - size; first > top_)
                free(static_cast<std::uint32_t>(top_), static_cast<std::uint32_t>(first - top_));
            begin = static_cast<std::uint32_t>(grown - size);
            top_ = grown;
        }
        used_ += size;
        return *begin;
    }
    /// A part of the smallest free run that has room; the rest of it stays free.
    std::optional<std::uint32_t> takeFree(std::uint32_t size) {
        const std::size_t granules = size / Granule;
        ArenaRun found;
        if (const std::size_t least = smallestFree(granules); least < kMostSizes) {
            std::vector<std::uint32_t>& runs = freeBySize_[least];
            found = {runs.back(), static_cast<std::uint32_t>(least) * Granule};
            runs.pop_back();
            if (runs.empty())
                hasFree_[least / 64] &= ~(std::uint64_t{1} << (least % 64));
        } else if (const auto large = std::find_if(freeLarge_.rbegin(), freeLarge_.rend(),
                                                   [&](const ArenaRun& run) { return run.capacity >= size; });
                   large != freeLarge_.rend()) {
            found = *large;
            *large = freeLarge_.back();
            freeLarge_.pop_back();
        } else {
            return std::nullopt;
        }
        --freeRuns_;
        if (found.capacity > size)
            free(found.begin + size, found.capacity - size);
        return found.begin;
    }
    void free(std::uint32_t begin, std::uint32_t size) {
        const std::size_t granules = size / Granule;
        if (granules < kMostSizes) {
            freeBySize_[granules].push_back(begin);
            hasFree_[granules / 64] |= std::uint64_t{1} << (granules % 64);
        } else {
            freeLarge_.push_back({begin, size});
        }
        ++freeRuns_;
        ++freedSinceJoined_;
    }
    /// The least size of a listed free run that is not below `granules`; kMostSizes without one.
    std::size_t smallestFree(std::size_t granules) const {
        const std::size_t first = granules / 64;
        for (std::size_t word = first; word < hasFree_.size(); ++word) {
            const std::uint64_t bits =
                hasFree_[word] & (word == first ? ~std::uint64_t{0} << (granules % 64) : ~std::uint64_t{0});
            if (bits != 0)
                return 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
        }
        return kMostSizes;
    }
    /// Where much of the array is free, and half of the free runs are new since the last time: so each run that is
    /// given back costs about as much again.
    bool isWorthJoining() const {
        return (top_ - used_) * kMuch > top_ + kSparseSlack && 2 * freedSinceJoined_ > freeRuns_;
    }
    /// Joins adjacent free runs, but not across chunks. O(free runs + array / 64 granules).
    void joinFree() {
        std::vector<std::uint64_t> isFree(top_ / Granule / 64 + 1, 0); // by granule
        const auto mark = [&](std::uint32_t begin, std::uint32_t size) {
            for (std::uint32_t at = begin / Granule, end = at + size / Granule; at != end;) {
                const std::uint32_t here = std::min(end - at, 64 - at % 64);
                isFree[at / 64] |= (~std::uint64_t{0} >> (64 - here)) << (at % 64);
                at += here;
            }
        };
        for (std::size_t granules = 0; granules < kMostSizes; ++granules)
            for (const std::uint32_t begin : freeBySize_[granules])
                mark(begin, static_cast<std::uint32_t>(granules) * Granule);
        for (const ArenaRun& run : freeLarge_)
            mark(run.begin, run.capacity);
        forgetFree();
        // From bit to bit at which it changes. Runs end where chunks do.
        const std::uint64_t end = top_ / Granule, chunk = kChunk / Granule;
        const auto next = [&](std::uint64_t at, bool isSet) { // the first that is set or not
            while (at < end) {
                const std::uint64_t word = (isSet ? isFree[at / 64] : ~isFree[at / 64]) >> (at % 64);
                if (word != 0)
                    return std::min(end, at + static_cast<std::uint64_t>(std::countr_zero(word)));
                at = (at / 64 + 1) * 64;
            }
            return end;
        };
        for (std::uint64_t at = next(0, true); at < end;) {
            const std::uint64_t stop = std::min(next(at, false), (at / chunk + 1) * chunk);
            free(static_cast<std::uint32_t>(at * Granule), static_cast<std::uint32_t>((stop - at) * Granule));
            at = next(stop, true);
        }
        freedSinceJoined_ = 0;
    }
    void forgetFree() {
        for (std::vector<std::uint32_t>& runs : freeBySize_)
            runs.clear();
        freeLarge_.clear();
        hasFree_.fill(0);
        freeRuns_ = freedSinceJoined_ = 0;
    }

    static constexpr int kLeastSpare = 3, kMostGivenUp = 2; ///< shifts
    static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    static constexpr std::size_t kMostSizes = 256; ///< granules of runs that are listed by size
    static constexpr std::uint64_t kMuch = 8; ///< one free element in so many
    static constexpr std::uint32_t kMostAhead = 128; ///< granules of a run; there are few larger ones
    static_assert(kMostAhead <= kMostSizes);
    static constexpr std::uint64_t kSparseSlack = 64 * std::uint64_t{Granule};

    ChunkedArray<T, ChunkBits> elements_;
    std::uint64_t limit_;
    std::uint64_t top_ = 0;
    std::uint64_t used_ = 0; ///< belong to a run
    SpinLock mutex_;
    std::array<std::vector<std::uint32_t>, kMostSizes> freeBySize_; ///< where they begin, by granules
    std::array<std::uint64_t, kMostSizes / 64> hasFree_{}; ///< a bit per size
    std::vector<ArenaRun> freeLarge_; ///< those that are larger
    std::uint64_t freeRuns_ = 0;
    std::uint64_t freedSinceJoined_ = 0; ///< runs
    std::uint64_t evacuatedFrom_ = kNone;
    std::uint64_t usedAbove_ = 0; ///< elements from there on that belong to a run
    std::vector<ArenaRun> setAside_; ///< free ones from there on
    int timesGivenUp_ = 0; ///< because a run found no room: the last times, up to kMostGivenUp
};

/// Of vertex codes and indices of triangles.
using ShortArena = RunArena<std::uint16_t, 32, 20>;

} // namespace isoslider::extract
