#include "core/extract/run_allocator.h"

#include <new>

namespace isoslider::extract {

std::uint32_t RunAllocator::allocate(std::uint32_t count) {
    const std::uint32_t size = roundUp(count);
    const std::size_t granules = size / granule_;
    const std::lock_guard lock(mutex_);
    for (std::size_t found = granules; found < freeBySize_.size(); ++found) {
        if (freeBySize_[found].empty())
            continue;
        const std::uint32_t begin = freeBySize_[found].back();
        freeBySize_[found].pop_back();
        if (found > granules) // the rest stays free
            freeBySize_[found - granules].push_back(begin + size);
        return begin;
    }
    if (top_ + size > limit_)
        throw std::bad_alloc();
    const std::uint32_t begin = static_cast<std::uint32_t>(top_);
    top_ += size;
    return begin;
}

void RunAllocator::free(std::uint32_t begin, std::uint32_t count) {
    const std::size_t granules = roundUp(count) / granule_;
    if (granules == 0)
        return;
    const std::lock_guard lock(mutex_);
    if (granules >= freeBySize_.size())
        freeBySize_.resize(granules + 1);
    freeBySize_[granules].push_back(begin);
}

void RunAllocator::clear() {
    const std::lock_guard lock(mutex_);
    top_ = 0;
    freeBySize_.clear();
}

} // namespace isoslider::extract
