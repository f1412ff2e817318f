#include "core/base/process_memory.h"

#include <fstream>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

namespace isoslider {

std::uint64_t residentBytes() {
    std::ifstream counts("/proc/self/statm");
    std::uint64_t all = 0, resident = 0;
    counts >> all >> resident;
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::uint64_t peakRssOfHelpersBytes() {
    rusage used{};
    return ::getrusage(RUSAGE_CHILDREN, &used) == 0 ? static_cast<std::uint64_t>(used.ru_maxrss) * 1024 : 0;
}

void returnFreeBlocks() { ::malloc_trim(0); }

} // namespace isoslider
