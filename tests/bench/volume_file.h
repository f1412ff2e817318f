#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/grid/scalar_grid.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::bench {

/// A headerless little-endian file.
struct VolumeFile {
    std::filesystem::path path;
    GridDims dims{0, 0, 0};
    ScalarType type = ScalarType::U8;

    std::uint64_t points() const { return static_cast<std::uint64_t>(pointCount(dims)); }
    std::uint64_t sizeBytes() const { return points() * scalarTypeSizeBytes(type); }
    io::ReadOptions readOptions() const;
};

/// Writes a volume's samples, synced. Errors: IoError, OutOfSpace.
Result<VolumeFile> writeVolumeFile(const ScalarGrid& grid, const std::filesystem::path& path);

/// From a program's arguments: PATH NX NY NZ TYPE. REQUIRES: five of them. Errors: InvalidArgument.
Result<VolumeFile> volumeFileFromArguments(std::span<char* const> arguments);

/// Every `stride`-th sample along each axis: the same field at a smaller size.
ScalarGrid sampledCoarser(const ScalarGrid& grid, std::int64_t stride);

/// What a build is measured by: reading and writing as much, without doing anything. Seconds.
struct Yardstick {
    double copy = 0.0; ///< the volume's file copied within its folder
    double copySynced = 0.0; ///< the same, until the copy would survive a power loss, as an index does
    double pass = 0.0; ///< the file read in slabs, least and greatest of its samples found

    double reference() const { return 2 * copy + pass; }
    double referenceSynced() const { return 2 * copySynced + pass; }
};

/// The mean of the first and the second.
Yardstick meanOf(const Yardstick& first, const Yardstick& second);

/// Medians of three to seven, on the threads allowed (the pass; a copy has one). Leaves no file behind. Errors: those
/// of reading and writing.
Result<Yardstick> measureYardstick(const VolumeFile& file);

/// Asks the system to forget what it keeps of a file in memory.
void dropFromMemory(const std::filesystem::path& path);

} // namespace isoslider::bench
