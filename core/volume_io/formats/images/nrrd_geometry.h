#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/grid/grid_geometry.h"
#include "core/volume_io/formats/images/nrrd_header.h"

namespace isoslider::io {

struct NrrdPlace {
    GridGeometry geometry;
    bool isPatientSpace = false; ///< that space is a patient's, and the directions of the axes in it are known
};

/// Where the axes of space lie, in left-posterior-superior where the header names a space that can be turned into
/// it (as ITK and 3D Slicer do); `notes` receives what was assumed. Up to three axes; what they leave open is
/// perpendicular to them, at distance 1. Without directions, spacings and, if all axes have them, "axis mins" count.
/// Source: teem, "Definition of NRRD file format", Orientation information.
/// Errors: InvalidArgument, naming the field.
Result<NrrdPlace> readNrrdPlace(const NrrdHeader& header, std::vector<std::string>& notes,
                                const std::filesystem::path& path);

} // namespace isoslider::io
