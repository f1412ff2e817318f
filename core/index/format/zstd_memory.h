#pragma once

#include <cstddef>
#include <new>

#include <zstd.h>
#include <zstd_errors.h>

namespace isoslider::index {

/// zstd reports missing memory by its return values; the program expects std::bad_alloc. Other results, also other
/// errors, pass.
inline std::size_t orOutOfMemory(std::size_t result) {
    if (ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation)
        throw std::bad_alloc();
    return result;
}
template <class Context>
Context* orOutOfMemory(Context* context) {
    if (context == nullptr)
        throw std::bad_alloc();
    return context;
}

} // namespace isoslider::index
