#pragma once

#include <string>
#include <vector>

#include "core/base/file_system.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::io {

/// What the XML part of a .vti file says of the array that is to be read.
struct VtiHeader {
    GridDims dims{0, 0, 0};
    std::string array;      ///< its name
    bool isFirstUnnamed = false;
    std::string typeName;   ///< "Float32"
};

/// Reads and checks the XML of a .vti file before VTK does: image data, one piece that is the whole
/// extent, bounded nesting, no document type, an array of one component per point (`field`, or the
/// active or first one) whose bytes the file can hold. Errors: InvalidArgument, Corruption, IoError.
Result<VtiHeader> checkVtiHeader(const RandomAccessFile& file, const std::string& field);

} // namespace isoslider::io
