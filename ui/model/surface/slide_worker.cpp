#include "ui/model/surface/slide_worker.h"
#include "core/base/guarded.h"

#include <chrono>
#include <exception>
#include <new>

#include "ui/model/surface/coarse_picture.h"

namespace isoslider::model {
namespace {

constexpr auto kStopPollInterval = std::chrono::milliseconds(10);
constexpr auto kProgressInterval = std::chrono::milliseconds(100);

const ThrownErrors kMoveErrors{"not enough memory for this surface; choose another isovalue"};

} // namespace

SlideWorker::SlideWorker(Callbacks callbacks)
    : callbacks_(std::move(callbacks)), thread_([this](std::stop_token stop) { loop(stop); }) {}

SlideWorker::~SlideWorker() {
    thread_.request_stop();
    const std::lock_guard lock(mutex_);
    moveStop_.request_stop();
}

SourceGeneration SlideWorker::setSource(std::shared_ptr<SurfaceSource> source, DatasetGeneration dataset,
                                        std::optional<double> isovalue) {
    SourceGeneration generation{};
    {
        const std::lock_guard lock(mutex_);
        moveStop_.request_stop();
        moveStop_ = std::stop_source();
        // Letting go of a volume takes time, so the worker does it and not the caller.
        if (source_)
            retired_.push_back(std::move(source_));
        source_ = std::move(source);
        generation = generation_ = SourceGeneration{static_cast<std::uint64_t>(generation_) + 1};
        dataset_ = dataset;
        mailbox_ = isovalue;
        newPieces_.reset();
    }
    wake_.notify_all();
    return generation;
}

void SlideWorker::request(double isovalue) {
    {
        const std::lock_guard lock(mutex_);
        mailbox_ = isovalue;
    }
    wake_.notify_all();
}

void SlideWorker::cancelMove() {
    const std::lock_guard lock(mutex_);
    moveStop_.request_stop();
    moveStop_ = std::stop_source();
    mailbox_.reset();
}

SourceGeneration SlideWorker::beginAgain(double isovalue, std::shared_ptr<const extract::SurfacePieces> pieces) {
    SourceGeneration generation{};
    {
        const std::lock_guard lock(mutex_);
        newPieces_ = std::move(pieces);
        generation = generation_ = SourceGeneration{static_cast<std::uint64_t>(generation_) + 1};
        mailbox_ = isovalue;
    }
    wake_.notify_all();
    return generation;
}

Result<extract::SurfaceMesh> SlideWorker::takeMesh(DatasetGeneration dataset, const JobControl& job) {
    auto order = std::make_unique<MeshOrder>();
    order->dataset = dataset;
    order->job = job;
    auto answer = order->mesh.get_future();
    {
        const std::lock_guard lock(mutex_);
        if (order_)
            return makeError(ErrorCode::InvalidArgument, "another mesh is being made; try again when it is done");
        order_ = std::move(order);
    }
    wake_.notify_all();
    while (answer.wait_for(kStopPollInterval) != std::future_status::ready)
        if (job.isStopRequested())
            return cancelledError();
    try {
        return answer.get();
    } catch (const std::future_error&) { // the worker ended first
        return cancelledError();
    }
}

void SlideWorker::loop(std::stop_token stop) {
    Work work;
    while (waitForWork(stop, work)) {
        if (work.isovalue)
            move(work);
        else if (work.order)
            work.order->mesh.set_value(meshOf(work));
        work = {};
    }
    const std::lock_guard lock(mutex_);
    order_.reset();
}

bool SlideWorker::waitForWork(std::stop_token stop, Work& work) {
    std::unique_lock lock(mutex_);
    const auto mayMove = [this] { return mailbox_ && source_ && !isHeld_ && !isUnreceived_; };
    if (!wake_.wait(lock, stop, [&] { return mayMove() || order_ || !retired_.empty(); }))
        return false;
    work.retired = std::exchange(retired_, {});
    work.source = source_;
    work.generation = generation_;
    work.dataset = dataset_;
    work.stop = moveStop_.get_token();
    work.mergeBound = mergeBound_;
    work.region = region_;
    if (mailbox_ && source_) {
        work.isovalue = std::exchange(mailbox_, std::nullopt);
        work.pieces = std::exchange(newPieces_, nullptr);
    } else {
        work.order = std::move(order_);
    }
    return !stop.stop_requested();
}

Result<extract::SurfaceMesh> SlideWorker::meshOf(const Work& work) const {
    if (!work.source || work.dataset != work.order->dataset)
        return makeError(ErrorCode::InvalidArgument, "its volume has been closed or replaced");
    if (moved_ != work.generation)
        return makeError(ErrorCode::InvalidArgument, "there is no surface at this isovalue; choose another one");
    return guarded(kMoveErrors, [&] { return work.source->mesh(work.order->job); });
}

void SlideWorker::move(const Work& work) {
    auto frame = pool_.take();
    frame->marksChanges = marksChanges_;
    frame->findsPieces = findsPieces_;
    if (work.pieces)
        pieces_ = work.pieces;
    frame->pieces = frame->findsPieces && piecesOf_ == work.dataset ? pieces_ : nullptr;
    frame->geometry = piecesGeometry_;
    frame->mergeBound = work.mergeBound;
    frame->region = work.region;
    JobControl job;
    job.stop = work.stop;
    auto reported = std::chrono::steady_clock::now(); // moves that take no longer than that have no progress
    if (callbacks_.onProgress)
        job.progress = [&](double fraction, std::string_view) {
            const auto now = std::chrono::steady_clock::now();
            if (now - reported < kProgressInterval)
                return;
            reported = now;
            callbacks_.onProgress(fraction, work.generation);
        };
    const Status status = guarded(kMoveErrors, [&]() -> Status {
        ISO_TRY(work.source->moveTo(*work.isovalue, job, *frame));
        frame->mergedCells = 1;
        fitPicture(*frame, pictureLimit_);
        return {};
    });
    if (status.isOk()) {
        pieces_ = frame->pieces;
        piecesGeometry_ = frame->geometry;
        piecesOf_ = work.dataset;
    }
    moved_ = status.isOk() ? work.generation : SourceGeneration{};
    if (!isCurrent(work.generation))
        return;
    if (status.isOk() && callbacks_.waitsForReceipt) {
        const std::lock_guard lock(mutex_);
        isUnreceived_ = true;
    }
    if (status.isOk())
        callbacks_.onFrame(std::move(frame), work.generation);
    else if (!status.isCancelled())
        callbacks_.onError(status.error(), *work.isovalue, work.generation);
}

bool SlideWorker::isCurrent(SourceGeneration generation) {
    const std::lock_guard lock(mutex_);
    return generation == generation_;
}

} // namespace isoslider::model
