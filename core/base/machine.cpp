#include "core/base/machine.h"

#include <unistd.h>

namespace isoslider {

std::uint64_t physicalMemoryBytes() {
    return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

} // namespace isoslider
