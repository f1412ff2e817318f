#pragma once

#include <filesystem>
#include <memory>

#include "core/base/file_system.h"
#include "core/base/state_archive.h"
#include "core/index/format/index_format.h"

namespace isoslider::index {

/// Writes an index front to back: pages as they come, then the directory, then the preamble.
/// The file appears under its name only when finish() succeeds. One thread at a time.
class IndexWriter {
public:
    /// `seed` is any number that depends on the volume and the parameters only.
    static Result<std::unique_ptr<IndexWriter>> create(const std::filesystem::path& path, std::uint64_t seed,
                                                       FileSystem& fileSystem = defaultFileSystem());

    /// Syncs all that was added, and saves what is needed to go on from here.
    Status suspend(StateArchive& archive);
    /// Goes on with a file that was left unfinished, and leaves it unfinished again if finish() does not come; what was
    /// added since suspend() is cut off. Errors: those of
    /// AtomicFile::resume, Corruption.
    static Result<std::unique_ptr<IndexWriter>> resume(const std::filesystem::path& path, StateArchive& archive,
                                                       FileSystem& fileSystem = defaultFileSystem());
    /// Leaves the partial file if finish() does not come: it will be gone on with.
    void keepUnfinished() { file_->keepUnfinished(); }

    /// Appends one encoded page to a level; its place and checksum are filled in here.
    Status addPage(SkipLevel level, PageEntry entry, std::span<const std::byte> bytes);
    /// Appends the next chunk, in chunk order. `kGroupChunks` fill a group, whose table then follows.
    Status addChunk(std::span<const std::byte> chunk);
    /// Ends the last group. REQUIRES: called after the last chunk, before anything else is added.
    Status endChunks() { return groupTable_.empty() ? Status() : endGroup(); }
    /// Ends a block of a level above 0: all pages added there since the last one.
    void endBlock(SkipLevel level, std::uint64_t firstKey, std::uint64_t lastKey);

    /// Number of bytes so far: where the next part goes.
    std::uint64_t sizeBytes() const { return file_->sizeBytes() + buffer_.size(); }

    /// Writes what is left and publishes. `meta.levels` and `meta.chunkGroups` are filled in here;
    /// `meta.info.levels` must have an entry per level, its bytes and edge sums are completed. Returns
    /// the finished info.
    Result<IndexInfo> finish(IndexMeta meta);

private:
    IndexWriter(std::unique_ptr<AtomicFile> file, std::uint64_t seed) : file_(std::move(file)), seed_(seed) {}
    void state(StateArchive& archive);
    Status endGroup();
    Status append(std::span<const std::byte> bytes);
    Status flush();

    std::unique_ptr<AtomicFile> file_;
    std::uint64_t seed_;
    std::vector<std::byte> buffer_; ///< not written yet: chunks are small, and there are many
    std::vector<LevelDirectory> levels_;
    std::vector<ChunkGroupEntry> groups_;
    std::vector<std::byte> groupTable_; ///< of the group that is being filled
    std::uint64_t groupOffset_ = 0;
    std::uint64_t chunkBytes_ = 0;
    std::uint64_t resumedBytes_ = 0; ///< of the file, when its state was saved
};

} // namespace isoslider::index
