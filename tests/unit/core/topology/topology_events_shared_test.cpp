// The listed events of 100 grids, where the folder with further test data is there: none missing, none extra.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "core/topology/topology_analysis.h"
#include "tests/support/csv_rows.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

namespace isoslider::topology {
namespace {

std::filesystem::path listed(const char* name) {
    return std::filesystem::path(test::sharedFolder()) / "reference" / "topology" / name;
}

struct ListedEvent {
    double isovalue = 0.0;
    std::string kind;
    SurfaceCounts below, above; // without voids
};

SurfaceCounts withoutVoids(SurfaceCounts counts) {
    counts.voids = 0;
    return counts;
}

TEST(ListedEvents, AreFoundAndNoOthers) {
    if (!std::filesystem::exists(listed("events_4.csv")))
        GTEST_SKIP() << "needs " << listed("events_4.csv");
    std::map<int, std::vector<ListedEvent>> events;
    test::forEachCsvRow(listed("events_4.csv"), [&](std::istringstream& columns) {
        int grid = 0;
        ListedEvent event;
        columns >> grid >> event.isovalue >> event.kind;
        for (SurfaceCounts* counts : {&event.below, &event.above})
            columns >> counts->euler >> counts->components >> counts->loops;
        events[grid].push_back(event);
    });
    int grids = 0;
    std::size_t all = 0;
    test::forEachCsvRow(listed("event_grids_4.csv"), [&](std::istringstream& columns) {
        int id = 0;
        GridGeometry geometry;
        columns >> id >> geometry.dims[0] >> geometry.dims[1] >> geometry.dims[2];
        std::vector<double> samples(64);
        for (double& sample : samples)
            columns >> sample;
        const auto volume = ScalarGrid::fromValues<double>(geometry, ScalarType::F64, samples);
        const auto curve = analyseTopology(planesOf(volume));
        ASSERT_THAT(curve, test::IsOk());
        const auto& found = curve.value().events();
        const auto& expected = events[id];
        ASSERT_EQ(found.size(), expected.size()) << "grid " << id;
        for (std::size_t i = 0; i < found.size(); ++i) {
            SCOPED_TRACE(testing::Message() << "grid " << id << ", isovalue " << expected[i].isovalue);
            EXPECT_NEAR(found[i].isovalue, expected[i].isovalue, 1e-6);
            if (expected[i].kind == "multiple") { // saddles that meet, of several kinds
                EXPECT_NE(found[i].kind, EventKind::Vertex);
            } else {
                EXPECT_EQ(eventKindName(found[i].kind), expected[i].kind);
            }
            EXPECT_EQ(withoutVoids(found[i].below), expected[i].below);
            EXPECT_EQ(withoutVoids(found[i].above), expected[i].above);
        }
        ++grids;
        all += found.size();
    });
    EXPECT_EQ(grids, 100);
    EXPECT_GT(all, 6000u);
}

} // namespace
} // namespace isoslider::topology
