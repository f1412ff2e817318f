#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>

namespace isoslider::io {

/// How long a reader may do nothing at all: a minute, or what ISOSLIDER_READER_SILENCE states in seconds.
std::chrono::milliseconds readerSilence();

/// Notices that a process has hung: it neither uses the processor, nor reads, nor waits for a disk. A process that
/// computes for hours, or reads slowly, is never taken for one.
class ActivityWatch {
public:
    explicit ActivityWatch(pid_t process) : process_(process) {}

    /// To be called again and again while the process is waited for. True once it has done nothing for `limit`. Time in
    /// which this was not called, as while the program itself was stopped, does not count.
    bool hasHung(std::chrono::milliseconds limit);
    /// The process has been heard of.
    void restart() { idle_ = {}; }

private:
    using Clock = std::chrono::steady_clock;
    bool hasActed();

    pid_t process_;
    std::uint64_t lastActivity_ = 0;
    Clock::time_point lastCall_ = Clock::now();
    Clock::duration idle_{};
    Clock::duration sinceLook_{};
};

} // namespace isoslider::io
