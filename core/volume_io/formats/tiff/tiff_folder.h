#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/result.h"

namespace isoslider::io {

/// The files of a folder whose names are of TIFF, in natural order: "slice9" before "slice10".
/// Errors: IoError, InvalidArgument (more than 65536).
Result<std::vector<std::filesystem::path>> tiffFilesOf(const std::filesystem::path& folder);

/// The last number in a file's name, of 15 digits at most; -1 without one.
std::int64_t numberInName(const std::filesystem::path& path);

} // namespace isoslider::io
