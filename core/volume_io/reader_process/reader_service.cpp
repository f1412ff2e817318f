#include "core/volume_io/reader_process/reader_service.h"

#include <sys/resource.h>

#include <algorithm>
#include <csignal>

#include "core/base/file_system.h"
#include "core/base/guarded.h"
#include "core/base/memory_limit.h"
#include "core/base/sanitizers.h"
#include "core/volume_io/parsing/reading_memory.h"
#include "core/volume_io/reader_process/library_formats.h"
#include "core/volume_io/reader_process/message_channel.h"
#include "core/volume_io/reader_process/messages.h"

namespace isoslider::io {
namespace {

#if ISO_HAS_SANITIZER
constexpr bool kLimitsMemory = false; // the sanitizers map terabytes
#else
constexpr bool kLimitsMemory = true;
#endif
constexpr rlim_t kOpeningSeconds = 60; // of processor time

void setLimit(__rlimit_resource resource, rlim_t value) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0)
        return;
    limit.rlim_cur = std::min(value, limit.rlim_max);
    ::setrlimit(resource, &limit);
}

// No decoder makes more than 1032 bytes from one (deflate), so a small file has no need of much memory.
rlim_t memoryAllowance(const std::filesystem::path& path, const ReadOptions& options) {
    constexpr std::uint64_t kFactor = 1100, kBase = std::uint64_t{512} << 20;
    const std::uint64_t most = std::min(usableMemoryBytes(), kBase + readingMemoryOf(options.memoryBytes));
    const auto file = defaultFileSystem().openForReading(path);
    const std::uint64_t bytes = file.isOk() ? file.value()->sizeBytes() : most;
    double allowance = static_cast<double>(kBase) + static_cast<double>(kFactor) * static_cast<double>(bytes);
    if (options.resampleDims[0] > 0)
        allowance += 32.0 * static_cast<double>(options.resampleDims[0]) *
                     static_cast<double>(options.resampleDims[1]) * static_cast<double>(options.resampleDims[2]);
    return static_cast<rlim_t>(std::min(allowance, static_cast<double>(most)));
}

class Service {
public:
    explicit Service(int descriptor) : channel_(descriptor) {}

    void run() {
        for (;;) {
            const auto message = channel_.receive();
            if (!message.isOk())
                return;
            const auto request = decodeRequest(message.value());
            if (!request || !answer(*request).isOk())
                return;
        }
    }

private:
    Status answer(const ReaderRequest& request) {
        switch (request.kind) {
            case RequestKind::Open: return open(request);
            case RequestKind::List: return list(request);
            case RequestKind::Prepare: return prepare();
            case RequestKind::ReadSlab: return readSlab(request.zBegin, request.zEnd);
        }
        return {};
    }

    void limit(const ReaderRequest& request) {
        setLimit(RLIMIT_CPU, kOpeningSeconds);
        if (kLimitsMemory)
            setLimit(RLIMIT_DATA, memoryAllowance(request.path, request.options));
    }

    Status open(const ReaderRequest& request) {
        limit(request);
        auto source = openInProcess(request.path, request.options);
        setLimit(RLIMIT_CPU, RLIM_INFINITY); // reading lasts as long as there are samples
        if (!source.isOk())
            return channel_.send(encodeError(source.error()));
        source_ = std::move(source).value();
        return channel_.send(encodeInfo(source_->info()));
    }

    Status list(const ReaderRequest& request) {
        limit(request);
        const auto contents = listInProcess(request.path, request.options);
        return channel_.send(contents.isOk() ? encodeContents(contents.value()) : encodeError(contents.error()));
    }

    // The program that no longer wants the answer ends this process.
    Status prepare() {
        if (source_ == nullptr)
            return makeError(ErrorCode::InvalidArgument, "nothing is open");
        JobControl job;
        job.progress = [this](double fraction, std::string_view stage) {
            (void)channel_.send(encodeProgress(std::clamp(fraction, 0.0, 1.0), stage));
        };
        const Status made = guardedRead([&] { return source_->prepare(job); });
        return channel_.send(made.isOk() ? encodeInfo(source_->info()) : encodeError(made.error()));
    }

    Status readSlab(std::int64_t zBegin, std::int64_t zEnd) {
        if (source_ == nullptr || zBegin < 0 || zEnd < zBegin || zEnd > source_->info().geometry.dims[2])
            return makeError(ErrorCode::InvalidArgument, "no such slab");
        const VolumeInfo& info = source_->info();
        const Status read = guardedRead([&]() -> Status {
            slab_.resize(static_cast<std::size_t>(info.geometry.dims[0] * info.geometry.dims[1] * (zEnd - zBegin)) *
                         scalarTypeSizeBytes(info.type));
            return source_->readSlab(zBegin, zEnd, slab_);
        });
        if (!read.isOk())
            return channel_.send(encodeError(read.error()));
        ISO_TRY(channel_.send(encodeSlab()));
        return channel_.sendBytes(slab_);
    }

    template <class Function>
    static Status guardedRead(const Function& read) {
        return guarded({"not enough memory to read the volume", ErrorCode::Corruption, "cannot be read"}, read);
    }

    MessageChannel channel_;
    std::unique_ptr<VolumeSource> source_;
    std::vector<std::byte> slab_;
};

} // namespace

int serveReader(int descriptor) {
    setLimit(RLIMIT_CORE, 0);
    setLimit(RLIMIT_FSIZE, 0);
    std::signal(SIGXFSZ, SIG_IGN);
    Service(descriptor).run();
    return 0;
}

} // namespace isoslider::io
