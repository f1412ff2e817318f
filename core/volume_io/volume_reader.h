#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/base/job_control.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::io {

/// Dims, type and place of a headerless file. `skipBytes` lie before the first sample.
struct RawLayout {
    GridDims dims{0, 0, 0};
    ScalarType type = ScalarType::U8;
    glm::dvec3 spacing{1.0};
    std::uint64_t skipBytes = 0;
    bool isBigEndian = false;

    bool operator==(const RawLayout&) const = default;
};

/// ReadOptions::component: the length of each sample taken as a vector; of complex samples, their modulus.
inline constexpr int kMagnitude = -1;

/// What to take of a file that holds more than one scalar volume, and what to let pass.
struct ReadOptions {
    std::optional<RawLayout> raw; ///< set: the file is headerless
    std::string field; ///< VolumeField::name of the one to take; empty: the one there is
    std::optional<int> component; ///< from 0, or kMagnitude; needed where samples have several
    std::optional<std::int64_t> frame; ///< from 0; needed where the field is a series
    GridDims resampleDims{0, 0, 0}; ///< size for input that is no uniform grid; zeros = VolumeField::dims
    bool allowsExternalData = false; ///< a header may name data files outside its folder
    bool allowsTrailing = false; ///< bytes behind the last sample are not refused
    /// How much memory reading may hold, in this program and its reader process; 0: what this machine has. What needs
    /// more is read in passes, or refused.
    std::uint64_t memoryBytes = 0;

    bool operator==(const ReadOptions&) const = default;
};

/// Opens a volume and reads its header only, where the format allows. Every size in the header has
/// been checked against the real bytes of the file before this returns. A folder is opened as the series of
/// slices it holds.
///
/// FORMATS.md, beside this file, lists the formats and what is read of each. What cannot be distinguished by its
/// name is known by its first bytes. Raw samples are read slab by slab, compressed ones are unpacked as the
/// slabs are asked for, fastest in ascending order. Grids that are not uniform are resampled on the first slab,
/// after which VolumeInfo::resampling states how well. Anything else needs a RawLayout.
///
/// World space is that of the file: of medical formats, millimetres, left-posterior-superior.
/// Unsigned 32-bit and all 64-bit integers become f64; a 64-bit value that has no exact f64 is refused when it
/// is met. Slope and intercept make integers f32, those of 32 bits f64, where they are not whole numbers that keep
/// the type's range.
/// A file with several fields, components or frames is refused, naming them, unless one is chosen.
/// Errors: NotFound, IoError (system), InvalidArgument or Corruption (refused, naming the field).
/// A stop request ends opening, and later the reading of slabs where another process reads: Cancelled.
Result<std::unique_ptr<VolumeSource>> openVolume(const std::filesystem::path& path, const ReadOptions& options = {},
                                                 const JobControl& job = {});

/// Reads the whole volume into memory. Errors, besides those of reading: InvalidArgument (its files changed meanwhile).
Result<std::shared_ptr<const ScalarGrid>> readVolume(const std::filesystem::path& path, const ReadOptions& options = {},
                                                     const JobControl& job = {});

/// The same of a volume that is open; `path` is for errors. Afterwards info() is complete.
Result<std::shared_ptr<const ScalarGrid>> readVolume(VolumeSource& source, const std::filesystem::path& path,
                                                     const JobControl& job = {});

} // namespace isoslider::io
