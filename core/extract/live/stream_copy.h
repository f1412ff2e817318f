#pragma once

#include <cstddef>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace isoslider::extract {

/// Copies into memory that will not be read soon, without fetching it first. Copies whole lines of 64 bytes: both sides
/// must have room for them. REQUIRES: `to` is aligned to 64 bytes. Other threads see it after finishStreams().
inline void streamCopy(void* to, const void* from, std::size_t bytes) {
#if defined(__SSE2__)
    auto* out = static_cast<__m128i*>(to);
    const auto* in = static_cast<const __m128i*>(from);
    for (std::size_t line = 0; line < bytes; line += 64, out += 4, in += 4)
        for (int k = 0; k < 4; ++k)
            _mm_stream_si128(out + k, _mm_loadu_si128(in + k));
#else
    std::memcpy(to, from, bytes);
#endif
}

inline void finishStreams() {
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

} // namespace isoslider::extract
