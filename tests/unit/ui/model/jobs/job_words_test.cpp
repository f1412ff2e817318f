#include "ui/model/jobs/job_words.h"

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

TEST(JobWords, TheTimeLeftIsTakenFromWhatIsDone) {
    EXPECT_EQ(timeLeftText(0.25, 3000.0), "about 9 s left");
    EXPECT_EQ(timeLeftText(0.1, 4100.0), "about 40 s left") << "in steps of 5";
    EXPECT_EQ(timeLeftText(0.5, 120'000.0), "about 2 min left");
    EXPECT_EQ(timeLeftText(0.999, 5000.0), "about 1 s left");
    EXPECT_EQ(timeLeftText(1.5, 5000.0), "about 1 s left") << "a fraction above 1 is 1";
}

TEST(JobWords, AGuessIsNotStated) {
    EXPECT_EQ(timeLeftText(0.5, 800.0), "") << "too early";
    EXPECT_EQ(timeLeftText(0.01, 5000.0), "") << "too little is done";
    EXPECT_EQ(timeLeftText(-1.0, 5000.0), "");
    EXPECT_EQ(timeLeftText(0.0, 1e12), "");
}

TEST(JobWords, ARunningJobStatesStageShareAndTime) {
    JobEntry job;
    job.stage = "reading";
    job.fraction = 0.25;
    job.elapsedMs = 300.0;
    EXPECT_EQ(runningText(job), "Reading · 25 %");
    job.elapsedMs = 3000.0;
    EXPECT_EQ(runningText(job), "Reading · 25 % · about 9 s left");
}

} // namespace
} // namespace isoslider::model
