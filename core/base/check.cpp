#include "core/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace isoslider {

void checkFailed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "isoslider: internal error: %s at %s:%d\n", condition, file, line);
    std::abort();
}

} // namespace isoslider
