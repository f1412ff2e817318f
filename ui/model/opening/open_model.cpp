#include "ui/model/opening/open_model.h"

namespace isoslider::model {

OpenModel::OpenModel(std::filesystem::path path, std::shared_ptr<BackgroundJobs> jobs, VolumeAccess volumes)
    : path_(std::move(path)), preview_(jobs, volumes), listing_(jobs) {
    previewSubscription_ = preview_.changed().observe([this] { changed_.notify(); });
    listing_.start(
        "Examine " + path_.filename().string(),
        [file = path_, list = volumes.list](const JobControl&) { return list(file, {}); },
        [this](Result<io::VolumeContents> contents) { onListed(std::move(contents)); });
}

OpenModel::OpenModel(std::filesystem::path path, io::VolumeContents contents, std::shared_ptr<BackgroundJobs> jobs,
                     VolumeAccess volumes)
    : path_(std::move(path)), preview_(jobs, std::move(volumes)), listing_(jobs) {
    previewSubscription_ = preview_.changed().observe([this] { changed_.notify(); });
    onListed(std::move(contents));
}

void OpenModel::onListed(Result<io::VolumeContents> contents) {
    if (contents.isOk() && contents.value().fields.empty())
        contents = makeError(ErrorCode::InvalidArgument, "holds no volume", path_.string());
    if (!contents.isOk()) {
        state_ = State::Failed;
        error_ = contents.error();
        return changed_.notify();
    }
    state_ = State::Ready;
    choice_.emplace(std::move(contents).value());
    showPreview();
    changed_.notify();
}

void OpenModel::change(const std::function<void(VolumeChoice&)>& function) {
    if (!choice_)
        return;
    function(*choice_);
    showPreview();
    changed_.notify();
}

void OpenModel::showPreview() {
    if (!choice_->field().problem.empty()) {
        shown_.reset();
        return preview_.clear();
    }
    const auto options = choice_->previewOptions();
    if (shown_ == options)
        return;
    shown_ = options;
    preview_.show(path_, options);
}

bool OpenModel::canOpen() const {
    if (!choice_ || !choice_->problem().empty())
        return false;
    // What is too large for a preview may well be opened.
    return preview_.state() != PreviewModel::State::Failed || preview_.error().code == ErrorCode::OutOfSpace;
}

} // namespace isoslider::model
