#include "ui/model/opening/preview_model.h"

namespace isoslider::model {

PreviewModel::PreviewModel(std::shared_ptr<BackgroundJobs> jobs, VolumeAccess volumes)
    : volumes_(std::move(volumes)), job_(jobs) {
    progress_ = jobs->jobs().observe([this] {
        if (state_ == State::Loading)
            changed_.notify();
    });
}

void PreviewModel::show(const std::filesystem::path& path, const io::ReadOptions& options) {
    state_ = State::Loading;
    job_.start(
        "Preview " + path.filename().string(),
        [path, options, volumes = volumes_](const JobControl& job) {
            return readVolumePreview(path, options, volumes, job);
        },
        [this](Result<VolumePreview> preview) { onRead(std::move(preview)); });
    changed_.notify();
}

void PreviewModel::onRead(Result<VolumePreview> preview) {
    if (preview.isOk()) {
        state_ = State::Ready;
        preview_ = std::move(preview).value();
    } else {
        state_ = State::Failed;
        preview_.reset();
        error_ = preview.error();
    }
    changed_.notify();
}

void PreviewModel::clear() {
    job_.cancel();
    preview_.reset();
    state_ = State::Empty;
    changed_.notify();
}

} // namespace isoslider::model
