#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

#include "core/extract/virtual_array.h"

namespace isoslider::extract {

/// An array that grows by chunks of 2^ChunkBits elements, which never move: memory follows what is used, nothing is
/// reserved for what might be. New chunks are zero bytes; T must be trivial. grow() may run beside readers and
/// writers of other elements.
template <class T, int ChunkBits>
class ChunkedArray {
public:
    static constexpr std::size_t kChunk = std::size_t{1} << ChunkBits;

    /// At most `maxCount` elements; the table of chunks is made for as many, and takes memory where it is used. Throws
    /// std::bad_alloc.
    explicit ChunkedArray(std::uint64_t maxCount)
        : tableSize_(static_cast<std::size_t>(maxCount >> ChunkBits) + 1),
          chunks_(static_cast<T**>(std::calloc(tableSize_, sizeof(T*)))) {
        if (chunks_ == nullptr)
            throw std::bad_alloc();
    }

    /// Makes the elements below `count` usable. Throws std::bad_alloc.
    void grow(std::uint64_t count) {
        if (count <= usable_.load(std::memory_order_acquire))
            return;
        const std::lock_guard lock(mutex_);
        while (usable_.load(std::memory_order_relaxed) < count) {
            const std::size_t chunk = owned_.size();
            if (chunk >= tableSize_)
                throw std::bad_alloc();
            // Many arrays hold next to nothing.
            owned_.push_back(
                std::make_unique<VirtualMemory>(kChunk * sizeof(T), chunk == 0 ? VirtualMemory::kLargePage : 0));
            entry(chunk).store(reinterpret_cast<T*>(owned_.back()->data()), std::memory_order_release);
            usable_.store((chunk + 1) * kChunk, std::memory_order_release);
        }
    }
    /// REQUIRES: below grow()'s count, and a run from there stays inside the chunk.
    T* at(std::uint64_t index) {
        return entry(index >> ChunkBits).load(std::memory_order_acquire) + (index & (kChunk - 1));
    }
    const T* at(std::uint64_t index) const {
        return entry(index >> ChunkBits).load(std::memory_order_acquire) + (index & (kChunk - 1));
    }
    T& operator[](std::uint64_t index) { return *at(index); }
    const T& operator[](std::uint64_t index) const { return *at(index); }

    /// Gives chunks back that elements below `count` do not need; the others are kept, and other threads may read them.
    void shrink(std::uint64_t count) {
        const std::size_t needed = static_cast<std::size_t>((count + kChunk - 1) >> ChunkBits);
        if (needed >= owned_.size())
            return;
        usable_.store(needed * kChunk, std::memory_order_relaxed);
        for (std::size_t chunk = needed; chunk < owned_.size(); ++chunk)
            entry(chunk).store(nullptr, std::memory_order_relaxed);
        owned_.resize(needed);
    }
    /// The same, and of the last chunk what lies behind them: pages that hold zero bytes when they are used again.
    void shrinkToPages(std::uint64_t count) {
        shrink(count);
        if (const std::uint64_t rest = count % kChunk; rest > 0 && count < usable_.load(std::memory_order_relaxed))
            owned_[count / kChunk]->release(rest * sizeof(T));
    }

private:
    struct Free {
        void operator()(T** table) const { std::free(table); }
    };
    std::atomic_ref<T*> entry(std::uint64_t chunk) const { return std::atomic_ref<T*>(chunks_.get()[chunk]); }

    std::size_t tableSize_;
    std::unique_ptr<T*, Free> chunks_; ///< zero bytes from the system, most of which nobody ever touches
    std::atomic<std::uint64_t> usable_{0};
    std::mutex mutex_;
    std::vector<std::unique_ptr<VirtualMemory>> owned_;
};

} // namespace isoslider::extract
