#include "core/volume_io/reader_process/reader_client.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <thread>

#include "core/base/folders.h"
#include "core/base/sanitizers.h"
#include "core/volume_io/reader_process/activity_watch.h"
#include "core/volume_io/reader_process/message_channel.h"
#include "core/volume_io/reader_process/messages.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kProgram = "isoslider-reader";

Result<fs::path> findReaderProgram() {
    if (const char* given = std::getenv("ISOSLIDER_READER"); given != nullptr && *given != '\0')
        return fs::path(given);
    const fs::path folder = programFolder();
    for (const fs::path& candidate : {folder / kProgram, folder / "../libexec/isoslider" / kProgram})
        if (isPresent(candidate))
            return candidate;
    return makeError(ErrorCode::IoError,
                     std::string(kProgram) + ", which reads this format, is not installed beside the program");
}

class FileActions {
public:
    FileActions() { ::posix_spawn_file_actions_init(&actions_); }
    ~FileActions() { ::posix_spawn_file_actions_destroy(&actions_); }
    FileActions(const FileActions&) = delete;
    FileActions& operator=(const FileActions&) = delete;
    posix_spawn_file_actions_t* get() { return &actions_; }

private:
    posix_spawn_file_actions_t actions_;
};

// A running reader; ends with this.
class ReaderProcess {
public:
    static Result<std::unique_ptr<ReaderProcess>> start(const fs::path& volume) {
        const auto program = findReaderProgram();
        if (!program.isOk())
            return program.error();
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
            return makeError(ErrorCode::IoError, std::string("cannot start the reader: ") + std::strerror(errno));
        auto channel = std::make_unique<MessageChannel>(ends[0]);
        FileActions actions;
        ::posix_spawn_file_actions_adddup2(actions.get(), ends[1], STDIN_FILENO);
        ::posix_spawn_file_actions_addopen(actions.get(), STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
#if !ISO_HAS_SANITIZER // whose reports are wanted
        ::posix_spawn_file_actions_addopen(actions.get(), STDERR_FILENO, "/dev/null", O_WRONLY, 0);
#endif
        std::string name = program.value().string();
        char* const arguments[] = {name.data(), nullptr};
        pid_t process = -1;
        const int problem = ::posix_spawn(&process, name.c_str(), actions.get(), nullptr, arguments, environ);
        ::close(ends[1]);
        if (problem != 0)
            return makeError(ErrorCode::IoError, "cannot start " + name + ": " + std::strerror(problem));
        return std::unique_ptr<ReaderProcess>(new ReaderProcess(volume, process, std::move(channel)));
    }

    ~ReaderProcess() { (void)end(); }
    ReaderProcess(const ReaderProcess&) = delete;
    ReaderProcess& operator=(const ReaderProcess&) = delete;

    /// The answer of that kind. Whatever fails but what the reader itself reports ends the process.
    Result<std::vector<std::byte>> ask(const ReaderRequest& request, ReplyKind expected, const JobControl& job = {}) {
        if (process_ < 0)
            return makeError(ErrorCode::IoError, "the reader of this file has ended", volume_);
        if (!channel_->send(encodeRequest(request)).isOk())
            return deathOf();
        for (;;) {
            auto reply = channel_->receive([&] { return waitForInput(job); });
            if (!reply.isOk())
                return process_ < 0 ? reply.error() : deathOf();
            const auto kind = replyKind(reply.value());
            if (kind == expected)
                return reply;
            if (kind == ReplyKind::Failed) {
                auto error = decodeError(reply.value());
                return error ? *error : invalidReply();
            }
            const auto progress = kind == ReplyKind::Progress ? decodeProgress(reply.value()) : std::nullopt;
            if (!progress)
                return invalidReply();
            job.report(progress->fraction, progress->stage);
        }
    }

    Status takeBytes(std::span<std::byte> out, const JobControl& job) {
        const Status taken = channel_->receiveBytes(out, [&] { return waitForInput(job); });
        return taken.isOk() || process_ < 0 ? taken : deathOf();
    }

    Error invalidReply() {
        (void)end();
        return makeError(ErrorCode::Corruption, "made its reader send an invalid reply: the file is damaged", volume_);
    }

private:
    ReaderProcess(fs::path volume, pid_t process, std::unique_ptr<MessageChannel> channel)
        : volume_(std::move(volume)), process_(process), channel_(std::move(channel)), watch_(process) {}

    // Until something can be received. If that is not to be, ends the process.
    Status waitForInput(const JobControl& job) {
        constexpr int kStopEveryMs = 50;
        watch_.restart();
        while (!channel_->waitForInput(kStopEveryMs)) {
            if (job.isStopRequested()) {
                (void)end();
                return cancelledError();
            }
            if (const auto limit = readerSilence(); watch_.hasHung(limit)) {
                (void)end();
                return makeError(ErrorCode::IoError,
                                 "its reader has hung: it did nothing for " +
                                     std::to_string((limit.count() + 999) / 1000) + " s and was ended",
                                 volume_);
            }
        }
        return {};
    }

    // How it ended, as wait() states. What has not ended by itself within that time is killed.
    int end(std::chrono::milliseconds patience = {}) {
        int status = 0;
        if (process_ < 0)
            return status;
        const auto deadline = std::chrono::steady_clock::now() + patience;
        pid_t ended = 0;
        while ((ended = ::waitpid(process_, &status, WNOHANG)) == 0 && std::chrono::steady_clock::now() < deadline)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (ended == 0) {
            ::kill(process_, SIGKILL);
            while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {}
            hasBeenKilled_ = true;
        }
        process_ = -1;
        return status;
    }

    // After the channel broke: the reader is dead, or about to be, or said what cannot be.
    Error deathOf() {
        const int status = end(std::chrono::milliseconds(500));
        if (hasBeenKilled_)
            return invalidReply();
        const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        if (signal == SIGXCPU)
            return makeError(ErrorCode::Corruption, "keeps its reader busy without end: the file is damaged", volume_);
        if (signal == SIGKILL)
            return makeError(ErrorCode::OutOfSpace, "its reader was ended by the system because memory ran out",
                             volume_);
        const int exitStatus = signal == 0 ? WEXITSTATUS(status) : 0;
        constexpr int kCannotRun = 126, kNotFound = 127; // of shells, and of the system where a library is missing
        if (exitStatus == kCannotRun || exitStatus == kNotFound)
            return makeError(ErrorCode::IoError,
                             "its reader cannot be started (exit status " + std::to_string(exitStatus) +
                                 "): a library is missing, or there is no memory for it",
                             volume_);
        return makeError(
            ErrorCode::Corruption,
            "crashes its reader (" +
                (signal != 0 ? "signal " + std::to_string(signal) : "exit status " + std::to_string(exitStatus)) +
                "): the file is damaged",
            volume_);
    }

    fs::path volume_;
    pid_t process_;
    std::unique_ptr<MessageChannel> channel_;
    ActivityWatch watch_;
    bool hasBeenKilled_ = false;
};

class ProcessSource final : public VolumeSource {
public:
    ProcessSource(std::unique_ptr<ReaderProcess> process, VolumeInfo info, std::stop_token stop)
        : process_(std::move(process)), info_(std::move(info)) {
        reading_.stop = std::move(stop);
    }

    const VolumeInfo& info() const override { return info_; }

    Status prepare(const JobControl& job) override {
        ReaderRequest request;
        request.kind = RequestKind::Prepare;
        const auto reply = process_->ask(request, ReplyKind::Info, job);
        if (!reply.isOk())
            return reply.error();
        auto info = decodeInfo(reply.value());
        if (!info || info->geometry != info_.geometry || info->type != info_.type)
            return process_->invalidReply();
        info_ = *std::move(info);
        isPrepared_ = true;
        return {};
    }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        if (!isPrepared_) // so that info() states what only the first slab brings to light
            ISO_TRY(prepare(reading_));
        ReaderRequest request;
        request.kind = RequestKind::ReadSlab;
        request.zBegin = zBegin;
        request.zEnd = zEnd;
        const auto reply = process_->ask(request, ReplyKind::Slab, reading_);
        if (!reply.isOk())
            return reply.error();
        return process_->takeBytes(out, reading_);
    }

private:
    std::unique_ptr<ReaderProcess> process_;
    VolumeInfo info_;
    JobControl reading_;
    bool isPrepared_ = false;
};

ReaderRequest requestFor(RequestKind kind, const fs::path& path, const ReadOptions& options) {
    ReaderRequest request;
    request.kind = kind;
    request.path = path.string();
    request.options = options;
    return request;
}

} // namespace

Result<std::unique_ptr<VolumeSource>> openInReaderProcess(const fs::path& path, const ReadOptions& options,
                                                          const JobControl& job) {
    auto process = ReaderProcess::start(path);
    if (!process.isOk())
        return std::move(process).error();
    const auto reply = process.value()->ask(requestFor(RequestKind::Open, path, options), ReplyKind::Info, job);
    if (!reply.isOk())
        return reply.error();
    auto info = decodeInfo(reply.value());
    if (!info)
        return process.value()->invalidReply();
    return std::unique_ptr<VolumeSource>(
        std::make_unique<ProcessSource>(std::move(process).value(), *std::move(info), job.stop));
}

Result<VolumeContents> listInReaderProcess(const fs::path& path, const ReadOptions& options, const JobControl& job) {
    auto process = ReaderProcess::start(path);
    if (!process.isOk())
        return std::move(process).error();
    const auto reply = process.value()->ask(requestFor(RequestKind::List, path, options), ReplyKind::Contents, job);
    if (!reply.isOk())
        return reply.error();
    auto contents = decodeContents(reply.value());
    if (!contents)
        return process.value()->invalidReply();
    return *std::move(contents);
}

} // namespace isoslider::io
