#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/file_stamp.h"
#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::io {

/// How well a uniform grid stands for the grid it was made from. At each point of that grid which has a value, the
/// resampled grid is interpolated (trilinear) and compared. Differences in units of the samples.
struct ResampleReport {
    std::int64_t sourcePoints = 0; ///< of the file's own grid
    std::int64_t comparedPoints = 0; ///< of those, with a separate value and in the resampled grid
    double maxDifference = 0.0; ///< the largest, without sign
    double rmsDifference = 0.0; ///< root of the mean square
    double rangeFraction = 0.0; ///< maxDifference as part of the range of the source's values; 0 if that is 0
    std::int64_t outsidePoints = 0; ///< of the resampled grid: in no cell, or in one that lacks a value; missing
};

/// The same in one line for people: "onto 10 x 10 x 10 points, off by up to 26 % of the range ...".
std::string lossText(const ResampleReport& report, const GridDims& dims);

/// What a volume is, known before its samples are read.
struct VolumeInfo {
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    std::string format; ///< "MetaImage", "NRRD", "NIfTI", "DICOM", "TIFF", "VTK image", "NetCDF", "raw", ...
    std::string fieldName; ///< the scalar field, where the format names it
    std::vector<std::filesystem::path> dataFiles; ///< that are read beside the file that was opened; of a folder, in it
    std::string fieldTitle; ///< the same for people; empty: the name will do
    /// Of spacing and origin: "mm", "Å"; empty where the format does not state. isLengthUnit() holds.
    std::string lengthUnit;
    bool isPatientSpace = false; ///< the header states that the world's axes lead towards left, posterior, superior
    std::vector<std::string> notes; ///< what the reader had to assume or leave out, one line each
    /// Set when the source has been resampled: once its first slab is read.
    std::optional<ResampleReport> resampling;
};

/// Samples delivered in slabs of whole z planes, so that preprocessing never needs them all at once.
/// One thread at a time.
class VolumeSource {
public:
    virtual ~VolumeSource() = default;
    virtual const VolumeInfo& info() const = 0;

    /// Makes at once what the first slab would have to wait for, where a format needs that: a grid that is
    /// resampled, a file that can only be read whole. Afterwards info() is complete.
    virtual Status prepare(const JobControl& /*job*/) { return {}; }

    /// Fills `out` with planes [zBegin, zEnd), x fastest, in the type of info().
    /// REQUIRES: out.size() is exactly that many samples. On failure `out` is unspecified.
    virtual Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) = 0;

    /// Whoever has read samples asks this before they count: what came from a file that changed meanwhile is of neither
    /// version. Errors: InvalidArgument, naming the file.
    Status checkUnchanged() const { return files_.check(); }
    /// The volume's files since before the first was opened; none of samples made elsewhere.
    void watch(FileWatch files) { files_ = std::move(files); }
    /// What the files stated of themselves when they were opened, in one number: the same while none of them changes.
    std::uint64_t filesDigest() const { return files_.digest(); }

private:
    FileWatch files_;
};

/// Slabs of a grid in memory; shares ownership.
std::unique_ptr<VolumeSource> makeMemorySource(std::shared_ptr<const ScalarGrid> grid,
                                               std::string format = "generated");
/// As above, with everything known of it. `info`'s geometry and type are set from the grid.
std::unique_ptr<VolumeSource> makeMemorySource(std::shared_ptr<const ScalarGrid> grid, VolumeInfo info);

} // namespace isoslider::io
