#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "app/cli/report/line_plot.h"
#include "app/cli/report/volume_measures.h"
#include "tests/cli/cli_fixture.h"

namespace isoslider::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string contentOf(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

std::size_t countOf(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

class CliReport : public test::CliTest {};

TEST_F(CliReport, AgreesWithTheOtherCommands) {
    const std::string volume = sphereVolume();
    std::filesystem::create_directory(path("work"));
    const auto report = runJson({"report", volume, "--folder", path("work"), "--steps", "3"});
    ASSERT_EQ(report["volumes"].size(), 1u);
    const auto& measured = report["volumes"][0];
    EXPECT_EQ(measured["distinct_values"], runJson({"info", volume})["distinct_values"]);
    ASSERT_EQ(measured["indexes"].size(), 2u);
    for (const auto& index : measured["indexes"]) {
        const auto built = runJson({"build", volume, "-o", path("again.isx"), "--index", index["kind"]});
        EXPECT_EQ(index["index_bytes"], built["index_bytes"]);
        EXPECT_EQ(index["levels"], built["levels"]);
    }
    EXPECT_EQ(measured["steps"].size(), 6u);
    for (const auto& step : measured["steps"])
        EXPECT_EQ(step["edges"]["edges_changed"], step["metacells"]["edges_changed"]);
    const std::string at = fmt::format("{:.17g}", measured["isovalue"].get<double>());
    ASSERT_EQ(measured["errors"].size(), 11u);
    const auto trianglesOf = [&](std::vector<std::string> merging) {
        std::vector<std::string> arguments{"extract", volume, "--isovalue", at};
        arguments.insert(arguments.end(), merging.begin(), merging.end());
        return runJson(arguments)["triangles"];
    };
    EXPECT_EQ(measured["errors"][0]["triangles"], trianglesOf({}));
    EXPECT_EQ(measured["errors"][3]["error"], "0.8 %");
    EXPECT_EQ(measured["errors"][3]["triangles"], trianglesOf({"--lod-error", "0.8%"}));
    EXPECT_EQ(measured["errors"][8]["error"], "0.25 cells");
    EXPECT_EQ(measured["errors"][8]["triangles_of_slide"], trianglesOf({"--lod-error", "0.25c", "--lod-levels", "3"}));
    EXPECT_LT(measured["errors"][10]["triangles"], measured["errors"][0]["triangles"]);
    EXPECT_TRUE(std::filesystem::is_empty(path("work"))) << "the indexes are gone";
}

TEST_F(CliReport, WritesAPageWithItsPlotsBesideIt) {
    const auto result = run({"report", sphereVolume("a|b.mha"), sphereVolume("c<d.mha"), "--steps", "2", "--index",
                             "metacells", "-o", path("my page.md")});
    ASSERT_EQ(result.exitCode, 0) << result.standardError;
    const std::string page = contentOf(path("my page.md"));
    EXPECT_THAT(page, HasSubstr("| a_b.mha"));
    EXPECT_THAT(page, HasSubstr("| c<d.mha"));
    EXPECT_THAT(page, HasSubstr("BluntFin"));
    EXPECT_THAT(page, Not(HasSubstr("nan")));
    for (const auto* name : {"active_edges", "steps", "triangles", "triangles_cells"}) {
        const std::string plot = fmt::format("my page_{}.svg", name);
        EXPECT_THAT(page, HasSubstr("](<" + plot + ">)"));
        const std::string svg = contentOf(path(plot));
        EXPECT_THAT(svg, HasSubstr("c&lt;d.mha"));
        EXPECT_EQ(countOf(svg, "<polyline"), std::string(name) == "steps" ? 4u : 2u);
    }
}

TEST_F(CliReport, KeepsWhatWasMeasuredBeforeAVolumeThatFails) {
    const auto result =
        run({"report", rawSphere(), path("gone.raw"), "--raw-dims", "16,16,16", "--raw-type", "f32", "--steps", "2"});
    EXPECT_EQ(result.exitCode, 4) << "looked for before anything is measured";
    folder_.write("short.mha", test::metaImage(16, "MET_FLOAT", "too short"));
    const auto half = run({"report", sphereVolume(), path("short.mha"), "--steps", "2", "-o", path("half.md")});
    EXPECT_EQ(half.exitCode, 3) << half.standardError;
    EXPECT_THAT(contentOf(path("half.md")), HasSubstr("| sphere.mha"));
}

TEST_F(CliReport, RefusesWhatItCannotMeasureOrWrite) {
    expectRefusal({"report"}, 2);
    expectRefusal({"report", sphereIndex()}, 3, "is an index");
    expectRefusal({"report", sphereVolume(), "-o", path("page.txt")}, 2, "written as .md");
    expectRefusal({"report", sphereVolume(), "-o", path("nowhere/page.md")}, 4);
    expectRefusal({"report", sphereVolume(), "--index", "trees"}, 2, "edges, metacells or both");
    expectRefusal({"report", sphereVolume(), "--folder", path("nowhere")}, 4);
    std::filesystem::create_directory(path("page_steps.svg"));
    expectRefusal({"report", sphereVolume(), "-o", path("page.md")}, 4, "page_steps.svg");
}

TEST(WalkAround, KeepsItsStepAndTurnsRound) {
    index::IndexInfo info;
    info.min = 0.0;
    info.max = 100.0;
    const auto isovalues = walkAround(info, 90.0, 5.0, 6);
    ASSERT_EQ(isovalues.size(), 7u);
    EXPECT_EQ(isovalues.front(), 75.0);
    for (std::size_t i = 1; i < isovalues.size(); ++i) {
        EXPECT_NEAR(std::abs(isovalues[i] - isovalues[i - 1]), 5.0, 1e-9);
        EXPECT_LE(isovalues[i], 98.0);
    }
    EXPECT_EQ(isovalues[4], 95.0);
    EXPECT_EQ(isovalues[5], 90.0);
}

TEST(WalkAround, StartsWhereTheMostEdgesAreInTheMiddle) {
    index::IndexInfo info;
    info.min = 10.0;
    info.max = 20.0;
    info.activeEdgesPerBin = {9, 1, 1, 2, 3, 1, 1, 1, 1, 9};
    EXPECT_DOUBLE_EQ(busiestIsovalue(info), 14.0);
    info.activeEdgesPerBin = {5};
    EXPECT_EQ(busiestIsovalue(info), 10.0);
}

TEST(LinePlot, PlacesPointsOnLogarithmicAxes) {
    LinePlot plot{"a & b", "x", "y", true, true, {{"line", {{0.1, 1}, {1, 10}, {10, 100}, {0, 5}, {5, -1}}}}};
    const std::string svg = plot.svg();
    EXPECT_THAT(svg, HasSubstr("a &amp; b"));
    EXPECT_EQ(countOf(svg, "<circle"), 3u) << "what has no logarithm is left out";
    EXPECT_THAT(svg, HasSubstr("points=\"84.0,358.0 327.0,205.0 570.0,52.0\""));
}

TEST(LinePlot, ShowsAnAxisWithoutPointsAndWithOne) {
    LinePlot plot{"", "", "", false, false, {{"none", {}}}};
    EXPECT_THAT(plot.svg(), Not(HasSubstr("nan")));
    plot.lines = {{"one", {{3.0, 1234567.0}}}};
    EXPECT_THAT(plot.svg(), Not(HasSubstr("nan")));
    plot.lines = {{"two", {{-2.0, 0.0}, {3.0, 2000000.0}}}};
    EXPECT_THAT(plot.svg(), HasSubstr(">2,000,000<"));
    EXPECT_THAT(plot.svg(), HasSubstr(">-2<"));
}

} // namespace
} // namespace isoslider::cli
