#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "core/base/machine.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/jobs/job_model.h"
#include "ui/model/jobs/job_runner.h"

namespace isoslider::model {
namespace {

TEST(JobModel, ListsJobsInOrderWithTheirProgress) {
    JobModel model;
    const auto first = model.add("first");
    const auto second = model.add("second");
    model.setProgress(second, 0.5, "half", 12.0);
    ASSERT_EQ(model.entries().size(), 2u);
    EXPECT_EQ(model.entries()[0].id, first);
    EXPECT_EQ(model.find(second)->stage, "half");
    EXPECT_EQ(model.runningCount(), 2u);
}

TEST(JobModel, AFinishedJobChangesNoMore) {
    JobModel model;
    const auto id = model.add("job");
    model.finish(id, JobState::Failed, "disk full", 1.0);
    model.setProgress(id, 0.1, "late", 2.0);
    model.finish(id, JobState::Finished, "", 2.0);
    EXPECT_EQ(model.find(id)->state, JobState::Failed);
    EXPECT_EQ(model.find(id)->errorText, "disk full");
}

TEST(JobModel, ForgetsOldFinishedJobsButNoRunningOne) {
    JobModel model;
    const auto running = model.add("running");
    for (std::size_t i = 0; i < JobModel::kFinishedKept + 15; ++i)
        model.finish(model.add("short"), JobState::Finished, "", 1.0);
    EXPECT_EQ(model.entries().size(), JobModel::kFinishedKept + 1);
    EXPECT_NE(model.find(running), nullptr);
    model.clearFinished();
    EXPECT_EQ(model.entries().size(), 1u);
}

class JobRunnerTest : public ::testing::Test {
protected:
    test::MainThreadQueue queue_;
    JobModel model_;
    JobRunner runner_{model_, queue_.poster()};
};

TEST_F(JobRunnerTest, DeliversTheResultOnTheMainThread) {
    int answer = 0;
    std::thread::id deliveredOn;
    const auto id = runner_.run<int>(
        "work", [](const JobControl&) -> Result<int> { return 42; },
        [&](Result<int> result) {
            answer = result.value();
            deliveredOn = std::this_thread::get_id();
        });
    ASSERT_TRUE(queue_.runUntil([&] { return answer != 0; }));
    EXPECT_EQ(answer, 42);
    EXPECT_EQ(deliveredOn, std::this_thread::get_id());
    EXPECT_EQ(model_.find(id)->state, JobState::Finished);
    EXPECT_EQ(model_.find(id)->fraction, 1.0);
}

TEST_F(JobRunnerTest, CancelReachesTheWork) {
    bool isDone = false;
    const auto id = runner_.run<int>(
        "work",
        [](const JobControl& job) -> Result<int> {
            while (!job.isStopRequested())
                std::this_thread::yield();
            return cancelledError();
        },
        [&](Result<int> result) { isDone = result.isCancelled(); });
    runner_.cancel(id);
    EXPECT_TRUE(model_.find(id)->isCancelling);
    ASSERT_TRUE(queue_.runUntil([&] { return isDone; }));
    EXPECT_EQ(model_.find(id)->state, JobState::Cancelled);
    EXPECT_TRUE(model_.find(id)->errorText.empty());
}

TEST_F(JobRunnerTest, AnExceptionBecomesAnError) {
    bool isDone = false;
    const auto id = runner_.run<int>(
        "work", [](const JobControl&) -> Result<int> { throw std::runtime_error("broken"); },
        [&](Result<int> result) { isDone = !result.isOk(); });
    ASSERT_TRUE(queue_.runUntil([&] { return isDone; }));
    EXPECT_EQ(model_.find(id)->state, JobState::Failed);
    EXPECT_NE(model_.find(id)->errorText.find("broken"), std::string::npos);
}

struct Helpers {
    int loops = 0; ///< that others than the caller have run
    int leastNice = 0; ///< of all threads, the caller among them
};
/// Keeps all threads of TBB busy for some 100 ms.
Helpers helpersAndTheirNice() {
    const auto caller = std::this_thread::get_id();
    std::mutex mutex;
    Helpers found{0, threadNice()};
    tbb::parallel_for(0, 200, [&](int) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard lock(mutex);
        found.loops += std::this_thread::get_id() != caller ? 1 : 0;
        found.leastNice = std::min(found.leastNice, threadNice());
    });
    return found;
}

TEST(JobRunner, AllThreadsOfAJobGiveWay) {
    const int usual = threadNice();
    EXPECT_EQ(helpersAndTheirNice().leastNice, usual) << "threads that are made by a job give way from the start";
    test::MainThreadQueue queue;
    JobModel model;
    JobRunner runner(model, queue.poster());
    std::optional<Helpers> found;
    runner.run<Helpers>(
        "work", [](const JobControl&) -> Result<Helpers> { return helpersAndTheirNice(); },
        [&](Result<Helpers> result) { found = result.value(); }, JobPriority::Low);
    ASSERT_TRUE(queue.runUntil([&] { return found.has_value(); }));
    EXPECT_GE(found->leastNice, std::max(usual, 10));
    EXPECT_EQ(threadNice(), usual);
    if (std::thread::hardware_concurrency() > 1) {
        EXPECT_GT(found->loops, 0);
    }
}

TEST(JobRunner, AfterItsEndNothingIsDelivered) {
    test::MainThreadQueue queue;
    JobModel model;
    bool isDelivered = false;
    {
        JobRunner runner(model, queue.poster());
        runner.run<int>(
            "work",
            [](const JobControl& job) -> Result<int> {
                while (!job.isStopRequested())
                    std::this_thread::yield();
                return 1;
            },
            [&](Result<int>) { isDelivered = true; });
    }
    queue.runAll();
    EXPECT_FALSE(isDelivered);
}

} // namespace
} // namespace isoslider::model
