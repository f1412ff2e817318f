#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/grid/grid_geometry.h"
#include "core/volume_io/formats/arrays/hdf5_file.h"

namespace isoslider::io {

/// Which axis of a data set is x, y, z and where its samples lie.
struct Placement {
    std::array<int, 3> axisOf{-1, -1, -1};
    GridGeometry geometry;
    std::vector<std::string> notes;
    std::string lengthUnit; ///< as VolumeInfo::lengthUnit
};

/// By what the file states in the way of openPMD, VTKHDF image data, MINC 2 or element_size_um; else the last axis is
/// x, at spacing 1. Notes what looks like a spacing and is not understood. Within a session.
Placement placementOf(hid_t file, const Hdf5Dataset& dataset);

} // namespace isoslider::io
