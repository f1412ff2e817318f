#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/file_system.h"

namespace isoslider::index {

/// What was added to an index once it was complete, behind it in its file (FORMAT.md, Appendix). The index is as it was
/// whether there is one or not, and whether adding it went to its end or not.
struct Appendix {
    std::unique_ptr<RandomAccessFile> file;
    std::uint64_t bodyOffset = 0, bodyBytes = 0; ///< in the file; pages that the directory knows
    std::vector<std::byte> directory; ///< its checksum is right
};

/// None where there is no whole one that belongs to this index. Errors: those of opening a file; Corruption (no index).
Result<std::optional<Appendix>> readAppendix(const std::filesystem::path& index,
                                             FileSystem& fileSystem = defaultFileSystem());

/// Puts one in the place of what follows the index. It counts once all is on the disk. Errors: those of reading the
/// index; OutOfSpace, IoError, InvalidArgument (another program writes it).
Status writeAppendix(const std::filesystem::path& index, std::span<const std::byte> body,
                     std::span<const std::byte> directory, FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::index
