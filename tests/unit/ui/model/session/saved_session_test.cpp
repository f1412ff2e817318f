// Sessions: what a file keeps, what of a damaged one is used, and who is offered one that was lost.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "ui/model/session/saved_session.h"
#include "ui/model/session/session_slot.h"

namespace isoslider::model {
namespace {

namespace fs = std::filesystem;
using test::HasError;
using test::IsOk;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

SavedSession fullSession(const fs::path& volume) {
    SavedSession session;
    session.volume = volume;
    session.readOptions.field = "speed/\xff%";
    session.readOptions.component = io::kMagnitude;
    session.readOptions.frame = 3;
    session.readOptions.resampleDims = {20, 30, 40};
    session.readOptions.raw = io::RawLayout{{4, 5, 6}, ScalarType::U16, {0.5, 1.0, 2.0}, 128, true};
    session.readOptions.allowsTrailing = true;
    session.isovalue = -0.1;
    session.reference = 0.1;
    session.error = extract::MergeError{extract::MergeBound::Measure::Distance, 0.35};
    session.camera = CameraPose{{0.5, 0.5, -0.5, 0.5}, {1.0, 2.0, 1e-30}, 7.25, false, {3.0, 0.5, -2.0}};
    session.view = ViewOptions{true, false};
    session.view->pieces.isColoured = true;
    session.view->showsCube = false;
    session.view->showsScaleBar = false;
    session.view->showsTicks = true;
    session.view->stage = {Background::White, Light::Raking, true, {1.0, 2.5, 0.125}};
    session.view->clipping.isCropped = true;
    session.view->clipping.crop = CropBox{{1, 2, 3}, {40, 50, 60}};
    session.view->clipping.plane() = {true, {0.0, 0.6, -0.8}, -12.625, Cap::Values};
    session.view->clipping.planes[1] = {true, {0.8, 0.0, 0.6}, 3.5, Cap::None};
    session.view->clipping.active = 1;
    session.view->measured = {{1.5, -2.0, 1e-30}, {0.1, 0.2, 0.3}};
    session.view->pieces.awaited = {{{{1, 2, 3}, 0}, {{40, 0, 7}, 2}}, PiecePlace{{5, 6, 7}, 1}};
    session.second.volume = {volume.parent_path() / "b.nrrd", {}, {}};
    session.second.volume.readOptions.field = "density";
    ListedSurface beside;
    beside.id = SurfaceId{1};
    beside.name = "Bone";
    beside.isovalue = 0.1;
    beside.colour = {1, 2, 3};
    beside.opacity = 0.5;
    beside.isVisible = false;
    session.second.surfaces = {{beside}, beside.id};
    session.histogram = HistogramOptions{ScaleKind::Symlog, false, false, true, true, {"pieces", "area"}};
    session.histogramRange = HistogramRange{-0.75, 2.5};
    SliceOptions slices;
    slices.layout = SliceLayout::Three;
    slices.onePane = SliceKind::Oblique;
    slices.inScene = {true, false, true, false};
    slices.position = {1.5, 2.25, 1e-30};
    slices.orientation = {0.5, -0.5, 0.5, 0.5};
    slices.window = ValueWindow{-1e3, 2.5e3};
    slices.views[1] = {3.5, {0.25, 0.75}};
    slices.showsContour = false;
    session.slices = slices;
    return session;
}

void expectSame(const SavedSession& a, const SavedSession& b) {
    EXPECT_EQ(a.volume, b.volume);
    EXPECT_EQ(a.sampleName, b.sampleName);
    EXPECT_EQ(a.readOptions, b.readOptions);
    EXPECT_EQ(a.isovalue, b.isovalue);
    EXPECT_EQ(a.second, b.second);
    EXPECT_EQ(a.reference, b.reference);
    EXPECT_EQ(a.error, b.error);
    EXPECT_EQ(a.slices, b.slices);
    ASSERT_EQ(a.camera.has_value(), b.camera.has_value());
    if (a.camera) {
        EXPECT_EQ(a.camera->orientation, b.camera->orientation);
        EXPECT_EQ(a.camera->target, b.camera->target);
        EXPECT_EQ(a.camera->distance, b.camera->distance);
        EXPECT_EQ(a.camera->isPerspective, b.camera->isPerspective);
        EXPECT_EQ(a.camera->pivot, b.camera->pivot);
    }
    EXPECT_EQ(a.view, b.view);
    EXPECT_EQ(a.histogram, b.histogram);
    EXPECT_EQ(a.histogramRange, b.histogramRange);
}

class SavedSessionTest : public ::testing::Test {
protected:
    /// The text of a whole session with one piece replaced.
    std::string changed(const std::string& from, const std::string& to) {
        std::string text = sessionText(fullSession(folder_ / "a.mha"), folder_.path());
        const auto place = text.find(from);
        EXPECT_NE(place, std::string::npos) << from << " in " << text;
        return text.replace(place, from.size(), to);
    }
    ReadSession read(const std::string& text) { return sessionFromText(text, folder_.path()); }

    test::TemporaryFolder folder_;
};

TEST_F(SavedSessionTest, KeepsEverything) {
    const auto session = fullSession(folder_ / "a \xc3\xa9\n%41.mha");
    ASSERT_THAT(writeSession(session, folder_ / "s.isosession"), IsOk());
    const auto again = readSession(folder_ / "s.isosession");
    ASSERT_THAT(again, IsOk());
    EXPECT_THAT(again.value().problems, IsEmpty());
    expectSame(again.value().session, session);

    SavedSession sample;
    sample.sampleName = "shell";
    const auto small = read(sessionText(sample, folder_.path()));
    EXPECT_THAT(small.problems, IsEmpty());
    expectSame(small.session, sample);
}

TEST_F(SavedSessionTest, FollowsItsVolumeWhenBothMove) {
    fs::create_directories(folder_ / "old/data");
    folder_.write("old/data/a.mha", "");
    ASSERT_THAT(writeSession(fullSession(folder_ / "old/data/a.mha"), folder_ / "old/s.isosession"), IsOk());
    fs::rename(folder_ / "old", folder_ / "new");
    EXPECT_EQ(readSession(folder_ / "new/s.isosession").value().session.volume, folder_ / "new/data/a.mha");
    fs::remove(folder_ / "new/data/a.mha");
    EXPECT_EQ(readSession(folder_ / "new/s.isosession").value().session.volume, folder_ / "old/data/a.mha");
}

TEST_F(SavedSessionTest, B110_OfZeroBytesOrOtherBytesIsToldAndHoldsDefaults) {
    for (const auto& [text, says] : {std::pair<std::string, std::string>("", "is empty"),
                                     {"{", "not a session"},
                                     {"null", "not a session"},
                                     {"{\"version\": 1}", "not a session"},
                                     {std::string(500'000, '['), "not a session"},
                                     {std::string(1000, '\0'), "not a session"}}) {
        const auto found = readSession(folder_.write("s.isosession", text));
        ASSERT_THAT(found, IsOk());
        EXPECT_THAT(found.value().problems, ElementsAre(HasSubstr(says)));
        EXPECT_FALSE(found.value().session.hasVolume());
    }
}

TEST_F(SavedSessionTest, ARangeOrCurvesThatMakeNoSenseAreLeftOut) {
    const auto turned = read(changed("-0.75,\n    2.5", "2.5,\n    -0.75"));
    EXPECT_THAT(turned.problems, ElementsAre(HasSubstr("histogramRange")));
    EXPECT_FALSE(turned.session.histogramRange);
    const auto numbers = read(changed("\"pieces\",\n      \"area\"", "1, 2"));
    EXPECT_THAT(numbers.problems, ElementsAre(HasSubstr("curves")));
    EXPECT_THAT(numbers.session.histogram->curves, IsEmpty());
}

TEST_F(SavedSessionTest, B110_OfAGigabyteIsNotReadAtAll) {
    const auto path = folder_.write("s.isosession", "{");
    fs::resize_file(path, std::uintmax_t{1} << 30);
    const auto start = std::clock();
    const auto found = readSession(path);
    ASSERT_THAT(found, IsOk());
    EXPECT_THAT(found.value().problems, ElementsAre(HasSubstr("larger than a session")));
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 0.1);
}

TEST_F(SavedSessionTest, B110_ANumberThatIsNoneLeavesTheDefault) {
    const auto camera = read(changed("\"distance\": 7.25", "\"distance\": null"));
    EXPECT_FALSE(camera.session.camera.has_value());
    EXPECT_THAT(camera.problems, testing::Contains(HasSubstr("camera, distance is not a finite number")));
    EXPECT_EQ(camera.session.isovalue, -0.1) << "the rest is used";
    EXPECT_FALSE(read(changed("7.25", "\"NaN\"")).session.camera.has_value());
    EXPECT_FALSE(read(changed("7.25", "-1")).session.camera.has_value());
    EXPECT_FALSE(read(changed("\"orientation\": [\n      0.5,", "\"orientation\": [")).session.camera.has_value());
    EXPECT_THAT(read(changed("7.25", "NaN")).problems, ElementsAre(HasSubstr("not a session")));
    EXPECT_THAT(read(changed("7.25", "1e999")).problems, ElementsAre(HasSubstr("not a session")));
    EXPECT_FALSE(read(changed("-0.1", "\"bone\"")).session.isovalue.has_value());
    for (const auto& [from, to] : {std::pair{"\"cells\"", "\"inches\""}, {"0.35", "-0.35"}, {"0.35", "\"some\""}}) {
        const auto error = read(changed(from, to));
        EXPECT_FALSE(error.session.error.has_value()) << to;
        EXPECT_THAT(error.problems, testing::Contains(HasSubstr("no cells are merged"))) << to;
    }
}

TEST_F(SavedSessionTest, B110_AnUnknownKeyIsToldAndTheRestUsed) {
    auto found = read(changed("\"isovalue\"", "\"colour\": 1, \"isovalue\""));
    EXPECT_THAT(found.problems, ElementsAre("'colour' is not known and ignored"));
    expectSame(found.session, fullSession(folder_ / "a.mha"));
    found = read(changed("\"changed\"", "\"shadows\": true, \"changed\""));
    EXPECT_THAT(found.problems, ElementsAre("view, 'shadows' is not known and ignored"));
}

TEST_F(SavedSessionTest, B110_PlacesThatAreNoneAreToldAndTheRestUsed) {
    for (const std::string places : {"7", "[1, 2, 3]", "[[1, 2]]", "[[1, 2, \"3\"]]", "[[1, 2, null]]",
                                     "[[1, 2, 3], [1, 2, 3], [1, 2, 3], [1, 2, 3]]"}) {
        const auto found = read(changed("\"measured\":", "\"measured\": " + places + ", \"shadows\":"));
        EXPECT_THAT(found.problems,
                    testing::Contains("view, measured is not a list of at most 3 places and is ignored"))
            << places;
        EXPECT_TRUE(found.session.view->measured.empty()) << places;
        EXPECT_FALSE(found.session.view->showsCube) << "read";
    }
}

TEST_F(SavedSessionTest, B110_PiecesThatAreNoneAreToldAndTheRestUsed) {
    for (const std::string places :
         {"7", "[1, 2, 3, 0]", "[[1, 2, 3]]", "[[1, 2, 3, 3]]", "[[1, -2, 3, 0]]", "[[1, 2.5, 3, 0]]",
          "[[1, 2, 1e300, 0]]", "[[1, 2, 3, 0], [1, 18446744073709551615, 3, 0]]", "[[1, 2, \"3\", 0]]", "[null]"}) {
        const auto found = read(changed("\"hiddenPieces\":", "\"hiddenPieces\": " + places + ", \"shadows\":"));
        EXPECT_THAT(found.problems,
                    testing::Contains("view, hiddenPieces is not a list of edges of the grid; no piece is hidden"))
            << places;
        EXPECT_THAT(found.session.view->pieces.awaited.hidden, IsEmpty()) << places;
        EXPECT_EQ(found.session.view->pieces.awaited.only, (PiecePlace{{5, 6, 7}, 1})) << "read";
    }
    const auto only = read(changed("\"onlyPiece\":", "\"onlyPiece\": [1, 2], \"shadows\":"));
    EXPECT_THAT(only.problems, testing::Contains("view, onlyPiece is not an edge of the grid and is ignored"));
    EXPECT_FALSE(only.session.view->pieces.awaited.only);
    EXPECT_EQ(only.session.view->pieces.awaited.hidden.size(), 2u) << "read";
}

TEST_F(SavedSessionTest, B110_ClippingThatIsNoneIsToldAndTheRestUsed) {
    struct Case {
        const char *from, *to, *problem;
    };
    for (const Case& entry :
         {Case{"\"background\": \"white\"", "\"background\": \"plaid\"",
               "view, stage, background is not known and ignored"},
          Case{"\"light\": \"raking\"", "\"light\": 3",
               "view, stage, light is not a text of at most 4096 bytes and is ignored"},
          Case{"\"stretch\":", "\"stretch\": [1, 0, 2], \"stretches\":",
               "view, stage, stretch is not within 0.001 and 1000 and is brought there"},
          Case{"\"clipping\":", "\"clipping\": 7, \"shadows\":", "is not an object"},
          Case{"\"cropped\": true", "\"cropped\": 1", "view, clipping, cropped is neither true nor false and ignored"},
          Case{"\"low\":", "\"low\": [1, -2, 3], \"least\":", "view, clipping, low are no three sizes and ignored"},
          Case{"\"high\":", "\"high\": [1, 2.5, 3], \"most\":", "view, clipping, high are no three sizes and ignored"},
          Case{"\"normal\":", "\"normal\": [0, 0, 0], \"way\":",
               "view, clipping, plane, normal has no direction and is ignored"},
          Case{"\"offset\":", "\"offset\": null, \"at\":",
               "view, clipping, plane, offset is not a finite number and is ignored"},
          Case{"\"cap\": \"values\"", "\"cap\": \"gold\"", "view, clipping, plane, cap is not known and ignored"}}) {
        const auto found = read(changed(entry.from, entry.to));
        EXPECT_THAT(found.problems, testing::Contains(entry.problem)) << entry.to;
        EXPECT_EQ(found.session.view->measured.size(), 2u) << "read";
    }
    const auto without = read(changed("\"clipping\":", "\"shadows\":"));
    EXPECT_EQ(without.session.view->clipping, Clipping()) << "of an earlier version";
}

TEST_F(SavedSessionTest, B110_OfALaterVersionIsToldAndUsedAsFarAsItGoes) {
    const auto found = read(changed("\"isosliderSession\": 1", "\"isosliderSession\": 2"));
    EXPECT_THAT(found.problems, ElementsAre(HasSubstr("later version")));
    expectSame(found.session, fullSession(folder_ / "a.mha"));
}

TEST_F(SavedSessionTest, B110_OptionsOutOfBoundsAreTold) {
    EXPECT_FALSE(read(changed("\"type\": \"u16\"", "\"type\": \"float128\"")).session.readOptions.raw.has_value());
    EXPECT_FALSE(read(changed("\"component\": -1", "\"component\": -2")).session.readOptions.component.has_value());
    EXPECT_FALSE(
        read(changed("\"frame\": 3", "\"frame\": 18446744073709551615")).session.readOptions.frame.has_value());
    EXPECT_FALSE(read(changed("\"frame\": 3", "\"frame\": 1.5")).session.readOptions.frame.has_value());
    EXPECT_EQ(read(changed("\"size\": [\n        20", "\"size\": [\n        0")).session.readOptions.resampleDims,
              (GridDims{0, 0, 0}));
    const auto many = read(changed("\"isovalue\"", [] {
        std::string keys;
        for (int i = 0; i < 1000; ++i)
            keys += "\"k" + std::to_string(i) + "\": 0, ";
        return keys + "\"isovalue\"";
    }()));
    EXPECT_EQ(many.problems.size(), 20u);
}

TEST_F(SavedSessionTest, SlicesThatCannotBeAreToldAndLeaveTheDefault) {
    auto found = read(changed("\"layout\": \"three\"", "\"layout\": \"nine\""));
    EXPECT_THAT(found.problems, ElementsAre("slices, layout is not known and ignored"));
    EXPECT_EQ(found.session.slices->layout, SliceLayout::None);
    found = read(changed("\"position\"", "\"elsewhere\""));
    EXPECT_THAT(found.problems, ElementsAre("slices, 'elsewhere' is not known and ignored"));
    EXPECT_TRUE(std::isnan(found.session.slices->position.x)) << "the middle, which is known once the volume is open";
    found = read(changed("-1000.0", "9000.0"));
    EXPECT_THAT(found.problems, ElementsAre("slices, window does not ascend and is ignored"));
    EXPECT_FALSE(found.session.slices->window);
    EXPECT_EQ(found.session.slices->onePane, SliceKind::Oblique);
    EXPECT_EQ(found.session.slices->views[1], (PaneView{3.5, {0.25, 0.75}}));
}

TEST_F(SavedSessionTest, AnyCutOrChangedByteIsSafe) {
    const std::string text = sessionText(fullSession(folder_ / "a.mha"), folder_.path());
    for (std::size_t length = 0; length < text.size() - 2; ++length)
        EXPECT_FALSE(read(text.substr(0, length)).problems.empty()) << length;
    std::mt19937 random(1);
    for (int i = 0; i < 3000; ++i) {
        std::string bad = text;
        for (int changes = 0; changes < 2; ++changes)
            bad[random() % bad.size()] = static_cast<char>(random());
        const auto found = read(bad);
        EXPECT_TRUE(!found.session.camera || Camera().setPose(*found.session.camera));
    }
}

TEST_F(SavedSessionTest, OptionsAloneKeepThemselves) {
    const auto options = fullSession("a").readOptions;
    EXPECT_EQ(optionsFromText(optionsText(options)), options);
    EXPECT_EQ(optionsFromText(optionsText({})), io::ReadOptions());
    EXPECT_EQ(optionsFromText("{\"frame\": \"x\"}"), std::nullopt);
    EXPECT_EQ(optionsFromText(""), std::nullopt);
}

class SessionSlotTest : public ::testing::Test {
protected:
    SavedSession at(double isovalue) {
        auto session = fullSession("/volumes/a.mha");
        session.isovalue = isovalue;
        return session;
    }
    /// A program that saves until it is killed.
    pid_t startSaving() {
        const pid_t child = ::fork();
        if (child != 0)
            return child;
        const auto slot = SessionSlot::create(folder_.path());
        for (int i = 1; slot.isOk(); ++i)
            if (!slot.value()->save(at(i)).isOk())
                break;
        ::_exit(1);
    }
    void waitForSessions(std::ptrdiff_t count) {
        const auto isSession = [](const std::string& name) { return isSessionFile(name); };
        for (int i = 0; i < 10'000; ++i) {
            const auto names = folder_.names();
            if (std::count_if(names.begin(), names.end(), isSession) == count)
                return;
            ::usleep(1000);
        }
        FAIL() << "no program has saved";
    }
    test::TemporaryFolder folder_;
};

TEST_F(SessionSlotTest, B111_AKillDuringSavingLeavesTheLastWholeSession) {
    std::mt19937 random(7);
    for (int round = 0; round < 40; ++round) {
        const pid_t child = startSaving();
        waitForSessions(1);
        ::usleep(random() % 3000);
        ASSERT_EQ(::kill(child, SIGKILL), 0);
        ASSERT_EQ(::waitpid(child, nullptr, 0), child);
        const auto lost = SessionSlot::findLost(folder_.path());
        ASSERT_EQ(lost.size(), 1u) << round;
        const auto read = lost[0]->read();
        ASSERT_THAT(read, IsOk());
        EXPECT_THAT(read.value().problems, IsEmpty());
        EXPECT_GE(read.value().session.isovalue.value_or(0.0), 1.0);
        lost[0]->discard();
        EXPECT_THAT(folder_.names(), IsEmpty()) << round;
    }
}

TEST_F(SessionSlotTest, B111_ProgramsDoNotTakeEachOthersSessions) {
    const auto mine = SessionSlot::create(folder_.path());
    ASSERT_THAT(mine, IsOk());
    ASSERT_THAT(mine.value()->save(at(100)), IsOk());
    const pid_t child = startSaving();
    waitForSessions(2);
    EXPECT_THAT(SessionSlot::findLost(folder_.path()), IsEmpty()) << "both live";
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    const auto lost = SessionSlot::findLost(folder_.path());
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_NE(lost[0]->path(), mine.value()->path());
    EXPECT_THAT(SessionSlot::findLost(folder_.path()), IsEmpty()) << "offered once, not twice";
}

TEST_F(SessionSlotTest, TheNewestComesFirstAndAnEndedProgramLeavesNothing) {
    std::vector<fs::path> paths;
    for (int i = 0; i < 3; ++i) {
        const auto slot = SessionSlot::create(folder_.path());
        ASSERT_THAT(slot.value()->save(at(i)), IsOk());
        paths.push_back(slot.value()->path());
        fs::last_write_time(paths.back(), fs::file_time_type::clock::now() - std::chrono::minutes(i == 1 ? 0 : i + 1));
    }
    auto lost = SessionSlot::findLost(folder_.path());
    ASSERT_EQ(lost.size(), 3u);
    EXPECT_EQ(lost[0]->path(), paths[1]);
    EXPECT_EQ(lost[2]->path(), paths[2]);
    for (const auto& slot : lost)
        slot->discard();
    EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(SessionSlotTest, RemovesLocksThatNoSessionCameOf) {
    const auto old = folder_.write("1-1-0.lock", "");
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(1));
    folder_.write("1-1-0.isosession.partial", "{");
    folder_.write("2-2-0.lock", "");
    EXPECT_THAT(SessionSlot::findLost(folder_.path()), IsEmpty());
    EXPECT_THAT(folder_.names(), ElementsAre("2-2-0.lock")) << "of a program that has just begun, perhaps";
}

TEST_F(SessionSlotTest, SaysWhenItCannotKeepAnything) {
    folder_.write("file", "");
    EXPECT_FALSE(SessionSlot::create(folder_ / "file/below").isOk());
    EXPECT_THAT(SessionSlot::findLost(folder_ / "none"), IsEmpty());
}

} // namespace
} // namespace isoslider::model
