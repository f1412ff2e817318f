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
/// been checked against the real bytes of the file before this returns. Uncompressed raw, MetaImage
/// and NRRD files stream slab by slab; others are read whole on the first slab.
/// Errors: NotFound, IoError (system), InvalidArgument or Corruption (refused, naming the field).
Result<std::unique_ptr<VolumeSource>> openVolume(const std::filesystem::path& path,
                                                 const ReadOptions& options = {});

/// Reads the whole volume into memory.
Result<std::shared_ptr<const ScalarGrid>> readVolume(const std::filesystem::path& path,
                                                     const ReadOptions& options = {},
                                                     const JobControl& job = {});

} // namespace isoslider::io
