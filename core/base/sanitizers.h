#pragma once

// ISO_HAS_SANITIZER: 1 in a build with the address or the thread sanitizer, which GCC and Clang tell in their own ways.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ISO_HAS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ISO_HAS_SANITIZER 1
#endif
#endif
#ifndef ISO_HAS_SANITIZER
#define ISO_HAS_SANITIZER 0
#endif
