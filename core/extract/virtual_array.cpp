#include "core/extract/virtual_array.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <new>

namespace isoslider::extract {
namespace {

constexpr std::size_t kLargePage = std::size_t{1} << 21;

} // namespace

VirtualMemory::VirtualMemory(std::size_t bytes) : bytes_(bytes) {
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
    madvise(data_, bytes, MADV_HUGEPAGE);
}

VirtualMemory::~VirtualMemory() { munmap(data_, bytes_); }

void VirtualMemory::release(std::size_t fromBytes) {
    const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t from = (fromBytes + page - 1) / page * page;
    if (from < bytes_)
        madvise(data_ + from, bytes_ - from, MADV_DONTNEED);
}

} // namespace isoslider::extract
