#include "core/topology/topology_queries.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/topology/topology_curve.h"
#include "tests/support/result_matchers.h"

namespace isoslider::topology {
namespace {

using test::IsOk;

// Pieces: 1 above 0, 2 above 2, 3 above 3, 2 above 3.5, 1 above 8, none above 10.
TopologyCurve fivePieces() {
    std::vector<TopologyEvent> events;
    SurfaceCounts counts;
    const auto add = [&](double isovalue, std::int64_t pieces, PieceChanges changes, double persistence) {
        TopologyEvent event;
        event.isovalue = isovalue;
        event.below = counts;
        counts.components = pieces;
        counts.euler = 2 * pieces;
        event.above = counts;
        event.pieces = changes;
        event.persistence = persistence;
        events.push_back(event);
    };
    add(0, 1, {1, 0, 0, 0}, 10);
    add(2, 2, {0, 0, 0, 1}, 6);
    add(3, 3, {0, 0, 0, 1}, 0.5);
    add(3.5, 2, {0, 1, 0, 0}, 0.5);
    add(8, 1, {0, 1, 0, 0}, 6);
    add(10, 0, {0, 1, 0, 0}, 10);
    MeasureCurves curves;
    for (int i = 0; i <= 10; ++i) {
        const double area = i < 5 ? 10.0 * i : 10.0 * (10 - i);
        curves.isovalues.push_back(i);
        curves.measures.push_back({area, 100.0 - 10.0 * i, 2 * area, i == 6 ? 5.0 : i == 10 ? 50.0 : 1.0});
    }
    return {std::move(events), std::move(curves), true};
}

TEST(TopologyQueries, FindIntervalsWithSoManyPieces) {
    const TopologyCurve curve = fivePieces();
    const auto intervals = [&](std::int64_t pieces) {
        const auto found =
            intervalsWith(curve, [&](const SurfaceCounts& counts) { return counts.components == pieces; });
        EXPECT_THAT(found, IsOk());
        std::vector<std::pair<double, double>> pairs;
        for (const auto& interval : found.value())
            pairs.emplace_back(interval.below, interval.above);
        return pairs;
    };
    using Pairs = std::vector<std::pair<double, double>>;
    EXPECT_EQ(intervals(2), (Pairs{{2, 3}, {3.5, 8}}));
    EXPECT_EQ(intervals(3), (Pairs{{3, 3.5}}));
    EXPECT_EQ(intervals(4), Pairs());
    // Intervals that touch are one.
    const auto some = intervalsWith(curve, [](const SurfaceCounts& counts) { return counts.components >= 2; });
    ASSERT_THAT(some, IsOk());
    ASSERT_EQ(some.value().size(), 1u);
    EXPECT_EQ(some.value()[0].below, 2);
    EXPECT_EQ(some.value()[0].above, 8);
    // A count holds in each interval, and not at its lower end.
    EXPECT_EQ(curve.countsAt(2.0).components, 1);
    EXPECT_EQ(curve.countsAt(3.0).components, 2);
}

TEST(TopologyQueries, FindIsovaluesOfAnArea) {
    const TopologyCurve curve = fivePieces();
    EXPECT_EQ(isovaluesWith(curve.curves(), &SurfaceMeasures::area, 25.0), (std::vector<double>{2.5, 7.5}));
    EXPECT_EQ(isovaluesWith(curve.curves(), &SurfaceMeasures::area, 50.0), (std::vector<double>{5.0}));
    EXPECT_TRUE(isovaluesWith(curve.curves(), &SurfaceMeasures::area, 51.0).empty());
    EXPECT_EQ(isovaluesWith(curve.curves(), &SurfaceMeasures::volume, 35.0), (std::vector<double>{6.5}));
    EXPECT_TRUE(isovaluesWith({}, &SurfaceMeasures::volume, 0.0).empty());
}

TEST(TopologyQueries, TellWhatHappensBetweenTwoIsovalues) {
    const TopologyCurve curve = fivePieces();
    const auto found = difference(curve, 1.0, 3.5); // at 3.5 the event there has not happened
    ASSERT_THAT(found, IsOk());
    EXPECT_EQ(found.value().from.components, 1);
    EXPECT_EQ(found.value().to.components, 3);
    EXPECT_EQ(found.value().splits, 2u);
    EXPECT_EQ(found.value().deaths, 0u);
    EXPECT_EQ(found.value().events, 2u);
    EXPECT_DOUBLE_EQ(found.value().volume, 25.0);
    EXPECT_EQ(difference(curve, 2.0, 2.0).value().events, 0u);
    EXPECT_EQ(difference(curve, 2.0, 2.5).value().splits, 1u);
}

TEST(TopologyQueries, SuggestWithAReason) {
    const auto found = suggestIsovalues(fivePieces());
    ASSERT_THAT(found, IsOk());
    ASSERT_EQ(found.value().size(), 4u);
    EXPECT_EQ(found.value()[0].reason, SuggestionReason::StrongestGradient);
    EXPECT_EQ(found.value()[0].isovalue, 6) << "not where next to nothing is left";
    EXPECT_EQ(found.value()[1].reason, SuggestionReason::WidestInterval);
    EXPECT_EQ(found.value()[1].isovalue, 5.75) << "from 3.5 to 8";
    EXPECT_EQ(found.value()[2].reason, SuggestionReason::LargestPiece);
    EXPECT_EQ(found.value()[2].isovalue, std::nextafter(2.0, 3.0));
    EXPECT_EQ(found.value()[3].reason, SuggestionReason::HalfVolume);
    EXPECT_EQ(found.value()[3].isovalue, 5);
    EXPECT_TRUE(suggestIsovalues(TopologyCurve()).value().empty());
}

TEST(TopologySummary, ListsTheMostPersistentEvents) {
    const TopologyCurve curve = fivePieces();
    const auto isovalues = [&](std::size_t count) {
        std::vector<double> found;
        const auto events = curve.mostPersistent(count);
        EXPECT_THAT(events, IsOk());
        for (const TopologyEvent& event : events.value())
            found.push_back(event.isovalue);
        return found;
    };
    EXPECT_EQ(isovalues(0), std::vector<double>());
    EXPECT_EQ(isovalues(2), (std::vector<double>{0, 10}));
    EXPECT_EQ(isovalues(4), (std::vector<double>{0, 2, 8, 10}));
    EXPECT_EQ(isovalues(99).size(), 6u);
}

} // namespace
} // namespace isoslider::topology
