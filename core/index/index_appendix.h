#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/file_system.h"
#include "core/index/index_reader.h"

namespace isoslider::index {

/// What was added to an index once it was complete, behind it in its file (FORMAT.md, "Appendix"). The index is as it
/// was whether there is one or not, and whether adding it went to its end or not.
struct Appendix {
    std::unique_ptr<RandomAccessFile> file;
    std::uint64_t bodyOffset = 0, bodyBytes = 0; ///< in the file; pages that the directory knows
    std::vector<std::byte> directory; ///< its checksum is right
};

/// What follows the `indexBytes` bytes of an index in its file is nothing, an appendix, or what is there of one that
/// was not finished. Errors: IoError; Corruption (anything else).
Status checkBehindIndex(const RandomAccessFile& file, std::uint64_t indexBytes);

/// None where there is no whole one that belongs to this index. Errors: those of opening a file; Corruption (no index).
Result<std::optional<Appendix>> readAppendix(const std::filesystem::path& index,
                                             FileSystem& fileSystem = defaultFileSystem());

/// What is behind an index in its file.
enum class AppendixState {
    None,
    Unfinished, ///< zeros where a header belongs: adding it did not go to its end, or they came later; none is read
    Whole,
    Followed, ///< a whole one, and bytes behind it that belong to nothing
    Damaged, ///< a header or a directory that is not right, or is of another index: none is read
};
struct AppendixCheck {
    AppendixState state = AppendixState::None;
    std::uint64_t end = 0; ///< in the file: of a whole one, else of the index
};
/// Errors: those of readAppendix.
Result<AppendixCheck> checkAppendix(const std::filesystem::path& index, FileSystem& fileSystem = defaultFileSystem());

/// Adds one to the index that `reader` has open, and to no other: by then another may have its name. `part(i)` for i in
/// [0, parts) are its body, one after the other. It counts once all is on the disk; a whole one that is there already
/// stays, unless `replaces`. On failure the file is as it was before anything was added. Errors: OutOfSpace, IoError,
/// InvalidArgument (another program writes the index, or has replaced it), those of `part`.
Status writeAppendix(const IndexReader& reader, std::size_t parts,
                     const std::function<Result<std::vector<std::byte>>(std::size_t)>& part,
                     std::span<const std::byte> directory, bool replaces, FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::index
