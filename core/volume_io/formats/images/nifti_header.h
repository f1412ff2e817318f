#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::io {

/// A NIfTI volume in one file, or its header and samples in two.
struct NiftiFiles {
    std::filesystem::path header;
    std::filesystem::path data;
    bool isPair = false;
    bool isHeaderPacked = false;
    bool isDataPacked = false;
};

enum class NiftiVersion { Analyze75, Nifti1, Nifti2 };

/// What is used of a header, as it stands there; only its version has been checked.
struct NiftiHeader {
    NiftiVersion version = NiftiVersion::Nifti1;
    bool isBigEndian = false;
    std::vector<std::int64_t> sizes; ///< dim[1] to dim[dim[0]]
    std::int64_t dataType = 0;
    std::int64_t bitsPerSample = 0;
    std::int64_t intent = 0;
    std::array<double, 4> pixelSizes{}; ///< pixdim[0] to pixdim[3]
    double dataOffset = 0.0;
    double slope = 0.0;
    double intercept = 0.0;
    std::int64_t units = 0;
    std::int64_t qformCode = 0;
    std::int64_t sformCode = 0;
    std::array<double, 3> quaternion{}; ///< b, c, d
    std::array<double, 3> offset{};
    std::array<std::array<double, 4>, 3> sform{}; ///< rows x, y, z
};

/// Errors: InvalidArgument (one of a pair is missing).
Result<NiftiFiles> findNiftiFiles(const std::filesystem::path& path);

/// Also checks that the chain of extensions stays before the samples. Errors: InvalidArgument, Corruption,
/// IoError.
Result<NiftiHeader> readNiftiHeader(const NiftiFiles& files);

/// The header states how long its units are, or is of a format that has but one: niftiPlace is in millimetres.
bool hasMillimetres(const NiftiHeader& header);

struct NiftiPlace {
    GridGeometry geometry; ///< left-posterior-superior, in millimetres
    bool isStated = false; ///< by the sform or the qform; otherwise its directions and origin are assumed
};

/// Place in space: of the sform, else the qform, else the pixel sizes. What had to be assumed goes to `notes`.
NiftiPlace niftiPlace(const NiftiHeader& header, const GridDims& dims, std::vector<std::string>& notes);

} // namespace isoslider::io
