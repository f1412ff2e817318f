#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace isoslider::fuzz {

/// Gives any bytes to one of our readers and aborts when it breaks a promise. What the bytes may be is stated where
/// each is defined. Keeps nothing from one call to the next.
using FuzzTarget = void(std::span<const std::byte> bytes);

FuzzTarget fuzzCube, fuzzDecoders, fuzzDicom, fuzzIndex, fuzzIndexParts, fuzzMesh, fuzzMessages, fuzzMetaImage, fuzzMrc,
    fuzzNetcdf, fuzzNifti, fuzzNrrd, fuzzPlot3d, fuzzRaw, fuzzTiff, fuzzVtkLegacy, fuzzVtkXml;

struct NamedTarget {
    std::string_view name; ///< of its folders in seeds/ and regressions/, and of its program without "fuzz_"
    FuzzTarget* run;
};

inline constexpr NamedTarget kFuzzTargets[] = {
    {"cube", fuzzCube},
    {"decoders", fuzzDecoders},
    {"dicom", fuzzDicom},
    {"index", fuzzIndex},
    {"index_parts", fuzzIndexParts},
    {"mesh", fuzzMesh},
    {"messages", fuzzMessages},
    {"meta_image", fuzzMetaImage},
    {"mrc", fuzzMrc},
    {"netcdf", fuzzNetcdf},
    {"nifti", fuzzNifti},
    {"nrrd", fuzzNrrd},
    {"plot3d", fuzzPlot3d},
    {"raw", fuzzRaw},
    {"tiff", fuzzTiff},
    {"vtk_legacy", fuzzVtkLegacy},
    {"vtk_xml", fuzzVtkXml},
};

} // namespace isoslider::fuzz
