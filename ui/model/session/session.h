#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/extract/pieces/surface_pieces.h"
#include "core/extract/surface_frame.h"
#include "core/mesh/certificate.h"
#include "core/topology/index_topology.h"
#include "ui/model/isovalue/first_isovalue.h"
#include "ui/model/isovalue/histogram_options.h"
#include "ui/model/isovalue/isovalue_model.h"
#include "ui/model/jobs/job_model.h"
#include "ui/model/jobs/job_runner.h"
#include "ui/model/session/dataset.h"
#include "ui/model/session/notice.h"
#include "ui/model/session/second_volume.h"
#include "ui/model/session/session_services.h"
#include "ui/model/session/volume_opening.h"
#include "ui/model/surface/clipped_mesh.h"
#include "ui/model/surface/detail_model.h"
#include "ui/model/surface/inactive_surfaces.h"
#include "ui/model/surface/slide_worker.h"
#include "ui/model/surface/surface_list.h"
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
    /// written, and a notice reports it. `remark` is put behind the notice of a success.
    void exportMesh(const std::filesystem::path& path, DatasetGeneration of, std::string remark = {});
    /// What of the surface is written: all, or what of it is shown.
    struct ExportPart {
        struct Pieces {
            std::vector<extract::Piece> kept;
            double isovalue = 0.0; ///< at which they were found
        };
        std::optional<Pieces> pieces; ///< none: all
        Clipping clipping;
        CropSides sides = CropSides::Open;
    };
    /// The same of a part of the surface; with pieces it fails if the surface has moved on by then. The certificate
    /// shown stays that of the whole. What is cut through triangles is written without a check.
    void exportPart(const std::filesystem::path& path, DatasetGeneration of, ExportPart part);
    /// The same of a surface that does not slide, which is extracted for it.
    void exportInactive(const std::filesystem::path& path, DatasetGeneration of, SurfaceId surface, ExportPart part);
    /// True, and a notice states why, while there is but a preview: its meshes are not exported.
    bool refusesExport();
    void cancelJob(JobId id);
    /// For work on the volume that is shown among its jobs. What it reports to must ask whether it is still there.
    JobRunner& runner() { return *runner_; }

    bool isLoading() const { return loadJob_.has_value(); }
    /// Of opening, in jobs(); null when nothing is being opened.
    const JobEntry* loading() const { return loadJob_ ? jobs_.find(*loadJob_) : nullptr; }
    const SessionServices& services() const { return services_; }
    const IndexCache& indexCache() const { return cache_; }
    /// Nothing is being read, built, checked, written or moved.
    bool isSettled() const;
    /// The surface asked for is still to come. False once it is shown, or moving there has failed.
    bool isMoving() const;
    /// How far the move that is under way is, 0 to 1; 0 as long as that is not known.
    double moveProgress() const { return moveProgress_; }
    /// Breaks off the move under way. What is on screen stays; without a surface there is none until another isovalue
    /// is asked for, or this one again.
    void stopMove();
    /// Asks once more for the surface whose move was stopped or has failed.
    void moveAgain();
    bool hasMoveFailed() const;
    bool hasStoppedMove() const { return isMoveStopped_ && hasMoveFailed(); }
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
    /// No move begins while held: what shows the surface has not caught up, and the processor is better left to it.
    void holdMoves(bool isHeld) { worker_->hold(isHeld); }
    /// Whether frames state what the last move has changed, from the next move on: it takes time to list.
    void markChanges(bool isWanted) { worker_->markChanges(isWanted); }
    /// Whether frames state which triangles are connected; the surface on screen is asked for again if it does not.
    void findPieces(bool isWanted);
    /// The volume in memory, or a preview of it, see Dataset::coarseStep; null once the index is there.
    std::shared_ptr<const ScalarGrid> samples() const { return grid_; }
    /// Where surfaces are looked at; none: everywhere. What slides is made there only, where that can be; pieces and
    /// meshes are of the whole surface all the same.
    void lookAt(const std::optional<CropBox>& box);
    /// Null until the first surface.
    std::shared_ptr<const extract::SurfaceFrame> frame() const { return frame_; }
    IsovalueModel& isovalue() { return isovalue_; }
    /// All surfaces of the volume. isovalue() is that of the active one, which is the surface of everything else here.
    SurfacesModel& surfaces() { return surfaces_; }
    const SurfacesModel& surfaces() const { return surfaces_; }
    /// What to draw of a surface, of the active one as well: null while nothing of it is known.
    std::shared_ptr<const extract::SurfaceFrame> pictureOf(SurfaceId id) const;
    /// The last that are known of a surface; null for none.
    std::shared_ptr<const extract::SurfacePieces> piecesOf(SurfaceId id) const;
    /// Another one becomes active, at an isovalue apart from the others.
    void addSurface();
    /// What lies beside the volume; it is closed with it.
    SecondVolume& secondVolume() { return *second_; }
    const SecondVolume& secondVolume() const { return *second_; }
    /// What the volume was opened with, until the handle moves.
    FirstIsovalue& firstIsovalue() { return firstIsovalue_; }
    /// Why the isovalue that the volume was opened with is not the one asked for; see FirstIsovalue::noteOnAsked.
    std::string noteOnFirstIsovalue() const {
        return dataset_ ? firstIsovalue_.noteOnAsked(dataset_->min, dataset_->max) : std::string();
    }
    /// Isovalues worth a look, the best first: of the histogram, and of the topology once it is known.
    std::vector<SuggestedIsovalue> suggestions() const;
    /// Moves to the best of them once the topology is known, if the first isovalue may give way to it.
    void improveFirstIsovalue();
    HistogramOptionsModel& histogramOptions() { return histogramOptions_; }
    /// How far the surface may differ; one that was extracted whole does not follow.
    DetailModel& detail() { return detail_; }
    /// Analysed once the index is there.
    TopologyModel& topology() { return topology_; }
    const TopologyModel& topology() const { return topology_; }
    /// Of the analysis, in jobs(); null when there is none under way.
    const JobEntry* analysing() const { return topologyJob_ ? jobs_.find(*topologyJob_) : nullptr; }
    const JobModel& jobs() const { return jobs_; }
    JobModel& jobs() { return jobs_; }
    /// Of the surface that was checked or exported last.
    const std::optional<mesh::Certificate>& certificate() const { return certificate_; }
    bool isCheckingMesh() const { return isCheckingMesh_; }

    const Observable<>& datasetChanged() const { return datasetChanged_; } ///< dataset, loading or index state
    const Observable<>& frameChanged() const { return frameChanged_; }
    const Observable<>& moveProgressChanged() const { return moveProgressChanged_; }
    /// Those that do not slide.
    const Observable<>& inactiveChanged() const { return inactive_->changed(); }
    const Observable<>& certificateChanged() const { return certificateChanged_; }
    const Observable<const Notice&>& noticePosted() const { return noticePosted_; }
    void post(const Notice& notice) { noticePosted_.notify(notice); }
    /// A request that asksForChoice cannot be opened before one is made; nothing is open that was not before.
    const Observable<const OpenRequest&, const io::VolumeContents&>& choiceNeeded() const { return choiceNeeded_; }

private:
    /// Between the worker and the window: the newest frame only, and at most one message on its way.
    struct FrameSlot {
        std::mutex mutex;
        std::shared_ptr<const extract::SurfaceFrame> frame;
        SourceGeneration generation{};
        bool isPosted = false;
    };
    struct OpenedIndex {
        index::IndexInfo info;
        std::optional<ValueDistribution> values; ///< where those of a preview were known
        std::shared_ptr<SurfaceSource> source;
    };

    void onOpened(Result<OpenedVolume> opened, const OpenRequest& request);
    void adopt(LoadedDataset loaded);
    void startIndexBuild();
    void onIndexBuilt(const Status& status);
    void openBuiltIndex();
    void useIndex(OpenedIndex opened);
    void forgetDataset();
    using FindTopology = std::function<Result<topology::IndexTopology>(
        const std::filesystem::path& index, const topology::AnalysisOptions& options, const JobControl& job)>;
    struct FoundTopology {
        TopologyModel::Content content;
        bool isNew; ///< see topology::IndexTopology
    };
    void analyseTopology();
    void addEvents();
    void startTopology(const std::string& name, const FindTopology& find,
                       const std::function<void(Result<FoundTopology>)>& use);
    void countValues();
    bool refusesMesh(const std::string& title, const std::string& verb);
    void useSource(std::shared_ptr<SurfaceSource> source);
    void takeFrame();
    void requestMove(double isovalue);
    void mergeCells();
    extract::MergeBound wantedBound() const;
    std::optional<BrickBox> wantedRegion() const;
    bool isAsWanted(const extract::SurfaceFrame& frame) const;
    extract::MergeBound boundAtRest() const; ///< without what is coarser while moving
    void redraw();
    void followSurfaces();
    void changeActive(SurfaceId before, const ListedSurface& active);
    void setMaking();
    SourceOpener sourceOpener() const;
    void setMoveProgress(double fraction);
    void onSlideError(const Error& error, double isovalue, SourceGeneration generation);
    using TakeMesh = std::function<Result<extract::SurfaceMesh>(const JobControl&)>;
    TakeMesh takeActive() const;
    void exportSurface(const std::filesystem::path& path, DatasetGeneration of, std::optional<ExportPart> part,
                       TakeMesh take, std::string remark = {});
    void onExported(const std::filesystem::path& path, DatasetGeneration of, mesh::Certificate certificate,
                    bool isWhole, const std::string& remark);
    void fail(const std::string& title, const Error& error);
    SlideWorker::Callbacks workerCallbacks();

    SessionServices services_;
    IndexCache cache_;
    IsovalueModel isovalue_;
    SurfacesModel surfaces_;
    std::optional<SurfaceId> active_; ///< whose isovalue is isovalue_
    bool isFrameOfActive_ = true; ///< not that of the one that slid before
    std::shared_ptr<const extract::SurfaceFrame> standIn_; ///< of the active one until its frame is there
    HistogramOptionsModel histogramOptions_;
    DetailModel detail_;
    TopologyModel topology_;
    JobModel jobs_;
    std::optional<Dataset> dataset_;
    FirstIsovalue firstIsovalue_;
    std::shared_ptr<const ScalarGrid> grid_; ///< until the index is there
    std::shared_ptr<const extract::SurfaceFrame> frame_;
    std::uint64_t pictureLimit_ = std::numeric_limits<std::uint64_t>::max();
    std::optional<double> failedIsovalue_; ///< of the last move, if it failed
    bool isMoveStopped_ = false; ///< it failed because the user stopped it
    std::optional<CropBox> lookedAt_;
    double moveProgress_ = 0.0;
    IndexState indexState_ = IndexState::None;
    std::optional<JobId> loadJob_;
    std::optional<JobId> indexJob_;
    std::optional<JobId> topologyJob_;
    std::optional<JobId> valuesJob_;
    bool areValuesCounted_ = false; ///< or being counted
    std::optional<mesh::Certificate> certificate_;
    bool isCheckingMesh_ = false;
    bool isPictureComing_ = false; ///< another one of the same surface was asked for
    std::uint64_t loadTicket_ = 0; ///< distinguishes a superseded load from the present one
    DatasetGeneration datasetGeneration_{}; ///< distinguishes results about an earlier volume from present ones
    ObserverList<> datasetChanged_;
    ObserverList<> frameChanged_;
    ObserverList<> moveProgressChanged_;
    ObserverList<> certificateChanged_;
    ObserverList<const Notice&> noticePosted_;
    ObserverList<const OpenRequest&, const io::VolumeContents&> choiceNeeded_;
    Subscription requestSubscription_;
    Subscription detailSubscription_;
    Subscription surfacesSubscription_;
    std::shared_ptr<FrameSlot> slot_;
    SourceGeneration generation_{};
    std::unique_ptr<SlideWorker> worker_;
    std::unique_ptr<InactiveSurfaces> inactive_;
    std::unique_ptr<SecondVolume> second_;
    std::unique_ptr<JobRunner> runner_; // last: jobs use the worker
};

} // namespace isoslider::model
