#pragma once

#include <optional>

#include "core/volume_io/volume_reader.h"
#include "ui/model/session/dataset.h"
#include "ui/model/session/session_services.h"

namespace isoslider::model {

/// What opening a file came to: a volume, or what the user must choose from.
struct OpenedVolume {
    std::optional<LoadedDataset> loaded;
    io::VolumeContents contents;
};

/// As loadDataset(); a request that asksForChoice, of a file that cannot be opened before one is made, comes to that
/// choice.
Result<OpenedVolume> openOrAsk(const OpenRequest& request, const SessionServices& services, const IndexCache& cache,
                               const JobControl& job);

} // namespace isoslider::model
