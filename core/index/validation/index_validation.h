#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/grid/grid_geometry.h"
#include "core/grid/scalar_type.h"
#include "core/index/format/index_info.h"
#include "core/index/index_places.h"

namespace isoslider::index {

/// One thing in an index that is not as FORMAT.md states, and where it matters: what is wrong may concern some
/// isovalues only, or some part of the box.
struct IndexFault {
    std::string part; ///< "page 12 of level 2", "chunk 40", "histogram"
    std::string problem; ///< "fails its checksum"
    std::optional<std::uint64_t> offset; ///< of the part, in the file
    std::optional<std::array<double, 2>> isovalues; ///< from, to
    std::optional<PointBox> box;

    /// "page 12 of level 2 fails its checksum (at byte 4711; isovalues 3 to 5)".
    std::string line() const;
};

/// A volume to compare an index with.
struct ComparedVolume {
    GridGeometry geometry;
    ScalarType type = ScalarType::U8;
    /// Fills `out` with planes [zBegin, zEnd), x fastest. One call at a time.
    std::function<Status(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out)> read;
};

struct ValidationOptions {
    /// Besides the checksums, all that FORMAT.md demands of what they are of.
    bool isFull = false;
    /// Compared with the index: samples bit by bit, edges by sums over all of them, unless cells are merged.
    std::optional<ComparedVolume> volume;
    std::size_t mostFaults = 100; ///< that are described; all are counted
    std::uint64_t memoryBytes = std::uint64_t{1} << 30; ///< for counting distinct values
};

struct ValidationReport {
    IndexInfo info;
    std::vector<IndexFault> faults;
    std::uint64_t faultCount = 0;
    std::uint64_t differences = 0; ///< of these, what the index has otherwise than the volume it is compared with
    std::uint64_t pages = 0, chunks = 0; ///< that were looked at
    std::uint64_t bytes = 0; ///< under checksums
    bool areSamplesCompared = false; ///< a volume was given, and it has the grid and type of the index

    bool isSound() const { return faultCount == 0; }
};

/// Whether an index is what FORMAT.md states. Without `isFull` header, directory and all checksums, and that each
/// byte belongs to one part. With it also: order and counts of records; that both ends of each edge (or brick) are
/// there and agree; that chunks can be decoded; that each block of each level is the net change over its interval;
/// histogram and curve; and that the list of edges or bricks, the range, the missing cells and the distinct values are
/// those of the samples.
///
/// Levels and both ends of edges are compared by sums of 64-bit hashes, so that memory does not grow with the index:
/// 16 bytes per block, 1 MB, and 34 planes of samples. Errors, where nothing can be said: those of
/// IndexReader::open, IoError, Cancelled, those of the volume. Threads: those of the calling task arena.
Result<ValidationReport> validateIndex(const std::filesystem::path& path, const ValidationOptions& options = {},
                                       const JobControl& job = {}, FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider::index
