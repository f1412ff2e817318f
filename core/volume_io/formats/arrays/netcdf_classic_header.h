#pragma once

#include "core/base/file_system.h"

namespace isoslider::io {

/// Walks the header of a classic NetCDF file (CDF-1, -2, -5) before the library does, which believes its counts and
/// reads zeros beyond the end: all counts, names and values lie within the file, and so does every variable.
/// Passes other files. O(header). Errors: Corruption (where in the file), IoError.
Status checkClassicNetcdf(const RandomAccessFile& file);

} // namespace isoslider::io
