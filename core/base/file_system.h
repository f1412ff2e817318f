#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace isoslider {

/// A regular file open for reading at any offset. Any number of threads at once.
class RandomAccessFile {
public:
    virtual ~RandomAccessFile() = default;
    virtual const std::filesystem::path& path() const = 0;
    /// Size when the file was opened. What is appended later can be read where the file is one of the system's.
    virtual std::uint64_t sizeBytes() const = 0;

    /// Reads up to out.size() bytes; fewer only where the file ends. Errors: IoError.
    virtual Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const = 0;

    /// Reports that a range will be read soon: a disk may be asked for many at once. Returns at once.
    virtual void willNeed(std::uint64_t /*offset*/, std::uint64_t /*size*/) const {}

    /// Fills `out` entirely. Errors: Corruption when the file ends first, IoError.
    Status readExactlyAt(std::uint64_t offset, std::span<std::byte> out) const;
};

/// A regular file open for writing, read back by opening it again. One thread at a time.
/// Errors of every member: OutOfSpace, IoError; bytes of the failed call may be partly there.
class WritableFile {
public:
    virtual ~WritableFile() = default;
    virtual const std::filesystem::path& path() const = 0;
    /// Number of bytes appended so far: where the next append goes.
    virtual std::uint64_t sizeBytes() const = 0;

    virtual Status writeAll(std::span<const std::byte> bytes) = 0;
    /// Overwrites bytes that have been appended already. REQUIRES: offset + bytes.size() <= sizeBytes().
    virtual Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
    /// Leaves the first `bytes` bytes only: where the next append goes. REQUIRES: there are as many.
    virtual Status cut(std::uint64_t bytes);
    /// Returns when the bytes would survive a power loss.
    virtual Status sync() = 0;
    /// Reports errors that only appear on closing; the destructor closes without a word.
    virtual Status close() = 0;
};

/// What a file system has room for. Two paths with one `fileSystemId` share it.
struct DiskSpace {
    std::uint64_t freeBytes = 0; ///< that this user may write
    std::uint64_t totalBytes = 0;
    std::uint64_t fileSystemId = 0;
};

/// The one door to the disk. Tests pass one whose nth call fails.
class FileSystem {
public:
    virtual ~FileSystem() = default;

    /// Refuses directories, FIFOs, sockets and devices (InvalidArgument) without blocking on them.
    /// Errors: NotFound, InvalidArgument, IoError.
    virtual Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::filesystem::path& path) = 0;
    /// Creates or empties a file and locks it until it is closed.
    /// Errors: InvalidArgument when another writer holds it, OutOfSpace, IoError.
    virtual Result<std::unique_ptr<WritableFile>> create(const std::filesystem::path& path) = 0;
    /// Opens an existing file to write behind its first `keepBytes` bytes; what is there now stays until it is
    /// overwritten or cut off. Locks it until it is closed. Errors: NotFound, InvalidArgument (another writer holds it;
    /// it has fewer bytes, or does not begin with `head`: it is another file than the caller thinks; no regular file),
    /// IoError, also where a file system cannot.
    virtual Result<std::unique_ptr<WritableFile>> extend(const std::filesystem::path& path,
                                                         std::span<const std::byte> head, std::uint64_t keepBytes);
    /// Replaces `to` if it exists, in one step, and makes the change survive a power loss where the file system can.
    /// On failure `to` is what it was.
    virtual Status renameDurably(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
    /// No error when there is no such file.
    virtual Status removeFile(const std::filesystem::path& path) = 0;
    /// Where a file written at `path` comes to lie; reports before any work whether it could be written. That of the
    /// disk: checkOutputPath() and linkTarget(), which see.
    virtual Result<std::filesystem::path> outputTarget(const std::filesystem::path& path);
    /// Gives a file the permissions of the one that it is to replace, if there is one and it can.
    virtual void copyPermissions(const std::filesystem::path& from, const std::filesystem::path& to);
    /// Whether what is written outlives the process.
    virtual bool keepsFiles() const { return true; }
    /// Of the file system that `folder` lies on; one that states nothing has no end. Errors: NotFound, IoError.
    virtual Result<DiskSpace> space(const std::filesystem::path& folder);
};

FileSystem& defaultFileSystem();

/// A file that appears under its name whole or not at all. Written as `name.partial` in the same
/// folder; destroyed before publish() it removes the partial and leaves an earlier file untouched.
/// Where the name is a symbolic link, all that happens to its target; the link stays.
class AtomicFile {
public:
    static Result<std::unique_ptr<AtomicFile>> create(const std::filesystem::path& path,
                                                      FileSystem& fileSystem = defaultFileSystem());
    /// Goes on with one that was left unfinished: behind its first `keepBytes` bytes, the rest is cut off. Errors:
    /// those of FileSystem::extend.
    static Result<std::unique_ptr<AtomicFile>> resume(const std::filesystem::path& path,
                                                      std::span<const std::byte> head, std::uint64_t keepBytes,
                                                      FileSystem& fileSystem = defaultFileSystem());
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::uint64_t sizeBytes() const { return file_->sizeBytes(); }
    Status writeAll(std::span<const std::byte> bytes) { return file_->writeAll(bytes); }
    Status writeAt(std::uint64_t offset, std::span<const std::byte> bytes) { return file_->writeAt(offset, bytes); }
    Status sync() { return file_->sync(); }
    /// Leaves `name.partial` there if it is not published: it will be gone on with.
    void keepUnfinished() { keepsUnfinished_ = true; }

    /// Syncs, renames to path(), syncs the folder. Call once; nothing may be written afterwards.
    /// On failure the partial is removed and an earlier file is still there.
    Status publish();

private:
    AtomicFile(const std::filesystem::path& path, std::filesystem::path target, FileSystem& fileSystem);

    std::filesystem::path path_, target_, partial_; ///< as given; with links followed; written until published
    std::unique_ptr<WritableFile> file_; ///< null until it has been created
    FileSystem& fileSystem_;
    bool isPublished_ = false;
    bool keepsUnfinished_ = false;
};

/// `path` with ".partial" appended: the name an AtomicFile has before it is published.
std::filesystem::path partialPath(const std::filesystem::path& path);

/// What a chain of symbolic links leads to, whether it exists or not; `path` itself if it is none.
/// Errors: IoError (links in a circle).
Result<std::filesystem::path> linkTarget(const std::filesystem::path& path);

/// Reports before any work whether a file could be written at `path`: its folder exists and is
/// writable, and the path is free or a regular file. Errors: NotFound (no such folder),
/// InvalidArgument, IoError (no permission).
Status checkOutputPath(const std::filesystem::path& path);

/// A whole small file. Errors: those of openForReading; InvalidArgument beyond `maxBytes`.
Result<std::vector<std::byte>> readWholeFile(const std::filesystem::path& path, std::uint64_t maxBytes,
                                             FileSystem& fileSystem = defaultFileSystem());

/// The other way: `text` appears at `path` whole or not at all. Errors: those of AtomicFile.
Status writeWholeFile(const std::filesystem::path& path, std::string_view text,
                      FileSystem& fileSystem = defaultFileSystem());

/// Error for a failed system call: OutOfSpace for a full disk or quota, NotFound for a missing
/// file, IoError otherwise, with the system's own words. `action`: "cannot read".
Error systemError(int errorNumber, std::string_view action, const std::filesystem::path& path);

} // namespace isoslider
