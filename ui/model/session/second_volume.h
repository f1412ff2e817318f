#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "ui/model/jobs/job_runner.h"
#include "ui/model/observers.h"
#include "ui/model/session/dataset.h"
#include "ui/model/session/named_volume.h"
#include "ui/model/session/notice.h"
#include "ui/model/session/session_services.h"
#include "ui/model/session/volume_opening.h"
#include "ui/model/surface/inactive_surfaces.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::model {

/// Whether a plane through a face of `volume` has all of `other` beyond it: then no place is in both.
bool liesApart(const GridGeometry& other, const GridGeometry& volume);

/// A second volume in the space of the first, with a separate grid and separate surfaces. None of them slides: each is
/// extracted by a job when its isovalue is set, see InactiveSurfaces. Slices, pieces, topology, checks and exports
/// remain those of the first. It gets no index, but uses one that the cache has; what does not fit in memory is shown
/// by every n-th sample, see Dataset::coarseStep.
///
/// Window thread only; everything it is given must outlive it.
class SecondVolume {
public:
    /// `first`: the surfaces of the first volume, whose colours are not given again.
    SecondVolume(JobRunner& runner, const SessionServices& services, const IndexCache& cache,
                 const SurfacesModel& first, std::function<void(const Notice&)> post);

    /// The present one stays until this one has been read.
    void open(const OpenRequest& request);
    void close();
    /// Of an undo or a session: opens the volume that it names unless it is there, closes it if it names none.
    void setState(const SecondVolumeState& state);
    /// What setState() asked for counts as soon as it is asked for, what open() did once it is there.
    SecondVolumeState state() const;

    /// Null without one.
    const Dataset* dataset() const { return dataset_ ? &*dataset_ : nullptr; }
    /// The name of what is being opened; empty for nothing.
    const std::string& opening() const { return opening_; }
    /// Of it; the active one is the one that is selected.
    SurfacesModel& surfaces() { return surfaces_; }
    const SurfacesModel& surfaces() const { return surfaces_; }
    /// At an isovalue apart from the others.
    void addSurface();
    /// Null while it is not known.
    std::shared_ptr<const extract::SurfaceFrame> pictureOf(SurfaceId id) const { return pictures_.find(id); }

    /// See Session::limitPicture().
    void limitPicture(std::uint64_t bytes);
    /// Of the range of its values, where it is in percent.
    void mergeWithin(const extract::MergeError& error);
    bool isBusy() const { return loadJob_.has_value() || pictures_.isBusy(); }

    /// Which volume, what is being opened, or pictures.
    const Observable<>& changed() const { return changed_; }
    /// As Session::choiceNeeded().
    const Observable<const OpenRequest&, const io::VolumeContents&>& choiceNeeded() const { return choiceNeeded_; }

private:
    void stopOpening();
    void forget();
    void load(const OpenRequest& request);
    void onOpened(Result<OpenedVolume> opened, const OpenRequest& request);
    void adopt(LoadedDataset loaded);
    void followSurfaces();
    SurfaceColour freeColour() const;

    JobRunner& runner_;
    const SessionServices& services_;
    const IndexCache& cache_;
    const SurfacesModel& first_;
    std::function<void(const Notice&)> post_;
    SecondVolumeState wanted_; ///< whose surfaces count until the volume is there
    std::optional<Dataset> dataset_;
    SurfacesModel surfaces_;
    std::uint64_t pictureLimit_ = std::numeric_limits<std::uint64_t>::max();
    extract::MergeError error_;
    std::optional<JobId> loadJob_;
    std::string opening_;
    std::uint64_t ticket_ = 0; ///< distinguishes a superseded load from the present one
    ObserverList<> changed_;
    ObserverList<const OpenRequest&, const io::VolumeContents&> choiceNeeded_;
    InactiveSurfaces pictures_;
    Subscription surfacesSubscription_, picturesSubscription_;
};

} // namespace isoslider::model
