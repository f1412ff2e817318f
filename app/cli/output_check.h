#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/cli/outcome.h"

namespace isoslider::cli {

/// Refuses an output before any work is done for it: the input itself (wrong usage), a directory, a
/// folder that is not there or may not be written to (I/O failure). An existing file is fine: it is
/// replaced in one step when the new one is whole.
Outcome checkOutput(const std::filesystem::path& output, const std::filesystem::path& input);

/// Refuses what only shows when a file is made: file systems that take none whatever their permissions state,
/// names too long for what is written beside them first (I/O failure), another program that is writing there
/// (refused).
Outcome tryOutput(const std::filesystem::path& output);

/// Refuses an output that is one of the files that an input's samples lie in (wrong usage).
Outcome checkNotRead(const std::filesystem::path& output, const std::vector<std::filesystem::path>& dataFiles);

/// checkOutput and tryOutput for a mesh, whose suffix states its format.
Outcome checkMeshOutput(const std::filesystem::path& output, const std::filesystem::path& input);

} // namespace isoslider::cli
