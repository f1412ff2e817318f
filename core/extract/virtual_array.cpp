#include "core/extract/virtual_array.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <new>

namespace isoslider::extract {

VirtualMemory::VirtualMemory(std::size_t bytes, std::size_t largePagesFrom) : bytes_(bytes) {
    // Bricks are visited all over the arrays: with small pages most visits miss the TLB too. A large page wants to
    // begin at a multiple of its size, so as much more is asked for, and what is not needed given back.
    const std::size_t spare = bytes >= kLargePage ? kLargePage : 0;
    void* const address =
        mmap(nullptr, bytes + spare, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (address == MAP_FAILED)
        throw std::bad_alloc();
    data_ = static_cast<std::byte*>(address);
    if (spare > 0) {
        const std::size_t before = (kLargePage - reinterpret_cast<std::uintptr_t>(address) % kLargePage) % kLargePage;
        const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
        const std::size_t end = (before + bytes + page - 1) / page * page;
        if (before > 0)
            munmap(data_, before);
        if (end < bytes + spare)
            munmap(data_ + end, bytes + spare - end);
        data_ += before;
    }
    const std::size_t small = std::min(bytes, largePagesFrom);
    if (small > 0)
        madvise(data_, small, MADV_NOHUGEPAGE);
    if (small < bytes)
        madvise(data_ + small, bytes - small, MADV_HUGEPAGE);
}

VirtualMemory::~VirtualMemory() { munmap(data_, bytes_); }

void VirtualMemory::release(std::size_t fromBytes) {
    const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t from = (fromBytes + page - 1) / page * page;
    if (from < bytes_)
        madvise(data_ + from, bytes_ - from, MADV_DONTNEED);
}

} // namespace isoslider::extract
