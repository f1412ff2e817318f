#pragma once

#include "core/volume_io/formats/format_readers.h"

// What links VTK, GDCM, libtiff, NetCDF and HDF5: the reader process and tests, never the programs, which would take
// 0.15 s longer to start.

namespace isoslider::io {

/// openVolume and listVolumes without a separate process, whatever the format.
OpenFormat openInProcess;
ListFormat listInProcess;

} // namespace isoslider::io
