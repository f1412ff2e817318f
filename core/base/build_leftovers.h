#pragma once

#include <filesystem>
#include <optional>

#include "core/base/result.h"

namespace isoslider {

/// Beside an index X.isx lie files that are parts of building and exploring it, some of them after a kill or a power
/// loss: X.isx.resume, X.isx.partial, X.isx.levels and others. Known by name. The index that such a file belongs to;
/// none of any other file.
std::optional<std::filesystem::path> indexOfLeftover(const std::filesystem::path& file);

/// Of what is to be read as a volume. Errors: InvalidArgument, naming the index.
Status checkIsNoLeftover(const std::filesystem::path& file);

} // namespace isoslider
