#include "core/base/machine.h"

#include <fstream>
#include <string>

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

namespace isoslider {

std::uint64_t physicalMemoryBytes() {
    return static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// Not getrusage: its ru_maxrss starts with the largest size of the program that started this one.
std::uint64_t peakRssBytes() {
    std::ifstream status("/proc/self/status");
    std::string word;
    while (status >> word) {
        if (word == "VmHWM:") {
            std::uint64_t kibibytes = 0;
            status >> kibibytes;
            return kibibytes * 1024;
        }
    }
    return 0;
}

// Not SCHED_IDLE: on a busy machine such a thread would not even come to its end.
void lowerThreadPriority() {
    constexpr int kLow = 10;
    if (threadNice() < kLow)
        setThreadNice(kLow);
}

// Of a thread on Linux.
int threadNice() { return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())); }
void setThreadNice(int nice) { static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), nice)); }

void returnLargeBlocksAtOnce() { ::mallopt(M_MMAP_THRESHOLD, 4 << 20); }

} // namespace isoslider
