#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/base/job_control.h"
#include "core/extract/slide_engine.h"
#include "core/grid/scalar_grid.h"
#include "core/volume_io/volume_reader.h"

namespace isoslider::model {

/// How the window has a volume made fit for sliding, without knowing the preprocessor.
class IndexBuilder {
public:
    virtual ~IndexBuilder() = default;

    /// Builds the index of `grid` and publishes it at `indexPath`, whose folder exists. On failure
    /// or cancel nothing is left behind. Runs on a worker thread; several may run at once.
    /// Of `about` the unit of length and what resampling lost are kept.
    virtual Status build(const std::shared_ptr<const ScalarGrid>& grid, const std::string& sourceName,
                         const io::VolumeInfo& about, const std::filesystem::path& indexPath,
                         const JobControl& job) = 0;

    /// As above, of a volume on disk that does not fit in memory: read in slabs, more than once. Such a build may take
    /// hours: what ends it, cancel included, leaves it unfinished, and the next one of the same volume goes on with it.
    /// Errors as above, and whatever io::openVolume reports.
    virtual Status buildFromFile(const std::filesystem::path& volume, const io::ReadOptions& options,
                                 const std::string& sourceName, const std::filesystem::path& indexPath,
                                 const JobControl& job) = 0;

    /// Whether the next build from a file may have something to go on with.
    virtual bool hasUnfinished(const std::filesystem::path& /*indexPath*/) const { return false; }

    /// An engine on the volume itself, for the time until its index is there. Null: none, then every move
    /// extracts the whole surface. Runs on the thread that slides. Errors: Cancelled, OutOfSpace.
    virtual Result<std::unique_ptr<extract::SlideEngine>> engineInMemory(
        const std::shared_ptr<const ScalarGrid>& /*grid*/, const JobControl& /*job*/) {
        return std::unique_ptr<extract::SlideEngine>();
    }
};

} // namespace isoslider::model
