#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "core/extract/merged/merge_bound.h"
#include "core/extract/surface_frame.h"
#include "ui/model/jobs/job_runner.h"
#include "ui/model/jobs/latest_job.h"
#include "ui/model/surface/surface_list.h"
#include "ui/model/surface/surface_source.h"

namespace isoslider::model {

/// Pictures of the surfaces that do not slide.
///
/// There is one live surface, that of the active one. An inactive surface is a picture only: what the graphics card
/// needs and nothing else, some 35 bytes for an active edge where a live surface takes 100 to 200. It costs nothing
/// while the handle moves, for nothing refers to it but the drawing; it is in memory, so a context that was lost gets
/// it again. It comes about in two ways. A surface that stops being active leaves its last picture behind, of which a
/// job makes a copy: the picture itself is of the live surface's memory, which could be used no further as long as
/// somebody looks at it. Where there is no such picture (a session, an undo, another error), a job makes one with an
/// engine of its own, which is gone afterwards. The live surface is never borrowed for that: handle, pieces and marks
/// of changes do not notice. Hidden surfaces get theirs when they are shown. The alternative, a live surface for each,
/// would make a change of the active one instant; here it is a jump, while the picture that is there already stays on
/// screen.
///
/// Window thread only.
class InactiveSurfaces {
public:
    using Frame = std::shared_ptr<const extract::SurfaceFrame>;
    /// How pictures are made.
    struct Making {
        SourceOpener openSource; ///< used on a worker thread
        GridGeometry geometry; ///< what the source will be of
        extract::MergeBound bound;
        std::uint64_t pictureLimit = std::numeric_limits<std::uint64_t>::max(); ///< see fitPicture()

        /// Whether that picture is what would be made.
        bool isAsGood(const extract::SurfaceFrame& frame) const;
    };
    using Failed = std::function<void(const ListedSurface&, const Error&)>;

    /// Making pictures is listed among the jobs of `runner`, copying them is not.
    InactiveSurfaces(JobRunner& runner, MainThread postToMain, Failed failed);

    /// Of a volume, or of what is known of it now; pictures made otherwise stay until new ones take their place.
    void setMaking(Making making);
    void change(const std::function<void(Making&)>& change);
    void clear();
    /// The last picture of a surface that slid so far.
    void keep(SurfaceId id, Frame frame);
    using Pieces = std::shared_ptr<const extract::SurfacePieces>;
    /// The last that are known of a surface, removed ones included: their numbers are kept from picture to picture.
    /// Null for none.
    Pieces piecesOf(SurfaceId id) const;
    /// Makes what is missing, forgets what is not listed any more.
    void follow(const SurfaceList& list);

    /// As far as it is known: null, or of an isovalue before, until it is.
    Frame find(SurfaceId id) const;
    bool isBusy() const { return job_.has_value() || copying_.isRunning(); }
    const Observable<>& changed() const { return changed_; }

private:
    struct Held {
        Frame frame;
        bool isSeparate = false; ///< from the live surface's memory
        std::uint64_t madeBy = 0; ///< the number of the making that it comes from
        std::optional<double> failedAt; ///< an isovalue that there is no picture of
    };
    struct Job {
        JobId id;
        SurfaceId surface;
        double isovalue;
        std::uint64_t making;
        bool findsPieces;
    };

    bool isWanted(const ListedSurface& surface) const;
    bool isThere(const ListedSurface& surface) const;
    void keepPieces(SurfaceId id, const extract::SurfaceFrame& frame);
    void work();
    void copy(SurfaceId id);
    void make(const ListedSurface& surface);
    void onMade(Result<Frame> frame);

    JobRunner& runner_;
    Failed failed_;
    std::optional<Making> how_;
    std::uint64_t making_ = 0; ///< number of how_
    SurfaceList list_;
    std::map<SurfaceId, Held> held_;
    struct KnownPieces {
        Pieces pieces;
        GridGeometry geometry;
    };
    std::map<SurfaceId, KnownPieces> pieces_; ///< outlives held_: a surface that was removed may come back
    std::optional<Job> job_;
    std::uint64_t ticket_ = 0; ///< results of jobs begun before are not wanted
    ObserverList<> changed_;
    std::shared_ptr<BackgroundJobs> background_;
    LatestJob<Frame> copying_; // last: nothing is reported once it is gone
};

} // namespace isoslider::model
