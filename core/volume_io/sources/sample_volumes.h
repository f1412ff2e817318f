#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::io {

/// A volume that comes with the program.
struct SampleVolume {
    std::string name; ///< "bluntfin", for loadSample and command lines
    std::string title; ///< "Blunt Fin"
    std::string description; ///< one sentence
};

std::vector<SampleVolume> sampleVolumes();

/// Makes a sample volume of `dims` points (zeros: 256 each). `resourcesDir` is the folder that
/// contains `samples`. What is resampled is kept under the user's cache folder
/// ($XDG_CACHE_HOME or ~/.cache, then `isoslider`); failing to keep it is not an error.
/// Errors: InvalidArgument (no such name, impossible dims), NotFound (resources), Cancelled.
Result<std::shared_ptr<const ScalarGrid>> loadSample(std::string_view name, const GridDims& dims,
                                                     const std::filesystem::path& resourcesDir,
                                                     const JobControl& job = {});

/// The Spherical Shell of Chhugani et al. 2003 as u16: lround(65535 * |r - R| / top), where r is
/// the distance from the centre dims / 2, R = 79.1 * n / 256 with n the smallest extent, and top
/// the largest |r - R| in the box. Errors: Cancelled, InvalidArgument.
Result<ScalarGrid> makeSphericalShell(const GridDims& dims, const JobControl& job = {});

} // namespace isoslider::io
