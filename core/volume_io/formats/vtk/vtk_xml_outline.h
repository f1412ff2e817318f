#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/file_system.h"

namespace isoslider::io {

/// Attributes of an XML element.
using XmlAttributes = std::map<std::string, std::string, std::less<>>;

std::string_view xmlValue(const XmlAttributes& attributes, std::string_view key, std::string_view otherwise = {});

/// Those of an array, and where in the file its content begins.
struct XmlArray : XmlAttributes {
    std::uint64_t contentBegin = 0;
};

/// What a VTK XML file states of itself, without its data.
struct VtkXmlOutline {
    XmlAttributes file; ///< of VTKFile
    XmlAttributes grid; ///< of ImageData, RectilinearGrid ...
    XmlAttributes pointData;
    std::vector<XmlAttributes> pieces;
    std::vector<XmlArray> pointArrays, placeArrays, cellsArrays, fieldArrays; ///< placeArrays: Points, Coordinates
    int cellArrays = 0; ///< in CellData
    XmlAttributes appended;
    std::optional<std::uint64_t> appendedBegin; ///< where the bytes after <AppendedData ...> begin
};

/// By expat, up to the appended data, which need not be XML. Bounded elements, nesting and attributes; no document
/// type, so no entities. Errors: InvalidArgument, IoError, OutOfSpace.
Result<VtkXmlOutline> readVtkXmlOutline(const RandomAccessFile& file);

} // namespace isoslider::io
