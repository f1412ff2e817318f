#include "app/cli/standard_streams.h"

#include <algorithm>
#include <cerrno>
#include <climits>

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/file_system.h"
#include "core/base/job_control.h"

namespace isoslider::cli {
namespace {

constexpr int kWaitMs = 50;

/// Returns once the descriptor can be read or written, or never will be: then the call itself states why.
Status waitFor(int descriptor, short event, const std::stop_token& stop) {
    for (;;) {
        if (stop.stop_requested())
            return cancelledError();
        pollfd end{descriptor, event, 0};
        if (::poll(&end, 1, kWaitMs) > 0)
            return {};
    }
}

} // namespace

bool isInputTerminal() { return ::isatty(STDIN_FILENO) == 1; }
bool isOutputTerminal() { return ::isatty(STDOUT_FILENO) == 1; }

std::optional<std::uint64_t> inputBytesLeft() {
    struct stat facts {};
    if (::fstat(STDIN_FILENO, &facts) != 0 || !S_ISREG(facts.st_mode))
        return std::nullopt;
    const off_t at = ::lseek(STDIN_FILENO, 0, SEEK_CUR);
    return static_cast<std::uint64_t>(std::max<off_t>(0, facts.st_size - std::max<off_t>(0, at)));
}

Result<std::size_t> readInput(std::span<std::byte> out, const std::stop_token& stop) {
    std::size_t done = 0;
    while (done < out.size()) {
        ISO_TRY(waitFor(STDIN_FILENO, POLLIN, stop));
        const ssize_t got = ::read(STDIN_FILENO, out.data() + done, out.size() - done);
        if (got < 0 && (errno == EINTR || errno == EAGAIN))
            continue;
        if (got < 0)
            return systemError(errno, "cannot read", "standard input");
        if (got == 0)
            break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

// No more than a pipe that is ready is sure to take: a longer write would wait for its reader, deaf to a stop.
Status writeOutput(std::span<const std::byte> bytes, const std::stop_token& stop) {
    while (!bytes.empty()) {
        ISO_TRY(waitFor(STDOUT_FILENO, POLLOUT, stop));
        const ssize_t written =
            ::write(STDOUT_FILENO, bytes.data(), std::min(bytes.size(), static_cast<std::size_t>(PIPE_BUF)));
        if (written < 0 && (errno == EINTR || errno == EAGAIN))
            continue;
        if (written < 0 && errno == EPIPE)
            return makeError(ErrorCode::IoError, "was closed before all was written", "standard output");
        if (written < 0)
            return systemError(errno, "cannot write", "standard output");
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return {};
}

} // namespace isoslider::cli
