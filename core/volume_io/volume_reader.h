#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/base/job_control.h"
#include "core/volume_io/volume_source.h"

namespace isoslider::io {

/// Dims, type and place of a headerless file. `skipBytes` lie before the first sample.
struct RawLayout {
    GridDims dims{0, 0, 0};
    ScalarType type = ScalarType::U8;
    glm::dvec3 spacing{1.0};
    std::uint64_t skipBytes = 0;
    bool isBigEndian = false;
    bool allowsTrailing = false; ///< accept a file longer than dims and type ask for
};

struct ReadOptions {
    std::optional<RawLayout> raw;      ///< set: the file is headerless
    std::string field;                 ///< name of the scalar field to take where a file has several
    GridDims resampleDims{0, 0, 0};    ///< size for curvilinear input; zeros = the default for the format
};

/// Opens a volume and reads its header only, where the format allows. Every size in the header has
/// been checked against the real bytes of the file before this returns.
///
/// Formats: MetaImage (.mhd .mha), NRRD (.nrrd .nhdr, also one file per slice), NIfTI-1
/// (.nii .nii.gz .hdr/.img): raw samples are read slab by slab, compressed ones are unpacked as
/// the slabs are asked for, fastest in ascending order. VTK image data (.vti, legacy .vtk) is read
/// whole here. PLOT3D (grid or solution file given, the other found beside it by its name) is
/// resampled on the first slab, and then held. Anything else needs a RawLayout.
///
/// World space is that of the file as ITK gives it: millimetres, left-posterior-superior for
/// medical formats. Unsigned 32-bit and all 64-bit integers become f64; a 64-bit value that has no
/// exact f64 is refused when it is met. NIfTI slope and intercept make integers f32. Several
/// components, complex, colour, one and two dimensions, and series in time are refused.
/// Errors: NotFound, IoError (system), InvalidArgument or Corruption (refused, naming the field).
Result<std::unique_ptr<VolumeSource>> openVolume(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

/// Reads the whole volume into memory.
Result<std::shared_ptr<const ScalarGrid>> readVolume(const std::filesystem::path& path,
                                                     const ReadOptions& options = {},
                                                     const JobControl& job = {});

} // namespace isoslider::io
