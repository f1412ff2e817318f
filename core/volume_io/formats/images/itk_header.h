#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/result.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::io {

enum class ItkFormat { MetaImage, Nrrd };

/// Spacing, origin and direction as ITK reads them from the text of a header, with `dims` as known already.
/// Axes that ITK leaves out because their extent is 1 get spacing 1 and a perpendicular direction. ITK sees no
/// more than the text: `path` is for messages.
/// REQUIRES: the header has been checked, and is of scalars; ITK's parsers trust what they read.
/// Errors: InvalidArgument (ITK refuses, or sees other extents).
Result<GridGeometry> readItkGeometryOfText(std::string_view header, ItkFormat format, const GridDims& dims,
                                           const std::filesystem::path& path);

} // namespace isoslider::io
