#include "ui/model/surface/slide_worker.h"

#include <atomic>
#include <semaphore>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/unit/ui/main_thread_queue.h"

namespace isoslider::model {
namespace {

/// Moves only when the test opens the gate, and remembers every isovalue it was asked for.
class GatedSource final : public SurfaceSource {
public:
    Status moveTo(double isovalue, const JobControl& job, extract::SurfaceFrame& frame) override {
        {
            const std::lock_guard lock(mutex_);
            moves_.push_back(isovalue);
        }
        started.release();
        while (!gate.try_acquire_for(std::chrono::milliseconds(1))) {
            job.report(0.25, "waiting");
            if (job.isStopRequested())
                return cancelledError();
        }
        if (isovalue < 0.0)
            return makeError(ErrorCode::Corruption, "bad page");
        if (isovalue > 1000.0)
            throw std::runtime_error("thrown");
        frame.isovalue = isovalue;
        frame.positions.resize(1000);
        return {};
    }
    Result<extract::SurfaceMesh> mesh(const JobControl&) override {
        extract::SurfaceMesh mesh;
        const std::lock_guard lock(mutex_);
        mesh.isovalue = moves_.empty() ? -1.0 : moves_.back();
        return mesh;
    }
    std::vector<double> moves() {
        const std::lock_guard lock(mutex_);
        return moves_;
    }

    std::counting_semaphore<> started{0};
    std::counting_semaphore<> gate{0};

private:
    std::mutex mutex_;
    std::vector<double> moves_;
};

class SlideWorkerTest : public ::testing::Test {
protected:
    SlideWorkerTest() {
        SlideWorker::Callbacks callbacks;
        callbacks.onFrame = [this, post = queue_.poster()](auto frame, SourceGeneration generation) {
            post([this, frame, generation] {
                shown_.push_back(frame->isovalue);
                lastGeneration_ = generation;
                if (sendsReceipts_)
                    worker_->frameReceived();
            });
        };
        callbacks.waitsForReceipt = true;
        callbacks.onError = [this, post = queue_.poster()](const Error& error, double isovalue, SourceGeneration) {
            post([this, error, isovalue] {
                errors_.push_back(error.code);
                failed_.push_back(isovalue);
            });
        };
        callbacks.onProgress = [this, post = queue_.poster()](double fraction, SourceGeneration) {
            post([this, fraction] { progress_.push_back(fraction); });
        };
        worker_ = std::make_unique<SlideWorker>(std::move(callbacks));
        generation_ = worker_->setSource(source_, kDataset, std::nullopt);
    }

    static constexpr DatasetGeneration kDataset{1};

    test::MainThreadQueue queue_;
    std::shared_ptr<GatedSource> source_ = std::make_shared<GatedSource>();
    std::vector<double> shown_;
    bool sendsReceipts_ = true;
    std::vector<ErrorCode> errors_;
    std::vector<double> failed_;
    std::vector<double> progress_;
    SourceGeneration generation_{};
    SourceGeneration lastGeneration_{};
    std::unique_ptr<SlideWorker> worker_;
};

TEST_F(SlideWorkerTest, NewestRequestWinsAndTheOnesBetweenAreDropped) {
    worker_->request(1.0);
    source_->started.acquire();
    for (const double isovalue : {2.0, 3.0, 4.0, 5.0})
        worker_->request(isovalue);
    source_->gate.release(2);
    ASSERT_TRUE(queue_.runUntil([&] { return shown_.size() == 2; }));
    EXPECT_EQ(shown_, (std::vector<double>{1.0, 5.0}));
    EXPECT_EQ(source_->moves(), (std::vector<double>{1.0, 5.0}));
    EXPECT_EQ(lastGeneration_, generation_);
}

TEST_F(SlideWorkerTest, BeginsNoMoveUntilTheFrameBeforeIsReceived) {
    sendsReceipts_ = false;
    source_->gate.release(2);
    worker_->request(1.0);
    ASSERT_TRUE(queue_.runUntil([&] { return shown_.size() == 1; }));
    worker_->request(2.0);
    worker_->request(3.0);
    EXPECT_FALSE(queue_.runUntil([&] { return source_->moves().size() == 2; }, std::chrono::milliseconds(50)));
    worker_->hold(true);
    worker_->frameReceived();
    EXPECT_FALSE(queue_.runUntil([&] { return source_->moves().size() == 2; }, std::chrono::milliseconds(50)));
    worker_->hold(false);
    ASSERT_TRUE(queue_.runUntil([&] { return shown_.size() == 2; }));
    EXPECT_EQ(shown_.back(), 3.0) << "the newest, not the one that was asked for first";
}

TEST_F(SlideWorkerTest, WaitsForNoReceiptOfAMoveThatFailed) {
    sendsReceipts_ = false;
    source_->gate.release(2);
    worker_->request(-1.0);
    ASSERT_TRUE(queue_.runUntil([&] { return !failed_.empty(); }));
    worker_->request(2.0);
    EXPECT_TRUE(queue_.runUntil([&] { return shown_.size() == 1; }));
}

TEST_F(SlideWorkerTest, ReportsErrorsAndGoesOn) {
    source_->gate.release(3);
    worker_->request(-1.0);
    ASSERT_TRUE(queue_.runUntil([&] { return errors_.size() == 1; }));
    EXPECT_EQ(errors_[0], ErrorCode::Corruption);
    worker_->request(2000.0);
    ASSERT_TRUE(queue_.runUntil([&] { return errors_.size() == 2; }));
    EXPECT_EQ(failed_, (std::vector<double>{-1.0, 2000.0}));
    worker_->request(7.0);
    ASSERT_TRUE(queue_.runUntil([&] { return shown_.size() == 1; }));
    EXPECT_EQ(shown_[0], 7.0);
}

TEST_F(SlideWorkerTest, ANewSourceCancelsTheRunningMove) {
    worker_->request(1.0);
    source_->started.acquire();
    auto next = std::make_shared<GatedSource>();
    next->gate.release(1);
    const auto generation = worker_->setSource(next, DatasetGeneration{2}, std::nullopt);
    EXPECT_NE(generation, generation_);
    worker_->request(9.0);
    ASSERT_TRUE(queue_.runUntil([&] { return !shown_.empty(); }));
    EXPECT_EQ(shown_, std::vector<double>{9.0});
    EXPECT_EQ(lastGeneration_, generation);
    EXPECT_TRUE(errors_.empty());
}

TEST_F(SlideWorkerTest, ReportsProgressNowAndThen) {
    const auto start = std::chrono::steady_clock::now();
    worker_->request(1.0);
    ASSERT_TRUE(queue_.runUntil([&] { return progress_.size() == 3; }));
    EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(295)) << "the window has other work";
    EXPECT_EQ(progress_, std::vector<double>(3, 0.25));
    source_->gate.release(1);
    ASSERT_TRUE(queue_.runUntil([&] { return shown_.size() == 1; }));
}

TEST_F(SlideWorkerTest, ACancelledMoveReportsNothingAndTheNextOneComes) {
    worker_->request(1.0);
    source_->started.acquire();
    worker_->request(2.0);
    worker_->cancelMove();
    worker_->request(3.0);
    source_->started.acquire();
    source_->gate.release(1);
    ASSERT_TRUE(queue_.runUntil([&] { return !shown_.empty(); }));
    EXPECT_EQ(shown_, std::vector<double>{3.0});
    EXPECT_EQ(source_->moves(), (std::vector<double>{1.0, 3.0}));
    EXPECT_TRUE(errors_.empty());
    EXPECT_EQ(lastGeneration_, generation_);
}

TEST_F(SlideWorkerTest, LetsGoOfTheOldSource) {
    const std::weak_ptr<GatedSource> old = source_;
    source_.reset();
    worker_->setSource(nullptr, DatasetGeneration{2}, std::nullopt);
    EXPECT_TRUE(queue_.runUntil([&] { return old.expired(); }));
}

TEST_F(SlideWorkerTest, GivesTheMeshAfterPendingMoves) {
    source_->gate.release(1);
    worker_->request(3.0);
    auto mesh = worker_->takeMesh(kDataset, {});
    ASSERT_TRUE(mesh.isOk());
    EXPECT_EQ(mesh.value().isovalue, 3.0);
}

TEST_F(SlideWorkerTest, AMeshWithoutASourceIsRefused) {
    worker_->setSource(nullptr, DatasetGeneration{2}, std::nullopt);
    auto mesh = worker_->takeMesh(kDataset, {});
    ASSERT_FALSE(mesh.isOk());
    EXPECT_EQ(mesh.error().code, ErrorCode::InvalidArgument);
}

TEST_F(SlideWorkerTest, AMeshIsNeverThatOfAnotherDataset) {
    worker_->request(1.0);
    source_->started.acquire(); // the worker is busy: what is asked for waits
    auto mesh = std::async(std::launch::async, [this] { return worker_->takeMesh(kDataset, {}); });
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    auto next = std::make_shared<GatedSource>();
    next->gate.release(1);
    worker_->setSource(next, DatasetGeneration{2}, 9.0);
    const auto taken = mesh.get();
    ASSERT_FALSE(taken.isOk()) << "mesh at " << taken.value().isovalue;
    EXPECT_EQ(taken.error().code, ErrorCode::InvalidArgument);
    EXPECT_TRUE(worker_->takeMesh(DatasetGeneration{2}, {}).isOk());
}

TEST_F(SlideWorkerTest, AMeshIsThatOfTheNextSourceOfItsDataset) {
    worker_->request(1.0);
    source_->started.acquire();
    auto mesh = std::async(std::launch::async, [this] { return worker_->takeMesh(kDataset, {}); });
    auto next = std::make_shared<GatedSource>();
    next->gate.release(1);
    worker_->setSource(next, kDataset, 4.0);
    const auto taken = mesh.get();
    ASSERT_TRUE(taken.isOk()) << taken.error().line();
    EXPECT_EQ(taken.value().isovalue, 4.0) << "not before it has been moved";
}

TEST_F(SlideWorkerTest, ThereIsNoMeshOfAMoveThatFailed) {
    source_->gate.release(2);
    worker_->request(3.0);
    ASSERT_TRUE(worker_->takeMesh(kDataset, {}).isOk());
    worker_->request(-1.0);
    const auto mesh = worker_->takeMesh(kDataset, {});
    ASSERT_FALSE(mesh.isOk());
    EXPECT_EQ(mesh.error().code, ErrorCode::InvalidArgument);
}

TEST_F(SlideWorkerTest, WaitingForAMeshCanBeCancelled) {
    worker_->request(1.0);
    source_->started.acquire();
    std::stop_source stop;
    JobControl job;
    job.stop = stop.get_token();
    std::jthread canceller([&stop] {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        stop.request_stop();
    });
    EXPECT_TRUE(worker_->takeMesh(kDataset, job).isCancelled());
}

TEST_F(SlideWorkerTest, EndsWhileAMoveRuns) {
    worker_->request(1.0);
    source_->started.acquire();
    worker_.reset();
    queue_.runAll();
    EXPECT_TRUE(shown_.empty());
}

TEST(FramePool, UsesTheBuffersAgain) {
    FramePool pool;
    auto first = pool.take();
    first->positions.resize(100);
    const auto* buffer = first->positions.data();
    auto second = pool.take();
    EXPECT_NE(second.get(), first.get());
    first.reset();
    EXPECT_EQ(pool.take()->positions.data(), buffer);
}

TEST(FramePool, AFrameMayOutliveThePool) {
    std::shared_ptr<extract::SurfaceFrame> frame;
    {
        FramePool pool;
        frame = pool.take();
    }
    frame.reset();
}

} // namespace
} // namespace isoslider::model
