#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <mutex>
#include <new>
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
/// chunk of the array, and are reused by size. Safe from any thread.
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
    /// A run of the same size as `run`, of another arena. Throws std::bad_alloc.
    ArenaRun alike(const ArenaRun& run) {
        const std::lock_guard lock(mutex_);
        return run.capacity > 0 ? ArenaRun{allocate(run.capacity), run.capacity} : ArenaRun{};
    }
    /// Forgets all runs. Their memory is kept for others: to get it from the system again costs as much as filling it.
    void clear() {
        freeBySize_.clear();
        hasFree_.clear();
        top_ = used_ = 0;
    }
    /// Gives memory back that lies above all runs.
    void trim() { elements_.shrink(top_); }

    T* at(std::uint32_t index) { return elements_.at(index); }
    const T* at(std::uint32_t index) const { return elements_.at(index); }
    /// One past the last element that belongs to a run or did so.
    std::uint64_t top() const { return top_; }
    /// Whether no more than one in `share` of the elements up to top() belongs to a run.
    bool isSparse(std::uint64_t share) const { return top_ > share * used_ + kSparseSlack; }

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
        free(run.begin, run.capacity);
    }
    // Half of the runs of just that size at most: another thread wants such ones too.
    void take(std::uint32_t granules, typename Ahead::Sized& sized) {
        const std::uint32_t size = granules * Granule;
        const std::lock_guard lock(mutex_);
        const std::size_t free = granules < freeBySize_.size() ? freeBySize_[granules].size() : 0;
        const auto count = static_cast<std::uint32_t>(std::clamp<std::size_t>(free / 2, 1, sized.begins.size()));
        for (; sized.count < count; ++sized.count)
            sized.begins[sized.count] = allocate(size);
    }
    std::uint32_t allocate(std::uint32_t size) {
        const std::size_t granules = size / Granule;
        // A little larger is as good; the rest stays free.
        if (const std::size_t found = smallestFree(granules); found - granules <= kFit) {
            const std::uint32_t begin = freeBySize_[found].back();
            freeBySize_[found].pop_back();
            if (freeBySize_[found].empty())
                hasFree_[found / 64] &= ~(std::uint64_t{1} << (found % 64));
            if (found > granules)
                free(begin + size, static_cast<std::uint32_t>(found - granules) * Granule);
            used_ += size;
            return begin;
        }
        const std::uint64_t room = kChunk - top_ % kChunk;
        if (room < size) {
            free(static_cast<std::uint32_t>(top_), static_cast<std::uint32_t>(room));
            top_ += room;
        }
        if (top_ + size > limit_)
            throw std::bad_alloc();
        elements_.grow(top_ + size);
        const auto begin = static_cast<std::uint32_t>(top_);
        top_ += size;
        used_ += size;
        return begin;
    }
    void free(std::uint32_t begin, std::uint32_t size) {
        const std::size_t granules = size / Granule;
        if (granules >= freeBySize_.size()) {
            freeBySize_.resize(granules + 1);
            hasFree_.resize(granules / 64 + 1, 0);
        }
        freeBySize_[granules].push_back(begin);
        hasFree_[granules / 64] |= std::uint64_t{1} << (granules % 64);
    }
    /// The least size of a free run that is not below `granules`; a very large number without one near it.
    std::size_t smallestFree(std::size_t granules) const {
        const std::size_t first = granules / 64;
        for (std::size_t word = first; word < hasFree_.size() && word <= first + 1; ++word) {
            const std::uint64_t bits =
                hasFree_[word] & (word == first ? ~std::uint64_t{0} << (granules % 64) : ~std::uint64_t{0});
            if (bits != 0)
                return 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
        }
        return ~std::size_t{0};
    }

    static constexpr std::size_t kFit = 64;
    static constexpr std::uint32_t kMostAhead = 128; ///< granules of a run; there are few larger ones
    static constexpr std::uint64_t kSparseSlack = 64 * std::uint64_t{Granule};

    ChunkedArray<T, ChunkBits> elements_;
    std::uint64_t limit_;
    std::uint64_t top_ = 0;
    std::uint64_t used_ = 0; ///< belong to a run
    SpinLock mutex_;
    std::vector<std::vector<std::uint32_t>> freeBySize_;
    std::vector<std::uint64_t> hasFree_; ///< a bit per size
};

/// Of vertex codes and indices of triangles.
using ShortArena = RunArena<std::uint16_t, 32, 20>;

} // namespace isoslider::extract
