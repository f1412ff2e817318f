#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {
namespace {

using testing::ElementsAre;

class CliTopology : public CliTest {};

TEST_F(CliTopology, CountsWhatExtractionCounts) {
    const auto volume = noiseVolume(12);
    runJson({"build", volume, "-o", path("noise.isx")});
    for (const char* isovalue : {"100.5", "700", "864.25", "1500"}) {
        const auto counts = runJson({"topology", volume, "--at", isovalue});
        EXPECT_THAT(keysOf(counts), ElementsAre("isovalue", "components", "euler", "boundary_loops", "handles", "voids",
                                                "area", "volume", "triangles", "mean_gradient"));
        const auto surface = runJson({"extract", volume, "--isovalue", isovalue});
        for (const char* key : {"components", "euler", "boundary_loops"})
            EXPECT_EQ(counts[key], surface[key]) << key << " at " << isovalue;
        const auto ofIndex = runJson({"topology", path("noise.isx"), "--at", isovalue});
        for (const char* key : {"components", "euler", "boundary_loops", "handles", "voids"})
            EXPECT_EQ(ofIndex[key], counts[key]) << key << " at " << isovalue;
        EXPECT_NEAR(ofIndex["area"].get<double>(), counts["area"].get<double>(), 0.01 * counts["area"].get<double>());
    }
}

TEST_F(CliTopology, ListsTheMostPersistentEvents) {
    const auto volume = noiseVolume(10);
    const auto all = runJson({"topology", volume, "--events", "0"});
    ASSERT_EQ(all["events"].size(), all["event_count"]);
    ASSERT_GT(all["events"].size(), 100u);
    EXPECT_THAT(keysOf(all["events"][0]), ElementsAre("isovalue", "kind", "position", "before", "after", "persistence",
                                                      "births", "deaths", "joins", "splits"));
    for (std::size_t i = 1; i < all["events"].size(); ++i)
        EXPECT_EQ(all["events"][i]["before"], all["events"][i - 1]["after"]);
    const auto few = runJson({"topology", volume, "--events", "5"});
    ASSERT_EQ(few["events"].size(), 5u);
    double least = 1e9;
    for (const auto& event : few["events"])
        least = std::min(least, event["persistence"].get<double>());
    std::size_t atLeast = 0;
    for (const auto& event : all["events"])
        atLeast += event["persistence"].get<double>() > least ? 1 : 0;
    EXPECT_LT(atLeast, 5u);
    EXPECT_EQ(runJson({"topology", volume})["event_count"], all["event_count"]);
}

TEST_F(CliTopology, DrawsCurvesWhereTheSurfaceWasMeasured) {
    const auto volume = sphereVolume();
    const auto curves = runJson({"topology", volume, "--curves"});
    const std::size_t steps = curves["isovalue"].size();
    ASSERT_GT(steps, 128u);
    ASSERT_LE(steps, 256u);
    for (const char* key :
         {"components", "euler", "boundary_loops", "handles", "voids", "area", "volume", "triangles", "mean_gradient"})
        EXPECT_EQ(curves[key].size(), steps) << key;
    for (std::size_t step = 5; step < steps; step += 50) {
        const double isovalue = curves["isovalue"][step];
        const auto mesh = runJson({"extract", volume, "--isovalue", fmt::format("{}", isovalue), "-o",
                                   (folder_ / fmt::format("{}.ply", step)).string()});
        EXPECT_NEAR(curves["triangles"][step].get<double>(), mesh["triangles"].get<double>(), 0.5) << isovalue;
    }
    EXPECT_THAT(run({"topology", volume, "--at", "5"}).standardOutput,
                testing::StartsWith("isovalue 5: 1 pieces, 0 tunnels, 0 boundary loops, 0 voids, Euler number 2\n"));
}

TEST_F(CliTopology, AnswersOtherQuestions) {
    const auto volume = sphereVolume(); // distances from a point near the middle
    const auto one = runJson({"topology", volume, "--pieces", "1"});
    ASSERT_FALSE(one["intervals"].empty());
    EXPECT_LT(one["intervals"][0][0], 5);
    EXPECT_GT(one["intervals"][0][1], 5);
    const auto measures = runJson({"topology", volume, "--at", "5"});
    for (const char* question : {"area", "volume"}) {
        const auto found = runJson(
            {"topology", volume, fmt::format("--{}", question), fmt::format("{}", measures[question].get<double>())});
        ASSERT_FALSE(found["isovalues"].empty()) << question;
        double nearest = 1e9;
        for (const auto& isovalue : found["isovalues"])
            nearest = std::min(nearest, std::abs(isovalue.get<double>() - 5.0));
        EXPECT_LT(nearest, 1e-6) << question;
    }
    const auto between = runJson({"topology", volume, "--between", "3", "5"});
    EXPECT_EQ(between["from"]["components"], 1);
    EXPECT_NEAR(std::abs(between["volume_between"].get<double>()), 4.0 / 3.0 * 3.14159265 * (343 - 125),
                15.0); // radii of 7 and 5
    const auto suggested = runJson({"topology", volume, "--suggest"});
    EXPECT_FALSE(suggested["suggestions"].empty());
    for (const auto& suggestion : suggested["suggestions"])
        EXPECT_FALSE(suggestion["reason"].get<std::string>().empty());
    EXPECT_THAT(run({"topology", volume, "--tunnels", "77"}).standardOutput, testing::HasSubstr("no isovalue"));
    expectRefusal({"topology", volume, "--between", "5", "3"}, 2, "lesser");
    expectRefusal({"topology", volume, "--between", "5"}, 2);
}

TEST_F(CliTopology, AddsWhatAnIndexLacks) {
    const auto index = path("bare.isx");
    runJson({"build", sphereVolume(), "-o", index, "--no-topology"});
    const auto size = std::filesystem::file_size(index);
    const auto first = runJson({"topology", index, "--events", "0"});
    EXPECT_GT(std::filesystem::file_size(index), size);
    EXPECT_EQ(runJson({"topology", index, "--events", "0"}), first);
    EXPECT_EQ(runJson({"stats", index}).is_object(), true);
}

TEST_F(CliTopology, RefusesWhatItCannotCount) {
    runJson({"build", sphereVolume(), "-o", path("edges.isx"), "--index", "edges", "--no-topology"});
    expectRefusal({"topology", path("edges.isx"), "--at", "5"}, 3, "holds no samples");
    expectRefusal({"topology", sphereVolume(), "--at", "5", "--curves"}, 2);
    expectRefusal({"topology", sphereVolume(), "--events", "-1"}, 2);
    expectRefusal({"topology", path("missing.mha")}, 4);
}

} // namespace
} // namespace isoslider::test
