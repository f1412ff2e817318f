#pragma once

#include <filesystem>
#include <string_view>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::io {

/// Writes a volume as MetaImage (.mha: header and samples in one file, little-endian, not
/// compressed), readable by ITK, VTK, 3D Slicer, ParaView and openVolume. Published by rename. `lengthUnit` is written
/// where MetaImage knows it: cm, mm, µm.
/// Errors: InvalidArgument (another suffix), Cancelled, OutOfSpace, IoError.
Status writeVolume(const ScalarGrid& grid, const std::filesystem::path& path, std::string_view lengthUnit = {},
                   const JobControl& job = {}, FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::io
