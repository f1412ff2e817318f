#pragma once

#include <optional>

#include "ui/model/opening/preview_model.h"
#include "ui/model/opening/volume_choice.h"

namespace isoslider::model {

/// A file or folder before it is opened: what it holds, what is chosen of it, and how that looks. Lists and
/// reads on workers. Window thread only.
class OpenModel {
public:
    enum class State { Listing, Ready, Failed };

    /// Begins to list the volumes of `path`.
    OpenModel(std::filesystem::path path, std::shared_ptr<BackgroundJobs> jobs, VolumeAccess volumes);
    /// With what is known of it already.
    OpenModel(std::filesystem::path path, io::VolumeContents contents, std::shared_ptr<BackgroundJobs> jobs,
              VolumeAccess volumes);

    const std::filesystem::path& path() const { return path_; }
    State state() const { return state_; }
    const Error& error() const { return error_; } ///< REQUIRES: Failed
    /// Null unless Ready.
    const VolumeChoice* choice() const { return choice_ ? &*choice_ : nullptr; }
    const PreviewModel& preview() const { return preview_; }
    /// The chosen volume can be opened, as far as is known.
    bool canOpen() const;

    /// Changes the choice, and the preview with it. Nothing without a choice.
    void change(const std::function<void(VolumeChoice&)>& function);

    const Observable<>& changed() const { return changed_; } ///< contents, choice or preview

private:
    void onListed(Result<io::VolumeContents> contents);
    void showPreview();

    std::filesystem::path path_;
    State state_ = State::Listing;
    Error error_;
    std::optional<VolumeChoice> choice_;
    std::optional<io::ReadOptions> shown_; ///< options of the preview
    ObserverList<> changed_;
    PreviewModel preview_;
    Subscription previewSubscription_;
    LatestJob<io::VolumeContents> listing_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
