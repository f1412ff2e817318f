#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "ui/model/session/dataset.h"
#include "ui/model/surface/frame_pool.h"
#include "ui/model/surface/surface_source.h"

namespace isoslider::model {

/// Names the source that a frame came from; grows with every setSource.
enum class SourceGeneration : std::uint64_t {};

/// The thread that moves the surface. A mailbox holds the latest requested isovalue only: while one
/// move runs, newer requests replace each other, and the newest is served next. A running move is
/// finished, not cancelled, by a newer request, so a long drag still shows pictures on its way.
/// All members but takeMesh return at once; they may be called from any thread.
class SlideWorker {
public:
    /// The first two are called on the worker's thread.
    struct Callbacks {
        std::function<void(std::shared_ptr<const extract::SurfaceFrame>, SourceGeneration)> onFrame;
        /// With the isovalue that could not be moved to.
        std::function<void(Error, double, SourceGeneration)> onError;
        /// How far the running move is, 0 to 1; on any thread, every 100 ms at most. May be empty.
        std::function<void(double, SourceGeneration)> onProgress;
        /// After a frame no move begins until frameReceived(): else the next would be made before it is known whether
        /// what shows the frames keeps up, and be old when it is shown.
        bool waitsForReceipt = false;
    };

    explicit SlideWorker(Callbacks callbacks);
    /// Cancels the running move and waits for it. Waiting takeMesh calls return Cancelled.
    ~SlideWorker();

    /// Replaces the source (null: none) and cancels the running move; the pending request becomes `isovalue`.
    /// A data set may have several sources, one after the other.
    /// Frames of earlier generations may still be delivered once.
    SourceGeneration setSource(std::shared_ptr<SurfaceSource> source, DatasetGeneration dataset,
                               std::optional<double> isovalue);
    void request(double isovalue);
    /// Breaks off the running move, and no other is pending: neither callback is called for them. The next one starts
    /// from nothing.
    void cancelMove();
    /// As request(), for another surface of the same source: frames of moves that have begun are of an earlier
    /// generation. `pieces`: of a picture of that surface, whose numbers are kept; null for none.
    SourceGeneration beginAgain(double isovalue, std::shared_ptr<const extract::SurfacePieces> pieces);
    /// Frames from the next move on take at most `bytes`, see fitPicture; meshes are whole all the same.
    void limitPicture(std::uint64_t bytes) { pictureLimit_ = bytes; }
    /// Whether frames from the next move on state what that move has changed.
    void markChanges(bool isWanted) { marksChanges_ = isWanted; }
    /// Whether frames from the next move on state which triangles are connected.
    void findPieces(bool isWanted) { findsPieces_ = isWanted; }

    /// The frame that came last is where it is shown.
    void frameReceived() {
        {
            const std::lock_guard lock(mutex_);
            isUnreceived_ = false;
        }
        wake_.notify_all();
    }

    /// No move begins while held: what shows the frames has not caught up. A mesh that is asked for is made all the
    /// same.
    void hold(bool isHeld) {
        {
            const std::lock_guard lock(mutex_);
            isHeld_ = isHeld;
        }
        wake_.notify_all();
    }

    /// How far merged cells may differ in frames from the next move on, where the source can merge any.
    void mergeWithin(const extract::MergeBound& bound) {
        const std::lock_guard lock(mutex_);
        mergeBound_ = bound;
    }

    /// Where the surface is wanted in frames from the next move on, where the source can be bounded; none: everywhere.
    void boundTo(const std::optional<BrickBox>& region) {
        const std::lock_guard lock(mutex_);
        region_ = region;
    }

    /// The surface of `dataset` as a mesh, after all pending moves. Blocks: call it from a job, never the window.
    /// Errors: Cancelled; InvalidArgument once another data set has taken its place, and without a surface: the
    /// last move failed, or there was none.
    Result<extract::SurfaceMesh> takeMesh(DatasetGeneration dataset, const JobControl& job);

private:
    struct MeshOrder {
        DatasetGeneration dataset{};
        JobControl job;
        std::promise<Result<extract::SurfaceMesh>> mesh;
    };
    struct Work {
        std::shared_ptr<SurfaceSource> source;
        SourceGeneration generation{};
        DatasetGeneration dataset{};
        std::optional<double> isovalue;
        extract::MergeBound mergeBound;
        std::optional<BrickBox> region;
        std::unique_ptr<MeshOrder> order;
        std::stop_token stop;
        std::shared_ptr<const extract::SurfacePieces> pieces;
        std::vector<std::shared_ptr<SurfaceSource>> retired;
    };

    void loop(std::stop_token stop);
    bool waitForWork(std::stop_token stop, Work& work);
    void move(const Work& work);
    Result<extract::SurfaceMesh> meshOf(const Work& work) const;
    bool isCurrent(SourceGeneration generation);

    Callbacks callbacks_;
    FramePool pool_;
    std::atomic<std::uint64_t> pictureLimit_{std::numeric_limits<std::uint64_t>::max()};
    std::atomic<bool> marksChanges_{true};
    std::atomic<bool> findsPieces_{false};
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::shared_ptr<SurfaceSource> source_;
    std::vector<std::shared_ptr<SurfaceSource>> retired_;
    SourceGeneration generation_{};
    DatasetGeneration dataset_{};
    std::shared_ptr<const extract::SurfacePieces> pieces_; ///< of the last frame; these three of the worker's thread
    GridGeometry piecesGeometry_;
    DatasetGeneration piecesOf_{};
    std::shared_ptr<const extract::SurfacePieces> newPieces_; ///< to go on from at the next move
    SourceGeneration moved_{}; ///< whose last move succeeded; of the worker's thread
    std::optional<double> mailbox_;
    bool isHeld_ = false;
    bool isUnreceived_ = false; ///< a frame is on its way
    extract::MergeBound mergeBound_;
    std::optional<BrickBox> region_;
    std::unique_ptr<MeshOrder> order_;
    std::stop_source moveStop_;
    std::jthread thread_; // last: joins before the members above go
};

} // namespace isoslider::model
