#pragma once

#include <cstdlib>

namespace isoslider::test {

/// How often a test repeats itself: the number in the environment variable `name`, else `otherwise`
/// (packaging/ci/endurance.sh sets them).
inline long repetitions(const char* name, long otherwise) {
    const char* text = std::getenv(name);
    const long count = text != nullptr ? std::atol(text) : 0;
    return count > 0 ? count : otherwise;
}

} // namespace isoslider::test
