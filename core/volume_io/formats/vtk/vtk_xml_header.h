#pragma once

#include "core/volume_io/formats/vtk/vtk_kind.h"
#include "core/volume_io/formats/vtk/vtk_xml_outline.h"
#include "core/volume_io/volume_contents.h"

namespace isoslider::io {

/// What the XML part of a file states of the grid in it.
struct VtkXmlHeader {
    VtkKind kind = VtkKind::Image;
    GridDims dims{0, 0, 0}; ///< grid points; of unstructured grids, all of them along x
    std::uint64_t points = 0;
    VtkXmlOutline outline;
};

/// Reads and checks the XML of .vti, .vtr, .vts and .vtu files before VTK does: one piece that is all of the grid,
/// point arrays of known types (or none but of cells: refused). Sizes are not compared with the file: that does
/// checkVtkXmlRoom. Errors: InvalidArgument, IoError, OutOfSpace.
Result<VtkXmlHeader> readVtkXmlHeader(const RandomAccessFile& file);

/// Fields as many as point arrays; the one that the file marks as active, else the first of one component, is
/// preferred and chosen.
VolumeContents contentsOf(const VtkXmlHeader& header);

/// Where the data of a "binary" or "appended" array begins, with its heading, and whether it is base64.
struct VtkXmlPlace {
    std::uint64_t begin = 0;
    bool isText = false;
};
/// Errors: InvalidArgument, Corruption (beyond the file), IoError.
Result<VtkXmlPlace> placeOfData(const RandomAccessFile& file, const VtkXmlOutline& outline, const XmlArray& array);

/// Whether the file can hold `array` (of outline.pointArrays) and the arrays that state where the points are.
/// Errors: InvalidArgument, Corruption, IoError.
Status checkVtkXmlRoom(const RandomAccessFile& file, const VtkXmlHeader& header, std::size_t array);

} // namespace isoslider::io
