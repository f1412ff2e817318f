#include "core/base/file_system.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>

namespace isoslider {
namespace fs = std::filesystem;
namespace {

// Linux transfers at most 0x7ffff000 bytes per call whatever is asked.
constexpr std::size_t kMaxTransfer = std::size_t{1} << 30;

class FileDescriptor {
public:
    explicit FileDescriptor(int number) : number_(number) {}
    FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    FileDescriptor& operator=(FileDescriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~FileDescriptor() {
        if (number_ >= 0)
            ::close(number_);
    }
    int get() const { return number_; }
    bool isOpen() const { return number_ >= 0; }
    int release() { return std::exchange(number_, -1); }

private:
    int number_;
};

/// A call that a signal interrupted is made again.
template <class Call>
int retrying(const Call& call) {
    int outcome = -1;
    do {
        outcome = call();
    } while (outcome < 0 && errno == EINTR);
    return outcome;
}

int openRetrying(const fs::path& path, int flags, mode_t mode = 0) {
    return retrying([&] { return ::open(path.c_str(), flags | O_CLOEXEC, mode); });
}

std::string_view kindName(mode_t mode) {
    if (S_ISDIR(mode))
        return "a folder";
    if (S_ISFIFO(mode))
        return "a pipe";
    if (S_ISSOCK(mode))
        return "a socket";
    return "a device";
}

Error notRegularError(mode_t mode, const fs::path& path) {
    return makeError(ErrorCode::InvalidArgument, "is " + std::string(kindName(mode)) + "; a regular file was expected",
                     path);
}

Status writeFully(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes, const fs::path& path) {
    while (!bytes.empty()) {
        const ssize_t written =
            ::pwrite(descriptor, bytes.data(), std::min(bytes.size(), kMaxTransfer), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return systemError(written == 0 ? EIO : errno, "cannot write", path);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
        offset += static_cast<std::uint64_t>(written);
    }
    return {};
}

// Fewer bytes only where the file ends.
Result<std::size_t> readFully(int descriptor, std::uint64_t offset, std::span<std::byte> out, const fs::path& path) {
    std::size_t done = 0;
    while (done < out.size()) {
        const ssize_t got = ::pread(descriptor, out.data() + done, std::min(out.size() - done, kMaxTransfer),
                                    static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return systemError(errno, "cannot read", path);
        if (got == 0)
            break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

class PosixRandomAccessFile final : public RandomAccessFile {
public:
    PosixRandomAccessFile(fs::path path, FileDescriptor descriptor, std::uint64_t size)
        : path_(std::move(path)), descriptor_(std::move(descriptor)), size_(size) {}

    const fs::path& path() const override { return path_; }
    std::uint64_t sizeBytes() const override { return size_; }

    Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        return readFully(descriptor_.get(), offset, out, path_);
    }

    void willNeed(std::uint64_t offset, std::uint64_t size) const override {
        (void)::posix_fadvise(descriptor_.get(), static_cast<off_t>(offset), static_cast<off_t>(size),
                              POSIX_FADV_WILLNEED);
    }

private:
    fs::path path_;
    FileDescriptor descriptor_;
    std::uint64_t size_;
};

class PosixWritableFile final : public WritableFile {
public:
    explicit PosixWritableFile(fs::path path) : path_(std::move(path)), descriptor_(-1) {}
    void adopt(FileDescriptor descriptor, std::uint64_t size = 0) {
        descriptor_ = std::move(descriptor);
        size_ = size;
    }

    const fs::path& path() const override { return path_; }
    std::uint64_t sizeBytes() const override { return size_; }

    Status writeAll(std::span<const std::byte> bytes) override {
        ISO_TRY(writeFully(descriptor_.get(), size_, bytes, path_));
        size_ += bytes.size();
        return {};
    }

    Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) override {
        ISO_CHECK(offset <= size_ && bytes.size() <= size_ - offset);
        return writeFully(descriptor_.get(), offset, bytes, path_);
    }

    Status cut(std::uint64_t bytes) override {
        if (retrying([&] { return ::ftruncate(descriptor_.get(), static_cast<off_t>(bytes)); }) != 0)
            return systemError(errno, "cannot write", path_);
        size_ = bytes;
        return {};
    }

    Status sync() override {
        if (retrying([&] { return ::fsync(descriptor_.get()); }) != 0)
            return systemError(errno, "cannot sync", path_);
        return {};
    }

    // After close() fails the descriptor is gone on Linux, EINTR included: never retried.
    Status close() override {
        if (descriptor_.isOpen() && ::close(descriptor_.release()) != 0 && errno != EINTR)
            return systemError(errno, "cannot close", path_);
        return {};
    }

private:
    fs::path path_;
    FileDescriptor descriptor_;
    std::uint64_t size_ = 0;
};

fs::path folderOf(const fs::path& path) {
    const fs::path parent = path.parent_path();
    return parent.empty() ? fs::path(".") : parent;
}

class PosixFileSystem final : public FileSystem {
public:
    // A file system without permissions refuses; what it keeps is as it was.
    void copyPermissions(const fs::path& from, const fs::path& to) override {
        struct stat facts {};
        if (::stat(from.c_str(), &facts) == 0 && S_ISREG(facts.st_mode))
            (void)::chmod(to.c_str(), (facts.st_mode & 0777) | S_IRUSR | S_IWUSR);
    }

    Result<std::unique_ptr<RandomAccessFile>> openForReading(const fs::path& path) override {
        // O_NONBLOCK: opening a pipe must not wait for a writer; it means nothing to regular files.
        FileDescriptor descriptor(openRetrying(path, O_RDONLY | O_NONBLOCK | O_NOCTTY));
        if (!descriptor.isOpen())
            return errno == ENXIO ? notRegularError(S_IFSOCK, path) : systemError(errno, "cannot open", path);
        struct stat facts {};
        if (::fstat(descriptor.get(), &facts) != 0)
            return systemError(errno, "cannot inspect", path);
        if (!S_ISREG(facts.st_mode))
            return notRegularError(facts.st_mode, path);
        return std::unique_ptr<RandomAccessFile>(std::make_unique<PosixRandomAccessFile>(
            path, std::move(descriptor), static_cast<std::uint64_t>(facts.st_size)));
    }

    Result<std::unique_ptr<WritableFile>> create(const fs::path& path) override {
        // Made before the file, so that nothing can fail between its creation and its owner.
        auto file = std::make_unique<PosixWritableFile>(path);
        // Not O_TRUNC: a second writer must be refused before it empties the first one's file.
        for (int attempt = 0; attempt < 100; ++attempt) {
            FileDescriptor descriptor(openRetrying(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY, 0666));
            if (!descriptor.isOpen())
                return systemError(errno, "cannot create", path);
            struct stat facts {};
            if (::fstat(descriptor.get(), &facts) != 0)
                return systemError(errno, "cannot inspect", path);
            if (!S_ISREG(facts.st_mode))
                return notRegularError(facts.st_mode, path);
            if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
                return makeError(ErrorCode::InvalidArgument, "is being written by another program", path);
            // Its former owner may have renamed or removed it between our open and our lock.
            struct stat named {};
            if (::stat(path.c_str(), &named) != 0 || named.st_ino != facts.st_ino || named.st_dev != facts.st_dev)
                continue;
            if (facts.st_size > 0 && retrying([&] { return ::ftruncate(descriptor.get(), 0); }) != 0)
                return systemError(errno, "cannot empty", path);
            file->adopt(std::move(descriptor));
            return std::unique_ptr<WritableFile>(std::move(file));
        }
        return makeError(ErrorCode::IoError, "keeps being replaced by another program", path);
    }

    Result<std::unique_ptr<WritableFile>> extend(const fs::path& path, std::span<const std::byte> head,
                                                 std::uint64_t keepBytes) override {
        auto file = std::make_unique<PosixWritableFile>(path);
        FileDescriptor descriptor(openRetrying(path, O_RDWR | O_NONBLOCK | O_NOCTTY));
        if (!descriptor.isOpen())
            return systemError(errno, "cannot write", path);
        if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
            return makeError(ErrorCode::InvalidArgument, "is being written by another program", path);
        struct stat facts {};
        if (::fstat(descriptor.get(), &facts) != 0)
            return systemError(errno, "cannot inspect", path);
        if (!S_ISREG(facts.st_mode))
            return notRegularError(facts.st_mode, path);
        std::vector<std::byte> first(head.size());
        const auto got = readFully(descriptor.get(), 0, first, path);
        if (!got.isOk())
            return got.error();
        // Its former owner may have renamed another one here between our open and our lock.
        struct stat named {};
        const bool isNamed =
            ::stat(path.c_str(), &named) == 0 && named.st_ino == facts.st_ino && named.st_dev == facts.st_dev;
        if (!isNamed || static_cast<std::uint64_t>(facts.st_size) < keepBytes || got.value() != head.size() ||
            !std::equal(head.begin(), head.end(), first.begin()))
            return makeError(ErrorCode::InvalidArgument, "has been replaced by another program", path);
        file->adopt(std::move(descriptor), keepBytes);
        return std::unique_ptr<WritableFile>(std::move(file));
    }

    Status renameDurably(const fs::path& from, const fs::path& to) override {
        // Opened before: once renamed, nothing may fail any more.
        const FileDescriptor folder(openRetrying(folderOf(to), O_RDONLY | O_DIRECTORY));
        if (!folder.isOpen())
            return systemError(errno, "cannot open folder", folderOf(to));
        if (::rename(from.c_str(), to.c_str()) != 0)
            return systemError(errno, "cannot rename to its final name", to);
        // Some file systems cannot sync a folder. The file is whole and in its place: that is no failure.
        (void)::fsync(folder.get());
        return {};
    }

    Status removeFile(const fs::path& path) override {
        if (::unlink(path.c_str()) != 0 && errno != ENOENT)
            return systemError(errno, "cannot remove", path);
        return {};
    }

    Result<DiskSpace> space(const fs::path& folder) override {
        const fs::path path = folder.empty() ? fs::path(".") : folder;
        struct statvfs room {};
        struct stat facts {};
        if (retrying([&] { return ::statvfs(path.c_str(), &room); }) != 0 || ::stat(path.c_str(), &facts) != 0)
            return systemError(errno, "cannot find the free space", path);
        const auto unit = static_cast<std::uint64_t>(room.f_frsize);
        return DiskSpace{unit * room.f_bavail, unit * room.f_blocks, static_cast<std::uint64_t>(facts.st_dev)};
    }
};

} // namespace

Status WritableFile::cut(std::uint64_t) { return makeError(ErrorCode::IoError, "cannot be cut here", path()); }

Result<std::unique_ptr<WritableFile>> FileSystem::extend(const fs::path& path, std::span<const std::byte>,
                                                         std::uint64_t) {
    return makeError(ErrorCode::IoError, "cannot be extended here", path);
}

Result<DiskSpace> FileSystem::space(const fs::path&) {
    constexpr std::uint64_t kNoEnd = std::numeric_limits<std::uint64_t>::max();
    return DiskSpace{kNoEnd, kNoEnd, 0};
}

Status RandomAccessFile::readExactlyAt(std::uint64_t offset, std::span<std::byte> out) const {
    auto got = readAt(offset, out);
    if (!got.isOk())
        return std::move(got).error();
    if (got.value() != out.size())
        return makeError(ErrorCode::Corruption,
                         "file ends early: " + std::to_string(out.size()) + " bytes expected, " +
                             std::to_string(got.value()) + " found",
                         path(), offset);
    return {};
}

void FileSystem::copyPermissions(const fs::path&, const fs::path&) {}

Result<fs::path> FileSystem::outputTarget(const fs::path& path) {
    ISO_TRY(checkOutputPath(path));
    return linkTarget(path);
}

FileSystem& defaultFileSystem() {
    static PosixFileSystem fileSystem;
    return fileSystem;
}

Result<fs::path> linkTarget(const fs::path& path) {
    constexpr int kMaxLinks = 40; // as many as Linux follows
    fs::path target = path;
    std::error_code problem;
    for (int links = 0; fs::is_symlink(fs::symlink_status(target, problem)); ++links) {
        const fs::path next = fs::read_symlink(target, problem);
        if (problem || links == kMaxLinks)
            return systemError(problem ? problem.value() : ELOOP, "cannot follow the link", path);
        target = target.parent_path() / next; // an absolute path replaces the folder
    }
    return target;
}

fs::path partialPath(const fs::path& path) {
    fs::path partial = path;
    partial += ".partial";
    return partial;
}

AtomicFile::AtomicFile(const fs::path& path, fs::path target, FileSystem& fileSystem)
    : path_(path), target_(std::move(target)), partial_(partialPath(target_)), fileSystem_(fileSystem) {}

Result<std::unique_ptr<AtomicFile>> AtomicFile::create(const fs::path& path, FileSystem& fileSystem) {
    // Made before the file, which it then removes whatever fails.
    auto target = fileSystem.outputTarget(path);
    if (!target.isOk())
        return std::move(target).error();
    std::unique_ptr<AtomicFile> atomic(new AtomicFile(path, std::move(target).value(), fileSystem));
    auto file = fileSystem.create(atomic->partial_);
    if (!file.isOk())
        return std::move(file).error();
    atomic->file_ = std::move(file).value();
    fileSystem.copyPermissions(atomic->target_, atomic->partial_); // before there is anything to read
    return atomic;
}

Result<std::unique_ptr<AtomicFile>> AtomicFile::resume(const fs::path& path, std::span<const std::byte> head,
                                                       std::uint64_t keepBytes, FileSystem& fileSystem) {
    auto target = fileSystem.outputTarget(path);
    if (!target.isOk())
        return std::move(target).error();
    std::unique_ptr<AtomicFile> atomic(new AtomicFile(path, std::move(target).value(), fileSystem));
    auto file = fileSystem.extend(atomic->partial_, head, keepBytes);
    if (!file.isOk())
        return std::move(file).error();
    ISO_TRY(file.value()->cut(keepBytes));
    atomic->file_ = std::move(file).value();
    return atomic;
}

AtomicFile::~AtomicFile() {
    // Removed while still locked, so that it can only be ours. Nobody is left to hear of a failure.
    if (file_ != nullptr && !isPublished_ && !keepsUnfinished_)
        static_cast<void>(fileSystem_.removeFile(partial_));
}

Status AtomicFile::publish() {
    ISO_CHECK(!isPublished_);
    ISO_TRY(file_->sync());
    // Renamed before it is closed: the lock holds until the name is taken.
    ISO_TRY(fileSystem_.renameDurably(partial_, target_));
    isPublished_ = true;
    (void)file_->close(); // synced and in its place: nothing that closing could state would undo that
    return {};
}

Status checkOutputPath(const fs::path& path) {
    if (path.empty() || !path.has_filename())
        return makeError(ErrorCode::InvalidArgument, "is not the name of a file to write", path);
    const auto target = linkTarget(path);
    if (!target.isOk())
        return target.error();
    const fs::path folder = folderOf(target.value());
    struct stat facts {};
    if (::stat(folder.c_str(), &facts) != 0)
        return systemError(errno, "cannot use folder", folder);
    if (!S_ISDIR(facts.st_mode))
        return makeError(ErrorCode::InvalidArgument, "is not a folder", folder);
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        return systemError(errno, "cannot write in folder", folder);
    if (::access(folder.c_str(), R_OK) != 0) // renameDurably has to open it
        return systemError(errno, "cannot open folder", folder);
    if (::stat(path.c_str(), &facts) == 0 && !S_ISREG(facts.st_mode))
        return notRegularError(facts.st_mode, path);
    return {};
}

Result<std::vector<std::byte>> readWholeFile(const fs::path& path, std::uint64_t maxBytes, FileSystem& fileSystem) {
    auto file = fileSystem.openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    const std::uint64_t size = file.value()->sizeBytes();
    if (size > maxBytes)
        return makeError(
            ErrorCode::InvalidArgument,
            "has " + std::to_string(size) + " bytes; at most " + std::to_string(maxBytes) + " are accepted here", path);
    std::vector<std::byte> bytes(size);
    ISO_TRY(file.value()->readExactlyAt(0, bytes));
    return bytes;
}

Status writeWholeFile(const fs::path& path, std::string_view text, FileSystem& fileSystem) {
    auto file = AtomicFile::create(path, fileSystem);
    if (!file.isOk())
        return std::move(file).error();
    ISO_TRY(file.value()->writeAll(std::as_bytes(std::span(text))));
    return file.value()->publish();
}

Error systemError(int errorNumber, std::string_view action, const fs::path& path) {
    ErrorCode code = ErrorCode::IoError;
    if (errorNumber == ENOSPC || errorNumber == EDQUOT)
        code = ErrorCode::OutOfSpace;
    else if (errorNumber == ENOENT || errorNumber == ENOTDIR)
        code = ErrorCode::NotFound;
    return makeError(code, std::string(action) + ": " + std::generic_category().message(errorNumber), path);
}

} // namespace isoslider
