#include "core/volume_io/reader_process/activity_watch.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {

std::chrono::milliseconds readerSilence() {
    constexpr std::chrono::milliseconds kUsual{60'000};
    const char* given = std::getenv("ISOSLIDER_READER_SILENCE");
    const auto seconds = given != nullptr ? parseReal(given) : std::nullopt;
    if (!seconds || !(*seconds > 0.0) || *seconds > 1e6)
        return kUsual;
    return std::chrono::milliseconds(static_cast<std::int64_t>(*seconds * 1000.0));
}

bool ActivityWatch::hasHung(std::chrono::milliseconds limit) {
    constexpr std::chrono::milliseconds kLongestStep{250}, kBetweenLooks{200};
    const auto now = Clock::now();
    const auto step = std::min<Clock::duration>(now - lastCall_, kLongestStep);
    lastCall_ = now;
    idle_ += step;
    sinceLook_ += step;
    if (sinceLook_ >= kBetweenLooks) {
        sinceLook_ = {};
        if (hasActed())
            idle_ = {};
    }
    return idle_ >= limit;
}

// A process that cannot be looked at has ended, or counts as one that does nothing.
bool ActivityWatch::hasActed() {
    const std::string folder = "/proc/" + std::to_string(process_) + "/";
    std::string line;
    std::getline(std::ifstream(folder + "stat"), line);
    std::istringstream fields(line.substr(std::min(line.rfind(')') + 1, line.size()))); // its name may hold blanks
    std::string state;
    fields >> state;
    constexpr int kFirst = 4, kMajorFaults = 12, kUserTime = 14, kSystemTime = 15; // as numbered in proc(5)
    std::uint64_t activity = 0;
    for (int field = kFirst; field <= kSystemTime; ++field) {
        std::int64_t value = 0;
        fields >> value;
        if (field == kMajorFaults || field == kUserTime || field == kSystemTime)
            activity += static_cast<std::uint64_t>(value);
    }
    std::ifstream io(folder + "io");
    std::string name;
    std::uint64_t bytes = 0;
    if (io >> name >> bytes) // rchar
        activity += bytes;
    const bool waitsForDisk = state == "D";
    return std::exchange(lastActivity_, activity) != activity || waitsForDisk;
}

} // namespace isoslider::io
