#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/extract/surface_frame.h"
#include "core/mesh/certificate.h"
#include "ui/model/isovalue/isovalue_model.h"
#include "ui/model/jobs/job_model.h"
#include "ui/model/jobs/job_runner.h"
#include "ui/model/session/dataset.h"
#include "ui/model/session/notice.h"
#include "ui/model/session/session_services.h"
#include "ui/model/surface/detail_model.h"
#include "ui/model/surface/slide_worker.h"
#include "ui/model/topology/topology_model.h"

namespace isoslider::model {

enum class IndexState { None, Building, Ready, Failed, Cancelled };

/// One open volume and everything that happens to it: loading, index, slide, checks, export.
/// Window thread only; every call returns at once, results arrive through the observers.
/// Opening another volume keeps the present one until the new one has been read.
class Session {
public:
    explicit Session(SessionServices services);
    ~Session();

    void open(OpenRequest request);
    /// Stops opening; the present volume stays.
    void cancelOpening();
    void close();
    /// Starts the index build again after it failed or was cancelled.
    void buildIndex();
    void checkMesh();
    /// Writes the surface of the volume `of`, see datasetGeneration(). Once another one has taken its place nothing is
    /// written, and a notice reports it.
    void exportMesh(const std::filesystem::path& path, DatasetGeneration of);
    /// True, and a notice states why, while there is but a preview: its meshes are not exported.
    bool refusesExport();
    void cancelJob(JobId id);

    bool isLoading() const { return loadJob_.has_value(); }
    /// Of opening, in jobs(); null when nothing is being opened.
    const JobEntry* loading() const { return loadJob_ ? jobs_.find(*loadJob_) : nullptr; }
    const SessionServices& services() const { return services_; }
    /// Nothing is being read, built, checked, written or moved.
    bool isSettled() const;
    /// The surface asked for is still to come. False once it is shown, or moving there has failed.
    bool isMoving() const;
    const Dataset* dataset() const { return dataset_ ? &*dataset_ : nullptr; }
    /// Differs between any two volumes opened in this session.
    DatasetGeneration datasetGeneration() const { return datasetGeneration_; }
    IndexState indexState() const { return indexState_; }
    /// The volume is too large for memory and has no index yet: coarse samples stand in for it.
    bool isPreview() const;
    /// Above 1: the surface on screen is that of every n-th sample along each axis.
    std::int64_t shownStep() const;
    /// Shows the surface, and all that follow of this volume, by pictures of at most so many bytes: larger ones are
    /// coarser, see SurfaceFrame::mergedCells. Meshes are checked and exported whole all the same.
    void limitPicture(std::uint64_t bytes);
    /// Whether frames state what the last move has changed, from the next move on: it takes time to list.
    void markChanges(bool isWanted) { worker_->markChanges(isWanted); }
    /// Null until the first surface.
    std::shared_ptr<const extract::SurfaceFrame> frame() const { return frame_; }
    IsovalueModel& isovalue() { return isovalue_; }
    /// How far the surface may differ; it follows where it can, see SurfaceFrame::canMerge.
    DetailModel& detail() { return detail_; }
    /// Analysed once the index is there.
    TopologyModel& topology() { return topology_; }
    /// Of the analysis, in jobs(); null when there is none under way.
    const JobEntry* analysing() const { return topologyJob_ ? jobs_.find(*topologyJob_) : nullptr; }
    const JobModel& jobs() const { return jobs_; }
    JobModel& jobs() { return jobs_; }
    /// Of the surface that was checked or exported last.
    const std::optional<mesh::Certificate>& certificate() const { return certificate_; }
    bool isCheckingMesh() const { return isCheckingMesh_; }

    const Observable<>& datasetChanged() const { return datasetChanged_; } ///< dataset, loading or index state
    const Observable<>& frameChanged() const { return frameChanged_; }
    const Observable<>& certificateChanged() const { return certificateChanged_; }
    const Observable<const Notice&>& noticePosted() const { return noticePosted_; }
    void post(const Notice& notice) { noticePosted_.notify(notice); }
    /// A request that asksForChoice cannot be opened before one is made; nothing is open that was not before.
    const Observable<const OpenRequest&, const io::VolumeContents&>& choiceNeeded() const { return choiceNeeded_; }

private:
    struct FrameSlot;
    struct OpenedIndex {
        index::IndexInfo info;
        std::shared_ptr<SurfaceSource> source;
    };

    /// What opening a file came to: a volume, or what the user must choose from.
    struct Opened {
        std::optional<LoadedDataset> loaded;
        io::VolumeContents contents;
    };

    static Result<Opened> openOrAsk(const OpenRequest& request, const SessionServices& services,
                                    const IndexCache& cache, const JobControl& job);
    void onOpened(Result<Opened> opened, const OpenRequest& request);
    void adopt(LoadedDataset loaded);
    void startIndexBuild();
    void onIndexBuilt(const Status& status);
    void openBuiltIndex();
    void useIndex(OpenedIndex opened);
    void forgetDataset();
    void analyseTopology();
    bool refusesMesh(const std::string& title, const std::string& verb);
    void useSource(std::shared_ptr<SurfaceSource> source);
    void takeFrame();
    void requestMove(double isovalue);
    void mergeCells();
    extract::MergeBound wantedBound() const;
    void redraw();
    bool hasMoveFailed() const;
    void onSlideError(const Error& error, double isovalue, SourceGeneration generation);
    void onExported(const std::filesystem::path& path, DatasetGeneration of, mesh::Certificate certificate);
    void fail(const std::string& title, const Error& error);
    SlideWorker::Callbacks workerCallbacks();

    SessionServices services_;
    IndexCache cache_;
    IsovalueModel isovalue_;
    DetailModel detail_;
    TopologyModel topology_;
    JobModel jobs_;
    std::optional<Dataset> dataset_;
    std::optional<double> firstIsovalue_; ///< asked for in opening; none once the handle has moved
    std::shared_ptr<const ScalarGrid> grid_; ///< until the index is there
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::optional<double> failedIsovalue_; ///< of the last move, if it failed
    IndexState indexState_ = IndexState::None;
    std::optional<JobId> loadJob_;
    std::optional<JobId> indexJob_;
    std::optional<JobId> topologyJob_;
    std::optional<mesh::Certificate> certificate_;
    bool isCheckingMesh_ = false;
    bool isPictureComing_ = false; ///< another one of the same surface was asked for
    std::uint64_t loadTicket_ = 0; ///< distinguishes a superseded load from the present one
    DatasetGeneration datasetGeneration_{}; ///< distinguishes results about an earlier volume from present ones
    ObserverList<> datasetChanged_;
    ObserverList<> frameChanged_;
    ObserverList<> certificateChanged_;
    ObserverList<const Notice&> noticePosted_;
    ObserverList<const OpenRequest&, const io::VolumeContents&> choiceNeeded_;
    Subscription requestSubscription_;
    Subscription detailSubscription_;
    std::shared_ptr<FrameSlot> slot_;
    SourceGeneration generation_{};
    std::unique_ptr<SlideWorker> worker_;
    std::unique_ptr<JobRunner> runner_; // last: jobs use the worker
};

} // namespace isoslider::model
