#pragma once

namespace isoslider {

/// Prints the failed condition with its place and aborts.
[[noreturn]] void checkFailed(const char* condition, const char* file, int line);

} // namespace isoslider

/// A programmer error, checked in release builds too. No user input or file byte may reach one.
#define ISO_CHECK(condition) \
    do { \
        if (!(condition)) [[unlikely]] \
            ::isoslider::checkFailed(#condition, __FILE__, __LINE__); \
    } while (false)
