#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isoslider::test {

/// How a program ended and what it said.
struct ProcessResult {
    int exitCode = -1; ///< -1 when a signal ended it
    int signal = 0; ///< the signal that ended it, or 0
    bool hasTimedOut = false; ///< it was killed when its time was up
    std::string standardOutput;
    std::string standardError;
    std::chrono::milliseconds elapsed{0};
    std::chrono::milliseconds processorTime{0}; ///< of the program and the processes it waited for
    std::chrono::milliseconds processorTimeAtSignal{0}; ///< of the program alone, when the signal was sent
    std::uint64_t peakRssBytes = 0; ///< of the largest of these
};

struct ProcessOptions {
    std::vector<std::pair<std::string, std::string>> environment; ///< added to the test's own
    std::filesystem::path workingFolder; ///< empty: the test's own
    std::chrono::milliseconds timeout{20000};
    std::filesystem::path standardInputFile; ///< read from there; empty: nothing to read
    bool closesStandardOutput = false; ///< close the reading end before the program writes (EPIPE)
    std::filesystem::path standardOutputFile; ///< write there instead of capturing, e.g. /dev/full
    std::vector<int> ignoredSignals; ///< ignored when the program starts, as nohup does
    int signalToSend = 0; ///< sent once, after `signalWhen` has become true
    std::function<bool()> signalWhen; ///< polled each millisecond; empty: at once
    /// With SIGSTOP: called while the program stands still, which goes on afterwards. Not called when it ended before.
    std::function<void()> whileStopped;
    std::chrono::milliseconds signalAtProcessorTime{0}; ///< what the program must have used before it is sent
    std::uint64_t addressSpaceBytes = 0; ///< RLIMIT_AS, 0 for none
    unsigned userId = 0; ///< whom it runs as where the test runs as root; 0: as the test
};

/// Runs `program` with `arguments`, no shell between, and waits for its end.
ProcessResult runProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const ProcessOptions& options = {});

} // namespace isoslider::test
