#include "tests/support/process_runner.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <stdexcept>

#include <fcntl.h>
#include <grp.h>
#include <malloc.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace isoslider::test {
namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
    int readEnd = -1;
    int writeEnd = -1;

    Pipe() {
        std::array<int, 2> ends{};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0)
            throw std::runtime_error("pipe failed");
        readEnd = ends[0];
        writeEnd = ends[1];
    }
    ~Pipe() {
        closeReadEnd();
        closeWriteEnd();
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    void closeReadEnd() { closeEnd(readEnd); }
    void closeWriteEnd() { closeEnd(writeEnd); }

private:
    static void closeEnd(int& end) {
        if (end >= 0)
            ::close(end);
        end = -1;
    }
};

void applyLimits(const ProcessOptions& options) {
    if (options.addressSpaceBytes > 0) {
        const rlimit limit{options.addressSpaceBytes, options.addressSpaceBytes};
        ::setrlimit(RLIMIT_AS, &limit);
    }
    if (options.userId != 0 && ::geteuid() == 0 &&
        (::setgroups(0, nullptr) != 0 || ::setgid(options.userId) != 0 || ::setuid(options.userId) != 0))
        ::_exit(126);
    const rlimit noCore{0, 0};
    ::setrlimit(RLIMIT_CORE, &noCore);
    // GoogleTest runs under ctest, which may have blocked or ignored these.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE})
        ::signal(signal, SIG_DFL);
    for (const int signal : options.ignoredSignals)
        ::signal(signal, SIG_IGN);
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void becomeProgram(const std::filesystem::path& program, std::vector<char*>& arguments,
                                const ProcessOptions& options, const Pipe& out, const Pipe& err) {
    const char* input = options.standardInputFile.empty() ? "/dev/null" : options.standardInputFile.c_str();
    const int inFile = ::open(input, O_RDONLY);
    ::dup2(inFile, STDIN_FILENO);
    const int outFile = options.standardOutputFile.empty()
                            ? out.writeEnd
                            : ::open(options.standardOutputFile.c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(outFile, STDOUT_FILENO);
    ::dup2(err.writeEnd, STDERR_FILENO);
    if (!options.workingFolder.empty() && ::chdir(options.workingFolder.c_str()) != 0)
        ::_exit(126);
    for (const auto& [name, value] : options.environment)
        ::setenv(name.c_str(), value.c_str(), 1);
    applyLimits(options);
    ::close_range(3, ~0U, 0); // what whoever runs the tests has left open counts towards limits
    ::execv(program.c_str(), arguments.data());
    ::_exit(127);
}

/// Reads what is there; closes the pipe at its end.
void drain(Pipe& pipe, std::string& text) {
    std::array<char, 65536> buffer;
    const ssize_t count = ::read(pipe.readEnd, buffer.data(), buffer.size());
    if (count > 0)
        text.append(buffer.data(), static_cast<std::size_t>(count));
    else if (count == 0 || errno != EINTR)
        pipe.closeReadEnd();
}

class Watch {
public:
    Watch(pid_t child, const ProcessOptions& options) : child_(child), options_(options) {}

    /// Sends the asked-for signal when its moment has come, and kills when the time is up.
    void tick(ProcessResult& result) {
        if (options_.signalToSend != 0 && !hasSent_ && isTimeToSend()) {
            result.processorTimeAtSignal = processorTime();
            ::kill(child_, options_.signalToSend);
            hasSent_ = true;
            if (options_.whileStopped)
                callWhileStopped();
        }
        if (!result.hasTimedOut && Clock::now() - start_ > options_.timeout) {
            result.hasTimedOut = true;
            ::kill(child_, SIGKILL);
        }
    }
    std::chrono::milliseconds elapsed() const {
        return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start_);
    }

private:
    void callWhileStopped() const {
        siginfo_t state{};
        const auto pid = static_cast<id_t>(child_);
        while (::waitid(P_PID, pid, &state, WSTOPPED | WEXITED | WNOWAIT) != 0 && errno == EINTR) {}
        if (state.si_code != CLD_STOPPED)
            return; // it has ended
        options_.whileStopped();
        ::kill(child_, SIGCONT);
    }
    bool isTimeToSend() const {
        return (!options_.signalWhen || options_.signalWhen()) &&
               (options_.signalAtProcessorTime.count() == 0 || processorTime() >= options_.signalAtProcessorTime);
    }
    std::chrono::milliseconds processorTime() const {
        clockid_t clock;
        timespec used{};
        if (::clock_getcpuclockid(child_, &clock) == 0 && ::clock_gettime(clock, &used) == 0)
            return std::chrono::milliseconds(used.tv_sec * 1000 + used.tv_nsec / 1'000'000);
        return {};
    }

    pid_t child_;
    const ProcessOptions& options_;
    Clock::time_point start_ = Clock::now();
    bool hasSent_ = false;
};

void collect(pid_t child, const ProcessOptions& options, Pipe& out, Pipe& err, ProcessResult& result) {
    Watch watch(child, options);
    const int pollMs = options.signalToSend != 0 ? 1 : 20;
    int status = 0;
    rusage used{};
    bool hasEnded = false;
    while (!hasEnded || out.readEnd >= 0 || err.readEnd >= 0) {
        std::array<pollfd, 2> ends{pollfd{out.readEnd, POLLIN, 0}, pollfd{err.readEnd, POLLIN, 0}};
        ::poll(ends.data(), ends.size(), pollMs);
        if (ends[0].revents != 0)
            drain(out, result.standardOutput);
        if (ends[1].revents != 0)
            drain(err, result.standardError);
        if (!hasEnded && ::wait4(child, &status, WNOHANG, &used) == child) {
            hasEnded = true;
            result.elapsed = watch.elapsed();
        }
        if (!hasEnded)
            watch.tick(result);
    }
    const auto inMs = [](const timeval& time) {
        return std::chrono::milliseconds(time.tv_sec * 1000 + time.tv_usec / 1000);
    };
    result.processorTime = inMs(used.ru_utime) + inMs(used.ru_stime);
    result.peakRssBytes = static_cast<std::uint64_t>(used.ru_maxrss) * 1024; // which Linux counts in KiB
    if (WIFEXITED(status))
        result.exitCode = WEXITSTATUS(status);
    else if (WIFSIGNALED(status))
        result.signal = WTERMSIG(status);
}

} // namespace

ProcessResult runProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const ProcessOptions& options) {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (auto& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);

    Pipe out;
    Pipe err;
    if (options.closesStandardOutput)
        out.closeReadEnd();
    ::malloc_trim(0); // a child's peak begins with what its parent holds
    const pid_t child = ::fork();
    if (child < 0)
        throw std::runtime_error("fork failed");
    if (child == 0)
        becomeProgram(program, pointers, options, out, err);
    out.closeWriteEnd();
    err.closeWriteEnd();
    ProcessResult result;
    collect(child, options, out, err, result);
    return result;
}

} // namespace isoslider::test
