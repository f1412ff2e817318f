#include "core/extract/virtual_array.h"

#include <sys/mman.h>
#include <unistd.h>

#include <new>

namespace isoslider::extract {

VirtualMemory::VirtualMemory(std::size_t bytes) : bytes_(bytes) {
    void* address = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (address == MAP_FAILED)
        throw std::bad_alloc();
    data_ = static_cast<std::byte*>(address);
    // Bricks are visited all over the arrays: with small pages most visits miss the TLB too.
    madvise(address, bytes, MADV_HUGEPAGE);
}

VirtualMemory::~VirtualMemory() { munmap(data_, bytes_); }

void VirtualMemory::release(std::size_t fromBytes) {
    const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t from = (fromBytes + page - 1) / page * page;
    if (from < bytes_)
        madvise(data_ + from, bytes_ - from, MADV_DONTNEED);
}

} // namespace isoslider::extract
