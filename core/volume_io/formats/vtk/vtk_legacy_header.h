#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/volume_io/formats/vtk/vtk_kind.h"
#include "core/volume_io/sources/sample_source.h"

namespace isoslider::io {

/// A point array of a legacy file.
struct LegacyArray {
    std::string name;
    FileType type = FileType::F32;
    std::uint64_t components = 1;
    std::uint64_t position = 0; ///< where its samples begin
    bool isScalars = false; ///< given as SCALARS: what VTK takes for the active scalars
};

/// A legacy file up to its point arrays.
struct LegacyFile {
    VtkKind kind = VtkKind::Image;
    bool isBinary = false;
    GridDims dims{0, 0, 0}; ///< grid points; of unstructured grids, all of them along x
    std::uint64_t points = 0;
    /// The file's own words from DATASET to before POINT_DATA, checked; those of other sections are left out.
    /// Numbers in text are one a line.
    std::string structure;
    bool hasOffsets = false; ///< its cells are written as since version 5
    std::vector<LegacyArray> arrays; ///< as far as was asked for
};

struct LegacyRequest {
    bool keepsStructure = false; ///< fill LegacyFile::structure
    std::uint64_t memoryBytes = 0; ///< that of ReadOptions
    /// True for the array after which nothing more is looked at; none: to the end of the file.
    std::function<bool(const LegacyArray&)> isLast;
};

/// Walks a legacy file: every count is compared with the bytes that are left, every number of the structure in a text
/// file is read as one of its type. What is behind the last array that is wanted is not looked at.
/// Errors: InvalidArgument, Corruption (with the place), IoError, OutOfSpace.
Result<LegacyFile> readLegacyHeader(const RandomAccessFile& file, const LegacyRequest& request);

/// VTK's word for a type, in text that it is given.
std::string_view legacyTypeName(FileType type);

/// Whether VTK reads the whole word as a value of the type: anything else it would wrap or skip.
bool isLegacySample(std::string_view word, FileType type);

} // namespace isoslider::io
