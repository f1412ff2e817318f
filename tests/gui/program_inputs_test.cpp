// B104 and B112: displays, drivers and sizes that the program is started with.
#include <sys/resource.h>

#include <array>

#include "tests/gui/program_fixture.h"

namespace isoslider::test {
namespace {

class ProgramInputs : public ProgramTest {
protected:
    void SetUp() override { ball_ = writeBall(folder_, "ball.mha", 24).string(); }

    static bool hasScreen() {
        return qEnvironmentVariable("QT_QPA_PLATFORM") != QLatin1String("offscreen") &&
               qEnvironmentVariableIsSet("DISPLAY");
    }
    ProcessResult takePicture(const std::string& size, const Environment& environment = {}) {
        std::filesystem::remove(picture_);
        return run({ball_, "--isovalue", "-8", "--size", size, "--screenshot", picture_.string()}, environment);
    }
    /// Of the upper left, where the view is: the surface, and nothing else there, is warm.
    int surfacePixels() const {
        const QImage image = pictureAt(picture_);
        int count = 0;
        for (int y = image.height() / 10; y < image.height() / 2; ++y)
            for (int x = 0; x < image.width() * 11 / 20; ++x)
                count += qRed(image.pixel(x, y)) > qBlue(image.pixel(x, y)) + 12 ? 1 : 0;
        return count;
    }

    std::string ball_;
    std::filesystem::path picture_ = folder_ / "picture.png";
};

TEST_F(ProgramInputs, B104_ADriverThatCannotDrawIsNamedAndThePanelsStay) {
    struct Driver {
        Environment environment;
        const char* saying;
    };
    std::vector<Driver> drivers{
        {{{"QT_QPA_PLATFORM", "offscreen"}, {"DISPLAY", ""}}, "the display (offscreen) shows none"},
        {{{"QT_QPA_PLATFORM", "minimal"}, {"DISPLAY", ""}}, "the display (minimal) shows none"}};
    if (hasScreen()) {
        drivers.push_back(
            {{{"QT_QPA_PLATFORM", "offscreen"}}, "the display (offscreen) shows none"}); // with a display at hand
        drivers.push_back({{{"MESA_GL_VERSION_OVERRIDE", "2.1"}}, "has only OpenGL 2.1"});
        drivers.push_back({{{"LIBGL_ALWAYS_INDIRECT", "1"}}, "gives no OpenGL context"});
        drivers.push_back(
            {{{"MESA_GLSL_VERSION_OVERRIDE", "120"}, {"MESA_GL_VERSION_OVERRIDE", "3.2"}}, "has only OpenGL 3.2"});
    }
    for (const auto& driver : drivers) {
        const auto result = takePicture("1100x700", driver.environment);
        EXPECT_EQ(result.exitCode, 0) << driver.saying << ", signal " << result.signal << '\n' << result.standardError;
        EXPECT_NE(result.standardError.find("no surface"), std::string::npos) << result.standardError;
        EXPECT_NE(result.standardError.find(driver.saying), std::string::npos) << result.standardError;
        expectOneLine(result.standardError);
        EXPECT_FALSE(pictureAt(picture_).isNull()) << driver.saying;
        EXPECT_EQ(surfacePixels(), 0) << driver.saying;
    }
}

TEST_F(ProgramInputs, B104_ADriverInSoftwareDraws) {
    if (!hasScreen())
        GTEST_SKIP() << "no display here";
    for (const Environment& environment :
         {Environment{{"LIBGL_ALWAYS_SOFTWARE", "1"}}, Environment{{"MESA_GL_VERSION_OVERRIDE", "3.3"}}}) {
        const auto result = takePicture("1100x700", environment);
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        EXPECT_EQ(result.standardError, "");
        EXPECT_GT(surfacePixels(), 1000);
    }
}

TEST_F(ProgramInputs, B104_ADisplayThatIsNoneEndsTheProgramWithALine) {
    const std::vector<Environment> displays{{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, {"QT_QPA_PLATFORM", ""}},
                                            {{"DISPLAY", ":4711"}, {"QT_QPA_PLATFORM", ""}},
                                            {{"DISPLAY", "nowhere.invalid:0"}, {"QT_QPA_PLATFORM", "xcb"}},
                                            {{"DISPLAY", ""}, {"QT_QPA_PLATFORM", "xcb"}},
                                            {{"QT_QPA_PLATFORM", "bogus"}}};
    for (const auto& environment : displays) {
        const auto result = takePicture("1100x700", environment);
        EXPECT_EQ(result.exitCode, 4) << "signal " << result.signal;
        EXPECT_EQ(result.standardError.rfind("isoslider: no display", 0), 0u) << result.standardError;
        expectOneLine(result.standardError);
    }
}

TEST_F(ProgramInputs, B088_AFileBeyondTheShellsLimitIsAFailedWriteAndNoSignal) {
    const auto volume = writeBall(folder_, "large.mha", 100).string();
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{600'000, before.rlim_max}; // room for the picture, none for an index
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const auto result = run({volume, "--isovalue", "-20", "--size", "600x400", "--screenshot", picture_.string()});
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_EQ(result.exitCode, 4) << result.signal << '\n' << result.standardError;
    EXPECT_NE(result.standardError.find("File too large"), std::string::npos) << result.standardError;
    EXPECT_FALSE(pictureAt(picture_).isNull()) << "which needs no index";
}

TEST_F(ProgramInputs, B112_ScaledScreensAndSmallWindows) {
    struct Screen {
        double scale;
        QSize window;
    };
    for (const auto& [scale, window] :
         {Screen{1.0, {320, 240}}, Screen{1.25, {1000, 700}}, Screen{2.0, {1000, 700}}, Screen{3.0, {320, 240}}}) {
        SCOPED_TRACE(scale);
        const auto size = std::to_string(window.width()) + "x" + std::to_string(window.height());
        const auto result = takePicture(size, {{"QT_SCALE_FACTOR", std::to_string(scale)}});
        EXPECT_EQ(result.exitCode, 0) << result.signal << '\n' << result.standardError;
        const QSize taken = pictureAt(picture_).size();
        EXPECT_NEAR(taken.width(), window.width() * scale, 3.0);
        EXPECT_NEAR(taken.height(), window.height() * scale, 3.0);
        if (hasScreen()) {
            EXPECT_GT(surfacePixels(), 10);
        }
    }
}

TEST_F(ProgramInputs, B112_AWindowOf8K) {
    // Drawing 33 million pixels in software takes a minute.
    const bool draws = hasScreen() && qEnvironmentVariableIsSet("ISOSLIDER_LONG_TESTS");
    const auto result = takePicture("7680x4320", draws ? Environment{} : Environment{{"QT_QPA_PLATFORM", "offscreen"}});
    EXPECT_EQ(result.exitCode, 0) << result.signal << '\n' << result.standardError;
    EXPECT_EQ(pictureAt(picture_).size(), QSize(7680, 4320));
}

} // namespace
} // namespace isoslider::test
