// Sessions in the window: saved and opened by the user, kept by themselves, offered when they were lost.
#include <fstream>
#include <sstream>

#include <QAction>
#include <QPushButton>
#include <QtTest>

#include "tests/gui/window_fixture.h"
#include "ui/model/session/saved_session.h"
#include "ui/model/session/session_slot.h"
#include "ui/widgets/isovalue/histogram_plot.h"
#include "ui/widgets/isovalue/isovalue_panel.h"
#include "ui/widgets/viewport/viewport_host.h"
#include "ui/widgets/viewport/viewport_widget.h"
#include "ui/widgets/window/action_registry.h"
#include "ui/widgets/window/message_bar.h"
#include "ui/widgets/window/session_keeper.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;

class SessionKeeperTest : public WindowTest {
protected:
    fs::path saveSession() {
        const auto path = folder_ / "ball.isosession";
        dialogs_.answers.push_back(qpath(path));
        trigger("file.saveSession");
        EXPECT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
        EXPECT_TRUE(fs::exists(path));
        window_->messageBar().hide();
        return path;
    }
    bool isChecked(const char* action) { return window_->actions().action(action)->isChecked(); }
    std::string message() { return window_->messageBar().text().toStdString(); }
    widgets::MessageBar* recoveryBar() { return child<widgets::MessageBar>("recoveryBar"); }
    void press(widgets::MessageBar& bar, int offer) {
        auto* button = bar.findChild<QPushButton*>(QStringLiteral("messageBarOffer%1").arg(offer));
        ASSERT_NE(button, nullptr);
        QTest::mouseClick(button, Qt::LeftButton);
    }
    /// What a program that was killed leaves in `folder`.
    static void loseSession(const fs::path& folder, const fs::path& volume, double isovalue) {
        model::SavedSession saved;
        saved.volume = volume;
        saved.isovalue = isovalue;
        ASSERT_TRUE(model::SessionSlot::create(folder).value()->save(saved).isOk());
    }
    void openAndWait(const fs::path& path) {
        window_->openFile(qpath(path));
        ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    }
};

TEST_F(SessionKeeperTest, ShowsAgainWhatWasSaved) {
    openBall();
    session_->isovalue().request(-7.5);
    session_->detail().setError({extract::MergeBound::Measure::Distance, 0.35});
    ASSERT_TRUE(waitUntilSettled());
    window_->actions().action("view.box")->setChecked(false);
    window_->actions().action("view.perspective")->setChecked(false);
    auto& view = window_->viewportHost().viewState();
    auto options = view.options();
    options.pieces.leastSize = 0.5;
    options.pieces.largest = 7;
    view.setOptions(options);
    model::CameraPose pose;
    if (auto* viewport = window_->viewportHost().viewport()) {
        viewport->changeCamera([](model::Camera& camera) {
            camera.orbit(0.4, 0.2);
            camera.zoom(1.7, {0.1, 0.2}, 1.5);
        });
        pose = viewport->camera().pose();
    }
    const auto path = saveSession();
    window_->actions().action("view.box")->setChecked(true);
    window_->actions().action("view.perspective")->setChecked(true);
    trigger("file.close");
    session_->detail().setError({});
    drop(path);
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_EQ(session_->isovalue().requested(), -7.5);
    EXPECT_EQ(session_->frame()->mergeBound.limit, 0.35);
    EXPECT_FALSE(isChecked("view.box"));
    EXPECT_EQ(view.options().pieces.leastSize, 0.5);
    EXPECT_EQ(view.options().pieces.largest, 7u);
    if (auto* viewport = window_->viewportHost().viewport()) {
        EXPECT_FALSE(isChecked("view.perspective"));
        EXPECT_EQ(viewport->camera().target(), pose.target);
        EXPECT_NEAR(viewport->camera().distance(), pose.distance, 1e-9);
        EXPECT_NEAR(glm::length(viewport->camera().orientation() - pose.orientation), 0.0, 1e-12);
    }
    EXPECT_FALSE(window_->messageBar().isVisible()) << message();
}

TEST_F(SessionKeeperTest, ASessionFromAFileIsSavedThereAgain) {
    openBall();
    fs::create_directory(folder_ / "kept");
    const auto path = folder_ / "kept" / "of yesterday.isosession";
    fs::rename(saveSession(), path);
    const auto proposed = [this] {
        dialogs_.answers.push_back(qpath(folder_ / "no such folder" / "s.isosession")); // nothing is saved
        trigger("file.saveSession");
        EXPECT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
        window_->messageBar().hide();
        return dialogs_.asked.place;
    };
    openAndWait(writeBall(folder_, "other.mha", 20));
    EXPECT_EQ(proposed(), qpath(folder_ / "other.isosession"));
    openAndWait(path);
    ASSERT_EQ(session_->dataset()->name, "ball.mha");
    EXPECT_EQ(proposed(), qpath(path));
    openAndWait(folder_ / "other.mha");
    EXPECT_EQ(proposed(), qpath(folder_ / "other.isosession")) << "of another volume";
    const auto saved = saveSession();
    EXPECT_EQ(proposed(), qpath(saved)) << "it is this file's by now";
}

TEST_F(SessionKeeperTest, OneIsOpenedFromTheDialogOfVolumesToo) {
    openBall();
    session_->isovalue().request(-7.5);
    ASSERT_TRUE(waitUntilSettled());
    const auto path = saveSession();
    trigger("file.close");
    dialogs_.answers.push_back(qpath(path));
    trigger("file.open");
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_EQ(session_->isovalue().requested(), -7.5);
}

TEST_F(SessionKeeperTest, ShowsCurvesSnappingAndRangeOfTheHistogramAgain) {
    openBall();
    auto* area = window_->findChild<QAction*>(QStringLiteral("curve.area"));
    ASSERT_NE(area, nullptr);
    ASSERT_TRUE(waitUntil([&] { return area->isEnabled(); }));
    auto& plot = window_->isovaluePanel().plot();
    EXPECT_FALSE(plot.chosenRange());
    area->trigger();
    trigger("isovalue.snap");
    QTest::keyClick(window_.get(), Qt::Key_Plus, Qt::ControlModifier);
    ASSERT_TRUE(waitUntilSettled()); // snapping moves the handle, and the plot with it
    const auto path = saveSession();
    const auto range = plot.chosenRange();
    ASSERT_TRUE(range);
    trigger("file.close");
    area->trigger();
    trigger("isovalue.snap");
    openAndWait(path);
    EXPECT_TRUE(area->isChecked());
    EXPECT_TRUE(isChecked("isovalue.snap"));
    ASSERT_TRUE(plot.chosenRange());
    EXPECT_NEAR(plot.chosenRange()->lower, range->lower, 1e-9);
    EXPECT_NEAR(plot.chosenRange()->upper, range->upper, 1e-9);
    EXPECT_EQ(settings_->list("histogram/curves"), QStringList{QStringLiteral("area")});
    QTest::qWait(600); // longer than steps are joined
    EXPECT_FALSE(window_->actions().action("edit.undo")->isEnabled());
    area->trigger();
    QTest::qWait(600);
    trigger("edit.undo");
    EXPECT_TRUE(area->isChecked());
}

TEST_F(SessionKeeperTest, OneOfAnEarlierVersionLeavesBackgroundLightAndColoursAsTheyAre) {
    openBall();
    const auto path = saveSession();
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    std::string old = text.str();
    for (const char* member : {"\"stage\"", "\"colouring\""})
        old.replace(old.find(member), std::string(member).size(), "\"later\"");
    std::ofstream(path) << old;
    auto& view = window_->viewportHost().viewState();
    auto options = view.options();
    options.stage.background = model::Background::White;
    options.stage.hasOcclusion = !options.stage.hasOcclusion;
    options.colouring.map = model::ColourMap::Magma;
    view.setOptions(options);
    openAndWait(path);
    EXPECT_EQ(view.options().stage, options.stage);
    EXPECT_EQ(view.options().colouring.map, model::ColourMap::Magma);
}

TEST_F(SessionKeeperTest, B110_ADamagedFileOpensWithDefaultsAndListsWhatIsWrong) {
    const auto ball = writeBall(folder_, "ball.mha", 24).string();
    const auto path = folder_.write("ball.isosession", R"({"isosliderSession": 1, "colour": 3, "volume": {"path": ")" +
                                                           ball + R"("}, "camera": {"distance": "NaN", "length": 1}})");
    openAndWait(path);
    EXPECT_TRUE(window_->messageBar().isVisible());
    for (const char* says :
         {"Not all of ball.isosession", "camera, distance", "'length' is not known", "'colour' is not known"})
        EXPECT_NE(message().find(says), std::string::npos) << says << " in " << message();
    keepPicture(*window_, "session_problems");

    for (const char* bytes : {"", "{", "\x89PNG\r\n"}) {
        window_->openFile(qpath(folder_.write("bad.isosession", bytes)));
        EXPECT_NE(message().find("bad.isosession"), std::string::npos) << message();
        EXPECT_NE(session_->dataset(), nullptr) << "what was open stays";
    }
}

TEST_F(SessionKeeperTest, B110_AVolumeThatIsGoneIsAskedFor) {
    openBall();
    session_->isovalue().request(-6.25);
    const auto path = saveSession();
    trigger("file.close");
    fs::create_directory(folder_ / "elsewhere");
    fs::rename(folder_ / "ball.mha", folder_ / "elsewhere/moved.mha");
    window_->openFile(qpath(path));
    EXPECT_TRUE(window_->messageBar().isVisible());
    EXPECT_NE(message().find("not where it was"), std::string::npos) << message();
    EXPECT_NE(message().find("ball.mha"), std::string::npos) << message();
    EXPECT_EQ(session_->dataset(), nullptr);
    keepPicture(*window_, "session_volume_missing");
    dialogs_.answers.push_back(qpath(folder_ / "elsewhere/moved.mha"));
    press(window_->messageBar(), 0);
    ASSERT_TRUE(waitUntil([this] { return session_->frame() != nullptr && session_->isSettled(); }));
    EXPECT_EQ(session_->isovalue().requested(), -6.25);
}

TEST_F(SessionKeeperTest, SaysWhenItCannotSave) {
    openBall();
    dialogs_.answers.push_back(qpath(folder_ / "none/ball.isosession"));
    trigger("file.saveSession");
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_NE(message().find("was not saved"), std::string::npos) << message();
}

TEST_F(SessionKeeperTest, KeepsWhatIsShownWhileItRunsAndNothingAfterwards) {
    const auto sessions = folder_ / "sessions";
    window_->sessionKeeper().keepIn(sessions, std::chrono::milliseconds(20));
    openBall();
    session_->isovalue().request(-5.5);
    const auto isKept = [&] {
        for (const auto& entry : fs::directory_iterator(sessions))
            if (model::isSessionFile(entry.path()))
                return model::readSession(entry.path()).value().session.isovalue == -5.5;
        return false;
    };
    EXPECT_TRUE(waitUntil(isKept));
    EXPECT_TRUE(model::SessionSlot::findLost(sessions).empty()) << "the program that keeps it lives";
    EXPECT_FALSE(recoveryBar()->isVisible());
    window_.reset();
    EXPECT_TRUE(fs::is_empty(sessions));
}

TEST_F(SessionKeeperTest, B111_ALostSessionIsOfferedUntilItIsDecidedUpon) {
    const auto sessions = folder_ / "sessions";
    const auto ball = writeBall(folder_, "ball.mha", 24);
    loseSession(sessions, ball, -8.125);
    window_->sessionKeeper().keepIn(sessions);
    ASSERT_TRUE(recoveryBar()->isVisible());
    const auto text = recoveryBar()->text().toStdString();
    EXPECT_NE(text.find("did not end properly"), std::string::npos) << text;
    EXPECT_NE(text.find("ball.mha, isovalue -8.125"), std::string::npos) << text;
    openAndWait(writeBall(folder_, "other.mha", 16));
    window_->openFile(qpath(folder_ / "none.mha"));
    ASSERT_TRUE(waitUntil([this] { return window_->messageBar().isVisible(); }));
    EXPECT_TRUE(recoveryBar()->isVisible()) << "other messages do not take its place";
    keepPicture(*window_, "session_recovery");
    press(*recoveryBar(), 0);
    ASSERT_TRUE(waitUntil([this] { return session_->dataset()->name == "ball.mha" && session_->isSettled(); }));
    EXPECT_EQ(session_->isovalue().requested(), -8.125);
    EXPECT_FALSE(recoveryBar()->isVisible());
    EXPECT_TRUE(model::SessionSlot::findLost(sessions).empty());
}

TEST_F(SessionKeeperTest, B111_SeveralAreOfferedOneAfterTheOther) {
    const auto sessions = folder_ / "sessions";
    loseSession(sessions, "/volumes/older.mha", 1.0);
    for (const auto& entry : fs::directory_iterator(sessions))
        fs::last_write_time(entry.path(), fs::file_time_type::clock::now() - std::chrono::hours(1));
    loseSession(sessions, "/volumes/newer.mha", 2.0);
    window_->sessionKeeper().keepIn(sessions);
    EXPECT_NE(recoveryBar()->text().indexOf(QLatin1String("newer.mha")), -1);
    press(*recoveryBar(), 1);
    EXPECT_TRUE(recoveryBar()->isVisible());
    EXPECT_NE(recoveryBar()->text().indexOf(QLatin1String("older.mha")), -1);
    press(*recoveryBar(), 1);
    EXPECT_FALSE(recoveryBar()->isVisible());
    EXPECT_EQ(session_->dataset(), nullptr);
}

TEST_F(SessionKeeperTest, SaysWhenNothingCanBeKept) {
    folder_.write("file", "");
    window_->sessionKeeper().keepIn(folder_ / "file");
    EXPECT_NE(message().find("cannot be restored"), std::string::npos) << message();
    openBall();
}

} // namespace
} // namespace isoslider::test
