#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/volume_io/parsing/byte_stream.h"

// Data files that a text header names.

namespace isoslider::io {

inline constexpr std::size_t kMaxDataFiles = 65536;

/// The names that "name%03d.raw FIRST LAST STEP" stands for. Its one conversion is written out here, never by
/// printf. Errors: InvalidArgument.
Result<std::vector<std::string>> expandPattern(std::string_view value, std::string_view field,
                                               const std::filesystem::path& header);

/// Where data files are, from their first byte on. Errors: as resolveDataFile; InvalidArgument (none, too
/// many, or the header itself).
Result<std::vector<FilePart>> locateDataFiles(const std::vector<std::string>& names, std::string_view field,
                                              const std::filesystem::path& header, bool allowsExternal);

/// The files of `parts` but `opened` itself, for VolumeInfo::dataFiles.
std::vector<std::filesystem::path> filesBeside(const std::filesystem::path& opened, const std::vector<FilePart>& parts);

/// The same of slices in a folder. None when their names would be too long for a reader process to say: then every file
/// in the folder counts as one of them.
std::vector<std::filesystem::path> filesInFolder(std::vector<std::filesystem::path> slices);

} // namespace isoslider::io
