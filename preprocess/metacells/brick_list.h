#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/job_control.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_grid.h"
#include "core/grid/scalar_key.h"
#include "core/index/index_writer.h"

namespace isoslider::preprocess {

/// Least and greatest key among the 9^3 samples of each brick (those of its edges' ends), by brick. Bricks
/// without two different finite samples have least > greatest or equal: they are never active.
template <class Key>
struct BrickSpans {
    std::vector<Key> least, greatest;
};

/// Writes the skip list of the bricks that become active and inactive: records of bricks at their least and
/// greatest keys, cut into levels as edges are (level_builder.h). A record's id is that of the brick's
/// first point, its one edge any that stays in the box. `levels` receives the counts.
struct BrickListOptions {
    int skipLevels = 5;
    double redundancyThreshold = 1.0; ///< k, as in BuildOptions
    std::uint64_t memoryBytes = std::uint64_t{1} << 40; ///< for the sort
};

template <class Key>
Status writeBrickList(const BrickSpans<Key>& spans, const GridDims& dims, const BrickListOptions& options,
                      const std::filesystem::path& spillPath, FileSystem& fileSystem, index::IndexWriter& writer,
                      std::vector<index::SkipLevelInfo>& levels, const JobControl& job = {});

/// The engine on a volume in memory: slides without an index, from the first second. One pass over the
/// samples, some tens of milliseconds at 256^3. Errors: Cancelled, OutOfSpace.
Result<std::unique_ptr<extract::SlideEngine>> makeMemoryEngine(std::shared_ptr<const ScalarGrid> grid,
                                                               const JobControl& job = {});

} // namespace isoslider::preprocess
