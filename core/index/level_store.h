#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/base/file_system.h"
#include "core/index/index_reader.h"

namespace isoslider::index {

/// Blocks 2^level * index to 2^level * (index + 1) - 1 of the highest level of an index; level 1 or more.
struct BlockGroup {
    int level = 0;
    std::uint64_t index = 0;
    std::uint64_t firstBlock() const { return index << level; }
    std::uint64_t blockEnd() const { return (index + 1) << level; }
    auto operator<=>(const BlockGroup&) const = default;
};

/// Groups are no larger than 2^kMaxGroupLevel blocks.
inline constexpr int kMaxGroupLevel = 12;

/// One encoded page of a merged group (totals_page.h), and what is stated of it.
struct StoredPage {
    std::uint64_t number = 0; ///< no other page of the store has it, ever
    std::uint64_t offset = 0; ///< in the file
    std::shared_ptr<const std::vector<std::byte>> memory; ///< its bytes, where they are not in the file
    std::uint64_t checksum = 0;
    std::uint32_t bytes = 0, totals = 0;
};

/// Blocks merged to one.
struct StoredGroup {
    std::vector<StoredPage> pages; ///< none: all in it is redundant; their totals add up, whatever bricks they are of
    bool isWorthwhile = true; ///< otherwise it has no pages, and its blocks are as good
};

/// Merged groups of blocks, kept in a file beside their index (FORMAT.md, "Lazy levels"), or in memory where there can
/// be none: the medium cannot be written, the disk is full, another program writes the file. The file is an addition
/// that any program may remove, damage or ignore: what is not right in it counts as absent, whatever the reason.
///
/// Any thread may look groups up; one at a time adds some.
class LevelStore {
public:
    /// Takes over what the file has. `reader` must outlive the store; of `memoryBytes` are the groups kept in
    /// memory.
    LevelStore(const IndexReader& reader, std::uint64_t memoryBytes);
    ~LevelStore();

    /// Null: not there.
    std::shared_ptr<const StoredGroup> find(const BlockGroup& group) const;
    /// Its bytes, their checksum verified. Errors: IoError, Corruption.
    Status read(const StoredPage& page, std::vector<std::byte>& bytes) const;
    /// It turned out to be damaged.
    void forget(const BlockGroup& group);
    /// Forgets what is in memory only.
    void dropMemory();

    /// Adds a group page by page. False: there is no room; the group must be abandoned.
    bool begin();
    bool add(std::span<const std::byte> bytes, std::uint32_t totals);
    /// The group can be found from now on. REQUIRES: begin() and all add() have succeeded.
    void finish(const BlockGroup& group, bool isWorthwhile);
    void abandon() noexcept;

    std::uint64_t memoryBytes() const;

    /// The file of an index: its name with ".levels" appended, links followed.
    static std::filesystem::path pathFor(const std::filesystem::path& index);
    /// Removes the file beside an index that has been replaced, if it is one of levels.
    static void discard(const std::filesystem::path& index, FileSystem& disk);

private:
    enum class Place { Undecided, File, Memory };

    void takeOver();
    bool isOfTheIndex(const RandomAccessFile& file) const;
    void readGroups(const RandomAccessFile& file);
    bool openWriter();
    void leaveFile();
    bool hasRoomInFile(std::uint64_t bytes) const;

    const IndexReader& reader_;
    std::uint64_t maxMemoryBytes_, maxFileBytes_;
    std::filesystem::path path_;
    std::uint64_t seed_ = 0; ///< of checksums: a file of another index fails all of them
    std::vector<std::byte> header_;

    mutable std::mutex mutex_; ///< of what follows
    std::map<BlockGroup, std::shared_ptr<const StoredGroup>> groups_;
    std::shared_ptr<const RandomAccessFile> file_; ///< null: there is none that is right
    std::uint64_t memoryBytes_ = 0;
    std::uint64_t nextNumber_ = 0;

    // Of the thread that adds.
    Place place_ = Place::Undecided;
    std::unique_ptr<WritableFile> writer_; ///< holds the file's lock
    std::uint64_t validBytes_ = 0; ///< of the file: whole groups
    std::uint64_t draftBytes_ = 0;
    std::vector<StoredPage> draft_;
};

} // namespace isoslider::index
