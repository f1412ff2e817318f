#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>

#include "ui/model/jobs/index_builder.h"
#include "ui/model/jobs/job_runner.h"
#include "ui/model/session/dataset.h"

namespace isoslider::model {

/// What a session needs from the program around it.
struct SessionServices {
    MainThread postToMain;
    std::shared_ptr<IndexBuilder> indexBuilder; ///< null: indexes are never built
    SampleLoader sampleLoader;
    VolumeAccess volumes;
    std::filesystem::path cacheFolder;
    JobPriority backgroundPriority = JobPriority::Usual; ///< of what nobody waits for: indexes, topology, counts
    /// A file with more bytes of samples is shown as a preview until its index is there.
    std::uint64_t wholeVolumeBytes = std::numeric_limits<std::uint64_t>::max();
};

} // namespace isoslider::model
