#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/result.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::io {

enum class ItkFormat { MetaImage, Nrrd };

/// Spacing, origin and direction as ITK reads them from a header, with `dims` as known already.
/// Axes that ITK leaves out because their extent is 1 get spacing 1 and a perpendicular direction.
/// REQUIRES: the header has been checked; ITK's parsers trust what they read.
/// Errors: InvalidArgument (ITK refuses, or sees several components or other extents).
Result<GridGeometry> readItkGeometry(const std::filesystem::path& path, ItkFormat format, const GridDims& dims);

/// The same of a header in memory, which ITK reads without looking at the file it came from.
Result<GridGeometry> readItkGeometryOfText(std::string_view header, ItkFormat format, const GridDims& dims,
                                           const std::filesystem::path& path);

} // namespace isoslider::io
