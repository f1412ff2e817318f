#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

namespace isoslider::extract {

/// Hands out runs of elements of one array: each brick's part of E, V, N or I. Sizes are rounded up
/// to a granule, freed runs are kept by size and reused first, larger ones cut up. Safe from any thread;
/// O(sizes in use).
class RunAllocator {
public:
    explicit RunAllocator(std::uint32_t granule, std::uint64_t limit) : granule_(granule), limit_(limit) {}

    std::uint32_t roundUp(std::uint32_t count) const { return (count + granule_ - 1) / granule_ * granule_; }

    /// Start of a run of roundUp(count) elements. Throws std::bad_alloc past the limit.
    std::uint32_t allocate(std::uint32_t count);
    void free(std::uint32_t begin, std::uint32_t count);

    /// One past the last element ever handed out since clear().
    std::uint64_t top() const { return top_; }
    void clear();

private:
    std::uint32_t granule_;
    std::uint64_t limit_;
    std::uint64_t top_ = 0;
    std::mutex mutex_;
    std::vector<std::vector<std::uint32_t>> freeBySize_;
};

} // namespace isoslider::extract
