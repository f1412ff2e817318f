#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/cli/outcome.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::cli {

/// Refuses an output before any work is done for it: the input itself (wrong usage), a directory, a
/// folder that is not there or may not be written to (I/O failure). An existing file is fine: it is
/// replaced in one step when the new one is whole.
Outcome checkOutput(const std::filesystem::path& output, const std::filesystem::path& input);

/// Refuses what only shows when a file is made: file systems that take none whatever their permissions state,
/// names too long for what is written beside them first (I/O failure), another program that is writing there
/// (refused).
Outcome tryOutput(const std::filesystem::path& output);

/// Refuses an output that would replace one of `files`, which are read (wrong usage): itself, or the file beside it
/// that is written first.
Outcome checkNotRead(const std::filesystem::path& output, const std::vector<std::filesystem::path>& files);

/// The same of all files of an open volume. REQUIRES: before tryOutput.
Outcome checkNotRead(const std::filesystem::path& output, const std::filesystem::path& volume,
                     const io::VolumeInfo& info);

/// checkOutput for a mesh, whose suffix states its format.
Outcome checkMeshOutput(const std::filesystem::path& output, const std::filesystem::path& input);

} // namespace isoslider::cli
