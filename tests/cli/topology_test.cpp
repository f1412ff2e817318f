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
        EXPECT_THAT(keysOf(counts),
                    ElementsAre("isovalue", "components", "euler", "boundary_loops", "handles", "voids"));
        const auto surface = runJson({"extract", volume, "--isovalue", isovalue});
        for (const char* key : {"components", "euler", "boundary_loops"})
            EXPECT_EQ(counts[key], surface[key]) << key << " at " << isovalue;
        EXPECT_EQ(runJson({"topology", path("noise.isx"), "--at", isovalue}), counts);
    }
}

TEST_F(CliTopology, ListsTheMostPersistentEvents) {
    const auto volume = noiseVolume(10);
    const auto all = runJson({"topology", volume, "--events", "0"});
    ASSERT_EQ(all["events"].size(), all["event_count"]);
    ASSERT_GT(all["events"].size(), 100u);
    EXPECT_THAT(keysOf(all["events"][0]),
                ElementsAre("isovalue", "kind", "position", "before", "after", "persistence"));
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

TEST_F(CliTopology, DrawsCurvesAtEvenSteps) {
    const auto curves = runJson({"topology", sphereVolume(), "--curves"});
    ASSERT_EQ(curves["isovalue"].size(), 257u);
    for (const char* key : {"components", "euler", "boundary_loops", "handles", "voids"})
        EXPECT_EQ(curves[key].size(), 257u) << key;
    EXPECT_EQ(run({"topology", sphereVolume(), "--at", "5"}).standardOutput,
              "isovalue 5: 1 pieces, 0 tunnels, 0 boundary loops, 0 voids, Euler number 2\n");
}

TEST_F(CliTopology, RefusesWhatItCannotCount) {
    expectRefusal({"topology", edgesIndex(), "--at", "5"}, 3, "holds no samples");
    expectRefusal({"topology", sphereVolume(), "--at", "5", "--curves"}, 2);
    expectRefusal({"topology", sphereVolume(), "--events", "-1"}, 2);
    expectRefusal({"topology", path("missing.mha")}, 4);
}

} // namespace
} // namespace isoslider::test
