#include "app/cli/peak_rss.h"

#include <fstream>
#include <string>

namespace isoslider::cli {

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

} // namespace isoslider::cli
