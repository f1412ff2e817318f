#include "ui/model/session/volume_opening.h"

#include <utility>

#include "ui/model/opening/volume_choice.h"

namespace isoslider::model {

Result<OpenedVolume> openOrAsk(const OpenRequest& request, const SessionServices& services, const IndexCache& cache,
                               const JobControl& job) {
    OpenedVolume opened;
    auto loaded = loadDataset(request, cache, services.sampleLoader, services.wholeVolumeBytes, job, services.volumes);
    if (loaded.isOk()) {
        opened.loaded = std::move(loaded).value();
        return opened;
    }
    // Only what is refused is listed: a file with nothing to choose is opened without being read twice.
    if (request.asksForChoice && loaded.error().code == ErrorCode::InvalidArgument && !job.isStopRequested()) {
        auto contents = services.volumes.list(request.path, request.readOptions);
        if (contents.isOk() && isWorthAsking(contents.value())) {
            opened.contents = std::move(contents).value();
            return opened;
        }
    }
    return std::move(loaded).error();
}

} // namespace isoslider::model
