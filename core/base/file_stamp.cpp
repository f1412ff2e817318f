#include "core/base/file_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <span>
#include <string>

#include "core/base/content_hash.h"
#include "core/base/file_system.h"
#include "core/base/folders.h"

namespace isoslider {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostFiles = 100'000;
/// Within so long of a change a file may change again without its times showing it: their steps are those of the
/// kernel's clock, of old file systems even two seconds.
constexpr std::int64_t kSettledAfterNs = 3'000'000'000;

std::int64_t nanoseconds(const timespec& time) {
    return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

std::int64_t now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

fs::path normalized(const fs::path& path) {
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error);
    return (error ? path : absolute).lexically_normal();
}

} // namespace

Result<FileStamp> stampFile(const fs::path& file) {
    struct stat found {};
    if (::stat(file.c_str(), &found) != 0)
        return systemError(errno, "cannot look at", file);
    FileStamp stamp;
    stamp.size = static_cast<std::uint64_t>(found.st_size);
    stamp.modified = nanoseconds(found.st_mtim);
    stamp.changed = nanoseconds(found.st_ctim);
    stamp.isSettled = stamp.changed < now() - kSettledAfterNs;
    return stamp;
}

bool isUntouched(const FileStamp& a, const FileStamp& b) {
    return a.size == b.size && a.modified == b.modified && a.changed == b.changed;
}

Result<std::vector<fs::path>> filesBelow(const fs::path& folder) {
    auto files = listFiles(folder, {std::numeric_limits<int>::max(), kMostFiles + 1});
    if (files.isOk() && files.value().size() > kMostFiles)
        return makeError(ErrorCode::InvalidArgument, "holds too many files to know again", folder);
    return files;
}

void FileWatch::addFile(const fs::path& file) {
    const fs::path name = normalized(file);
    if (files_.contains(name))
        return;
    const auto stamp = stampFile(name);
    files_[name] = stamp.isOk() ? std::optional(stamp.value()) : std::nullopt;
}

void FileWatch::add(const fs::path& path) {
    if (!isFolder(path))
        return addFile(path);
    const auto files = filesBelow(path);
    if (files.isOk()) // no reader takes a folder of more
        for (const fs::path& file : files.value())
            addFile(file);
}

void FileWatch::keepOnly(const std::vector<fs::path>& files) {
    FileWatch kept;
    for (const fs::path& file : files) {
        addFile(file);
        const fs::path name = normalized(file);
        kept.files_[name] = files_[name];
    }
    files_ = std::move(kept.files_);
}

std::uint64_t FileWatch::digest() const {
    ContentHash hash;
    for (const auto& [file, stamp] : files_) {
        const std::string name = file.filename().string() + '\n';
        hash.add(std::as_bytes(std::span(name)));
        const FileStamp known = stamp.value_or(FileStamp());
        const std::array<std::int64_t, 3> numbers{static_cast<std::int64_t>(known.size), known.modified, known.changed};
        hash.add(std::as_bytes(std::span(numbers)));
    }
    return hash.value();
}

Status FileWatch::check() const {
    for (const auto& [file, before] : files_) {
        const auto after = stampFile(file);
        if (after.isOk() != before.has_value() || (before && !isUntouched(after.value(), *before)))
            return makeError(ErrorCode::InvalidArgument, "changed while it was read", file);
    }
    return {};
}

} // namespace isoslider
