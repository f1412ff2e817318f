#pragma once

#include "core/base/file_system.h"
#include "core/grid/grid_geometry.h"

// PLOT3D files do not contain byte order, precision or record marks: each combination implies a file size and the
// marks' values, and the one that fits is taken.

namespace isoslider::io {

/// How one file of a single block is laid out.
struct Plot3dLayout {
    GridDims dims{0, 0, 0};
    bool isBigEndian = false;
    bool hasMarks = false; ///< Fortran's byte counts around each record
    bool hasCount = false; ///< the number of blocks, 1, comes first
    bool isDouble = false;
    bool hasBlanking = false; ///< an integer per point behind the coordinates
};

/// Of a grid or of a solution file. The file has all bytes that the layout asks for. Errors: InvalidArgument, IoError.
Result<Plot3dLayout> detectPlot3dLayout(const RandomAccessFile& file, bool isGrid);

/// Of both; VTK has one setting for the two, so they must agree. That of the grid is returned.
/// Errors: InvalidArgument, IoError.
Result<Plot3dLayout> detectPlot3dPair(const RandomAccessFile& grid, const RandomAccessFile& solution);

} // namespace isoslider::io
