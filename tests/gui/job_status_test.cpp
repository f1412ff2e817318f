// The job in the status bar.
#include <QProgressBar>
#include <QTest>
#include <QToolButton>

#include "tests/gui/window_fixture.h"
#include "ui/widgets/viewport/viewport_host.h"

namespace isoslider::test {
namespace {

using JobStatusTest = WindowTest;

// As the analysis of the topology of noise, which may take seconds before it has something to report.
TEST_F(JobStatusTest, ShowsAJobThatHasNotReportedYet) {
    openBall();
    model::JobModel& jobs = session_->jobs();
    auto* status = child<QWidget>("jobStatus");
    const QSize view = window_->viewportHost().size();
    const auto silent = jobs.add("Analyse topology of noise.mha");
    EXPECT_FALSE(status->isVisible()) << "it may be over at once";
    ASSERT_TRUE(waitUntil([&] { return status->isVisible(); }, std::chrono::seconds(2)));
    const auto* text = status->findChild<QToolButton*>();
    EXPECT_EQ(text->text(), QStringLiteral("Analyse topology of noise.mha"));
    EXPECT_TRUE(text->toolTip().contains(QStringLiteral("Starting…"))) << text->toolTip().toStdString();
    EXPECT_EQ(status->findChild<QProgressBar*>()->value(), 0);
    keepPicture(*window_, "job_status_silent");
    QTest::qWait(50);
    EXPECT_EQ(window_->viewportHost().size(), view) << "nothing jumps";
    for (const auto* button : status->findChildren<QToolButton*>())
        EXPECT_GE(button->height(), button->fontMetrics().height()) << "nothing is cut off";
    jobs.finish(silent, model::JobState::Finished, "", 3000.0);
    EXPECT_FALSE(status->isVisible());
}

TEST_F(JobStatusTest, ShowsABuildThatHasNotReportedYet) {
    builder_->holds = true;
    openBall();
    auto* status = child<QWidget>("jobStatus");
    EXPECT_TRUE(waitUntil([&] { return status->isVisible(); }, std::chrono::seconds(5)));
    EXPECT_EQ(status->findChild<QToolButton*>()->text(), QStringLiteral("Build index of ball.mha"));
    builder_->holds = false;
    ASSERT_TRUE(waitUntilSettled());
}

} // namespace
} // namespace isoslider::test
