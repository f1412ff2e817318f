#include "tests/cli/cli_fixture.h"

#include <filesystem>

#include <fmt/format.h>

namespace isoslider::test {

using ::testing::HasSubstr;

class CliResample : public CliTest {
protected:
    /// x + 2y + 4z at the points of a rectilinear grid whose x axis is not even.
    std::string rectilinear(const std::string& name = "grid.vtk") const {
        const double xs[] = {0, 1, 3, 6, 10}, ys[] = {0, 1, 2, 3}, zs[] = {0, 2, 4};
        std::string text =
            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 5 4 3\n"
            "X_COORDINATES 5 double\n0 1 3 6 10\nY_COORDINATES 4 double\n0 1 2 3\n"
            "Z_COORDINATES 3 double\n0 2 4\nPOINT_DATA 60\nSCALARS ramp double 1\nLOOKUP_TABLE default\n";
        for (const double z : zs)
            for (const double y : ys)
                for (const double x : xs)
                    text += fmt::format("{}\n", x + 2 * y + 4 * z);
        folder_.write(name, text);
        return path(name);
    }
};

TEST_F(CliResample, WritesAUniformVolumeAndTellsWhatWasLost) {
    const auto json = runJson({"resample", rectilinear(), "-o", path("a.mha"), "--size", "21,4,3"});
    EXPECT_THAT(keysOf(json), ::testing::ElementsAre("dims", "spacing", "origin", "scalar_type", "field",
                                                     "source_points", "compared_points", "max_difference",
                                                     "rms_difference", "range_fraction", "outside_points"));
    EXPECT_EQ(json["dims"], OrderedJson({21, 4, 3}));
    EXPECT_EQ(json["spacing"], OrderedJson({0.5, 1.0, 2.0}));
    EXPECT_EQ(json["source_points"], 60);
    EXPECT_EQ(json["compared_points"], 60);
    EXPECT_LT(json["max_difference"], 1e-5) << "a ramp is kept by linear interpolation";
    EXPECT_EQ(json["outside_points"], 0);
    const auto written = runJson({"info", path("a.mha")});
    EXPECT_EQ(written["dims"], json["dims"]);
    EXPECT_EQ(written["min"], 0.0);
    EXPECT_NEAR(written["max"].get<double>(), 10 + 6 + 16, 1e-5);
    const auto coarse = runJson({"resample", rectilinear(), "-o", path("b.mha"), "--size", "2,2,2"});
    EXPECT_EQ(coarse["dims"], OrderedJson({2, 2, 2}));
    EXPECT_THAT(run({"resample", rectilinear(), "-o", path("c.mha")}).standardOutput, HasSubstr("largest difference"));
    EXPECT_EQ(runJson({"info", path("c.mha")})["dims"], OrderedJson({11, 4, 3}));
}

TEST_F(CliResample, IsRefusedForAUniformGrid) {
    const auto volume = sphereVolume(), index = sphereIndex();
    const std::string saying = volume + ": --resample cannot apply to a uniform grid";
    const std::vector<std::string> size{"--resample", "4,4,4"};
    for (std::vector<std::string> arguments : {std::vector<std::string>{"info", volume},
                                               {"extract", volume, "--isovalue", "5"},
                                               {"topology", volume},
                                               {"build", volume, "-o", path("a.isx")},
                                               {"report", volume},
                                               {"validate", index, "--against", volume}}) {
        arguments.insert(arguments.end(), size.begin(), size.end());
        expectRefusal(arguments, 2, saying);
    }
    const auto grid = rectilinear();
    EXPECT_EQ(runJson({"info", grid, "--resample", "4,4,4"})["dims"], OrderedJson({4, 4, 4}));
    EXPECT_EQ(run({"report", volume, grid, "--resample", "4,4,4", "--steps", "1", "--index", "metacells"}).exitCode, 0)
        << "one of them is resampled";
}

TEST_F(CliResample, IsReportedByEveryCommandThatResamples) {
    // A spike at a point that the uniform grid has none near.
    std::string text = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 4 2 2\n"
                       "X_COORDINATES 4 double\n0 0.01 2 3\nY_COORDINATES 2 double\n0 1\n"
                       "Z_COORDINATES 2 double\n0 1\nPOINT_DATA 16\nSCALARS spike double 1\nLOOKUP_TABLE default\n";
    for (int i = 0; i < 4; ++i)
        text += "0 100 0 0\n";
    const auto grid = folder_.write("spike.vtk", text).string();
    const auto expectLoss = [](const OrderedJson& json) {
        ASSERT_TRUE(json.contains("resampled")) << json;
        EXPECT_THAT(keysOf(json["resampled"]),
                    ::testing::ElementsAre("source_points", "compared_points", "max_difference", "rms_difference",
                                           "range_fraction", "outside_points", "text"));
        EXPECT_GT(json["resampled"]["range_fraction"].get<double>(), 0.4);
    };
    expectLoss(runJson({"info", grid}));
    expectLoss(runJson({"build", grid, "-o", path("a.isx")}));
    expectLoss(runJson({"extract", grid, "--isovalue", "20", "-o", path("a.ply")}));
    constexpr const char* kLine = "onto 128 x 2 x 2 points, off by up to ";
    EXPECT_THAT(run({"info", grid}).standardOutput, HasSubstr(std::string("resampled        ") + kLine));
    EXPECT_THAT(run({"build", grid, "-o", path("b.isx")}).standardOutput, HasSubstr(std::string("resampled ") + kLine));
    EXPECT_THAT(run({"extract", grid, "--isovalue", "20"}).standardOutput, HasSubstr(kLine));
    EXPECT_THAT(readText(path("a.ply")).substr(0, 1000), HasSubstr(std::string("comment resampled: ") + kLine));
    // The index keeps it for all that is made of it.
    for (const auto& json : {runJson({"info", path("a.isx")}),
                             runJson({"extract", path("a.isx"), "--isovalue", "20", "-o", path("i.ply")})})
        EXPECT_THAT(json["resampled"]["text"].get<std::string>(), HasSubstr(kLine));
    EXPECT_THAT(readText(path("i.ply")).substr(0, 1000), HasSubstr(std::string("comment resampled: ") + kLine));
    // A grid that is uniform is not, and nobody reports it.
    for (const auto& json : {runJson({"info", sphereVolume()}), runJson({"extract", sphereVolume(), "--isovalue", "5"}),
                             runJson({"build", sphereVolume(), "-o", path("c.isx")})})
        EXPECT_FALSE(json.contains("resampled"));
}

TEST_F(CliResample, RefusesWhatNeedsNone) {
    expectRefusal({"resample", sphereVolume(), "-o", path("a.mha")}, 3, "uniform grid");
    expectRefusal({"resample", rectilinear(), "-o", path("a.nrrd")}, 2, ".mha");
    expectRefusal({"resample", rectilinear(), "-o", path("a.mha"), "--size", "1,2"}, 2, "--size");
    expectRefusal({"resample", rectilinear(), "-o", path("a.mha"), "--size", "0,2,2"}, 3, "extent 0");
    expectRefusal({"resample", rectilinear("a.vtk"), "-o", path("a.vtk")}, 2, "input");
    expectRefusal({"resample", path("none.vts"), "-o", path("a.mha")}, 4, "none.vts");
    EXPECT_FALSE(std::filesystem::exists(path("a.mha")));
}

} // namespace isoslider::test
