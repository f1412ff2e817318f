#pragma once

#include <optional>

#include "ui/model/jobs/latest_job.h"
#include "ui/model/opening/volume_preview.h"

namespace isoslider::model {

/// The preview that a dialog shows: read on a worker, the newest request wins. Window thread only.
class PreviewModel {
public:
    enum class State { Empty, Loading, Ready, Failed };

    PreviewModel(std::shared_ptr<BackgroundJobs> jobs, VolumeAccess volumes);

    /// Reads another preview; the one shown so far stays until it is there.
    void show(const std::filesystem::path& path, const io::ReadOptions& options);
    /// Forgets the preview, and cancels what is being read.
    void clear();

    State state() const { return state_; }
    /// Null before the first one is there, and after a failure.
    const VolumePreview* preview() const { return preview_ ? &*preview_ : nullptr; }
    const Error& error() const { return error_; } ///< REQUIRES: Failed
    double fraction() const { return job_.fraction(); } ///< 0 to 1, while Loading

    const Observable<>& changed() const { return changed_; }

private:
    void onRead(Result<VolumePreview> preview);

    VolumeAccess volumes_;
    State state_ = State::Empty;
    std::optional<VolumePreview> preview_;
    Error error_;
    ObserverList<> changed_;
    Subscription progress_;
    LatestJob<VolumePreview> job_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
