#pragma once

#include <cstddef>
#include <span>

namespace isoslider::extract {

/// A block of address space of fixed size whose memory arrives page by page on first touch. It never
/// moves, so threads may write into their parts of it while others are handed new parts, and memory
/// in use follows the part that is used.
class VirtualMemory {
public:
    /// Large pages, where the system has such, hold two megabytes: of memory of which little is used they take most.
    static constexpr std::size_t kLargePage = std::size_t{1} << 21;

    /// From `largePagesFrom` on, a multiple of kLargePage, pages are large.
    explicit VirtualMemory(std::size_t bytes, std::size_t largePagesFrom = 0);
    ~VirtualMemory();
    VirtualMemory(const VirtualMemory&) = delete;
    VirtualMemory& operator=(const VirtualMemory&) = delete;

    std::byte* data() const { return data_; }
    /// Gives the memory from `fromBytes` on back to the system; it reads as zeros afterwards.
    void release(std::size_t fromBytes);

private:
    std::byte* data_ = nullptr;
    std::size_t bytes_ = 0;
};

/// Typed view of a VirtualMemory. Elements start as zero bytes; T must be trivial.
template <class T>
class VirtualArray {
public:
    explicit VirtualArray(std::size_t maxCount) : memory_(maxCount * sizeof(T)) {}
    T* data() { return reinterpret_cast<T*>(memory_.data()); }
    const T* data() const { return reinterpret_cast<const T*>(memory_.data()); }
    T& operator[](std::size_t i) { return data()[i]; }
    const T& operator[](std::size_t i) const { return data()[i]; }
    void release(std::size_t fromCount) { memory_.release(fromCount * sizeof(T)); }

private:
    VirtualMemory memory_;
};

} // namespace isoslider::extract
