#pragma once

#include "core/volume_io/formats/vtk/vtk_xml_header.h"

namespace isoslider::io {

/// Checks the cells of an unstructured grid before VTK does, which takes memory for as many corners as the last of
/// the offsets states: offsets ascend and end within the connectivity, and each corner is one of the points. Packed
/// arrays are not looked into. REQUIRES: checkVtkXmlRoom passed. O(corners), in bounded memory.
/// Errors: Corruption, InvalidArgument, IoError.
Status checkVtkXmlCells(const RandomAccessFile& file, const VtkXmlHeader& header);

} // namespace isoslider::io
