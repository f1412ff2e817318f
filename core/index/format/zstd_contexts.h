#pragma once

#include <cstddef>
#include <memory>
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

/// What zstd works with, made once for each thread by whoever keeps it. Errors: std::bad_alloc.
struct ZstdContexts {
    std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> compress{orOutOfMemory(ZSTD_createCCtx()), &ZSTD_freeCCtx};
    std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> decompress{orOutOfMemory(ZSTD_createDCtx()), &ZSTD_freeDCtx};
};

} // namespace isoslider::index
