#pragma once

#include <filesystem>
#include <string>

#include "app/cli/outcome.h"

namespace isoslider::cli {

/// Refuses an output before any work is done for it: the input itself (wrong usage), a directory, a
/// folder that is not there or may not be written to (I/O failure). An existing file is fine: it is
/// replaced in one step when the new one is whole.
Outcome checkOutput(const std::filesystem::path& output, const std::filesystem::path& input);

/// checkOutput for a mesh, whose suffix says its format.
Outcome checkMeshOutput(const std::filesystem::path& output, const std::filesystem::path& input);

} // namespace isoslider::cli
