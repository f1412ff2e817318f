// The real program, run as a shell runs it.
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/build_index.h"
#include "tests/gui/program_fixture.h"
#include "tests/support/damaged_index.h"

namespace isoslider::test {
namespace {

TEST_F(ProgramTest, TakesAPictureOfTheWholeWindow) {
    const auto picture = folder_ / "out.png";
    const auto result = run({writeBall(folder_, "ball.mha", 20).string(), "--isovalue", "-6", "--size", "1200x800",
                             "--screenshot", picture.string()});
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    const QImage image(QString::fromStdString(picture.string()));
    EXPECT_EQ(image.size(), QSize(1200, 800) * image.devicePixelRatio());
}

TEST_F(ProgramTest, StatesThatAnIsovalueIsNotTheOneAskedFor) {
    const auto picture = (folder_ / "out.png").string();
    const auto volume = writeBall(folder_, "ball.mha", 20).string();
    const auto above = run({volume, "--isovalue", "900 sigma", "--screenshot", picture});
    EXPECT_EQ(above.exitCode, 0);
    EXPECT_NE(above.standardError.find("is above all samples; the greatest, "), std::string::npos)
        << above.standardError;
    const auto flat = folder_.write("flat.mha", "NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\n"
                                                "ElementDataFile = LOCAL\n" +
                                                    std::string(64, '\5'));
    const auto none = run({flat.string(), "--isovalue", "1 sigma", "--screenshot", picture});
    EXPECT_NE(none.standardError.find("isoslider: All samples have one value"), std::string::npos)
        << none.standardError;
    const auto taken = run({flat.string(), "--isovalue", "5", "--screenshot", picture}).standardError;
    EXPECT_EQ(taken.find("was taken"), std::string::npos) << taken;
    EXPECT_EQ(taken.find("one value"), std::string::npos) << taken;
}

TEST_F(ProgramTest, OpensOneVolumeOfSeveral) {
    std::string samples;
    for (int point = 0; point < 4 * 4 * 4; ++point)
        for (const char component : {static_cast<char>(point), static_cast<char>(64 - point)})
            samples += component;
    const auto file = folder_.write("pair.mha", "NDims = 3\nDimSize = 4 4 4\nElementNumberOfChannels = 2\n"
                                                "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
                                                    samples);
    const auto picture = folder_ / "out.png";
    const auto undecided = run({file.string(), "--screenshot", picture.string()});
    EXPECT_EQ(undecided.exitCode, 3);
    EXPECT_NE(undecided.standardError.find("--component"), std::string::npos) << undecided.standardError;
    for (const char* component : {"1", "magnitude"}) {
        const auto result = run({file.string(), "--component", component, "--screenshot", picture.string()});
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
    }
    EXPECT_EQ(run({file.string(), "--component", "2", "--screenshot", picture.string()}).exitCode, 3);
}

TEST_F(ProgramTest, TakesAPictureOfTheStartPage) {
    const auto picture = folder_ / "start.png";
    EXPECT_EQ(run({"--screenshot", picture.string()}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::exists(picture));
}

TEST_F(ProgramTest, PassesItsSelfTest) { EXPECT_EQ(run({"--self-test"}).exitCode, 0); }

TEST_F(ProgramTest, TellsItsVersionAndHelp) {
    EXPECT_EQ(run({"--version"}).standardOutput.rfind("isoslider ", 0), 0u);
    EXPECT_NE(run({"--help"}).standardOutput.find("--screenshot"), std::string::npos);
}

TEST_F(ProgramTest, RefusesWrongUsageWithTwo) {
    const std::vector<std::vector<std::string>> wrong{
        {"--bogus"},       {"--isovalue", "bone"}, {"--isovalue", "nan"},          {"--size", "10"},
        {"--size", "0x0"}, {"--screenshot"},       {"--sample", "shell", "a.mha"}, {"--frame", "-1"},
        {"--frame", "x"},  {"--component", "both"}};
    for (const auto& arguments : wrong) {
        const auto result = run(arguments);
        EXPECT_EQ(result.exitCode, 2) << arguments[0];
        expectOneLine(result.standardError);
    }
}

TEST_F(ProgramTest, RefusesBadInputWithThree) {
    const auto bad = folder_.write("bad.mha", "NDims = 3\nDimSize = 1 2 bananas\n");
    const auto result = run({bad.string(), "--screenshot", (folder_ / "out.png").string()});
    EXPECT_EQ(result.exitCode, 3);
    expectOneLine(result.standardError);
    EXPECT_NE(result.standardError.find("bad.mha"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
}

TEST_F(ProgramTest, RefusesAnIndexDamagedWhereOnlyAMoveReadsWithThree) {
    const auto index = folder_ / "damaged.isx";
    const auto source = io::openVolume(writeBall(folder_, "ball.mha", 20));
    ASSERT_TRUE(source.isOk());
    ASSERT_TRUE(preprocess::buildIndex(*source.value(), index, {}).isOk());
    damageFirstMove(index, -6.0);
    const auto result = run({index.string(), "--isovalue", "-6", "--screenshot", (folder_ / "out.png").string()});
    EXPECT_EQ(result.exitCode, 3) << result.signal;
    expectOneLine(result.standardError);
    EXPECT_NE(result.standardError.find("damaged.isx"), std::string::npos) << result.standardError;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
}

TEST_F(ProgramTest, ReportsInputAndOutputFailuresWithFour) {
    EXPECT_EQ(run({(folder_ / "none.mha").string(), "--screenshot", (folder_ / "out.png").string()}).exitCode, 4);
    const auto ball = writeBall(folder_, "ball.mha", 12).string();
    EXPECT_EQ(run({ball, "--screenshot", (folder_ / "no" / "out.png").string()}).exitCode, 4);
}

} // namespace
} // namespace isoslider::test
