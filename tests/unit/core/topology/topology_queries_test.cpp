#include "core/topology/topology_queries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/topology/change_sums.h"
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

// Several steps of the sums, the last one not full.
TopologyCurve manyEvents() {
    std::vector<TopologyEvent> events(3 * ChangeSums::kStep + 17);
    SurfaceCounts counts;
    for (std::uint32_t i = 0; i < events.size(); ++i) {
        TopologyEvent& event = events[i];
        event.isovalue = i;
        event.below = counts;
        event.pieces = {i % 5, i % 3, i % 7, i % 2};
        counts.components = i;
        event.above = counts;
    }
    return {std::move(events), MeasureCurves{{0.0, 4000.0}, {{1.0, 500.0, 1.0, 1.0}, {1.0, 0.0, 1.0, 1.0}}}, true};
}

TEST(ChangeSums, GiveTheDifferencesThatVisitingEventsGives) {
    const TopologyCurve curve = manyEvents();
    const auto sums = ChangeSums::of(curve);
    ASSERT_THAT(sums, IsOk());
    const double last = static_cast<double>(curve.eventCount());
    const std::vector<double> isovalues{-1.0, 0.0, 0.5, 1023.0, 1024.0, 1024.5, 2047.5, 2048.0, 3071.0, last, last + 9};
    for (std::size_t i = 0; i < isovalues.size(); ++i)
        for (std::size_t j = i; j < isovalues.size(); ++j) {
            const auto visited = difference(curve, isovalues[i], isovalues[j]);
            const auto summed = difference(curve, sums.value(), isovalues[i], isovalues[j]);
            ASSERT_THAT(visited, IsOk());
            ASSERT_THAT(summed, IsOk());
            const SurfaceDifference &a = visited.value(), &b = summed.value();
            EXPECT_EQ(a.from, b.from);
            EXPECT_EQ(a.to, b.to);
            EXPECT_EQ((std::array{a.births, a.deaths, a.joins, a.splits, a.events}),
                      (std::array{b.births, b.deaths, b.joins, b.splits, b.events}))
                << isovalues[i] << " to " << isovalues[j];
            EXPECT_EQ(a.volume, b.volume);
        }
    EXPECT_EQ(difference(curve, sums.value(), -1.0, last + 9).value().events, curve.eventCount());
}

// Counts what is visited.
class WatchedCurve final : public TopologySummary {
public:
    explicit WatchedCurve(const TopologyCurve& curve) : curve_(curve) {}
    std::uint64_t eventCount() const override { return curve_.eventCount(); }
    Result<SurfaceCounts> at(double isovalue) const override { return curve_.at(isovalue); }
    bool areCountsExact() const override { return true; }
    const MeasureCurves& curves() const override { return curve_.curves(); }
    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override {
        return curve_.visitEvents(counted(visit));
    }
    Status visitEventsFrom(double isovalue, const std::function<bool(const TopologyEvent&)>& visit) const override {
        return curve_.visitEventsFrom(isovalue, counted(visit));
    }
    mutable std::uint64_t visited = 0;

private:
    std::function<bool(const TopologyEvent&)> counted(const std::function<bool(const TopologyEvent&)>& visit) const {
        return [this, &visit](const TopologyEvent& event) {
            ++visited;
            return visit(event);
        };
    }
    const TopologyCurve& curve_;
};

TEST(ChangeSums, VisitFewEvents) {
    const TopologyCurve curve = manyEvents();
    const WatchedCurve watched(curve);
    const auto sums = ChangeSums::of(watched);
    EXPECT_EQ(watched.visited, curve.eventCount());
    watched.visited = 0;
    ASSERT_THAT(difference(watched, sums.value(), 2000.0, 3050.0), IsOk());
    EXPECT_LE(watched.visited, 2 * (ChangeSums::kStep + 1));
}

TEST(ChangeSums, OfNothingAreNothing) {
    const TopologyCurve none;
    const auto sums = ChangeSums::of(none);
    ASSERT_THAT(sums, IsOk());
    EXPECT_EQ(difference(none, sums.value(), 0.0, 1.0).value().events, 0u);
}

TEST(TopologySummary, VisitsEventsFromAnIsovalue) {
    const TopologyCurve curve = fivePieces();
    const auto from = [&](double isovalue, bool isOwn) {
        std::vector<double> visited;
        const auto visit = [&](const TopologyEvent& event) {
            visited.push_back(event.isovalue);
            return visited.size() < 3;
        };
        const Status status = isOwn ? curve.visitEventsFrom(isovalue, visit)
                                    : curve.TopologySummary::visitEventsFrom(isovalue, visit); // any other kind's
        EXPECT_TRUE(status.isOk());
        return visited;
    };
    for (const bool isOwn : {true, false}) {
        EXPECT_EQ(from(-1.0, isOwn), (std::vector<double>{0, 2, 3}));
        EXPECT_EQ(from(3.0, isOwn), (std::vector<double>{3, 3.5, 8}));
        EXPECT_EQ(from(3.1, isOwn), (std::vector<double>{3.5, 8, 10}));
        EXPECT_TRUE(from(11.0, isOwn).empty());
    }
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

TEST(TopologyQueries, ALargeSurfaceIsSuggestedBeforeASteeperSliver) {
    const auto steepestOf = [](double gradientOfSliver) {
        MeasureCurves curves; // in a box of 100 x 100 x 100
        const std::array<double, 5> areas{0.0, 9000.0, 9000.0, 1000.0, 0.0};
        const std::array<double, 5> gradients{0.0, 2.0, 4.0, gradientOfSliver, 0.0};
        for (std::size_t i = 0; i < areas.size(); ++i) {
            curves.isovalues.push_back(static_cast<double>(i));
            curves.measures.push_back({areas[i], 1e6 - 2.5e5 * static_cast<double>(i), 2.0 * areas[i], gradients[i]});
        }
        std::vector<TopologyEvent> events(2);
        events[0].above.components = events[1].below.components = 1;
        events[1].isovalue = 4.0;
        const auto found = suggestIsovalues(TopologyCurve(std::move(events), std::move(curves), true));
        EXPECT_THAT(found, IsOk());
        EXPECT_EQ(found.value().front().reason, SuggestionReason::StrongestGradient);
        return found.value().front().isovalue;
    };
    EXPECT_EQ(steepestOf(5.0), 2.0) << "a third as wide, and but little steeper";
    EXPECT_EQ(steepestOf(11.0), 2.0);
    EXPECT_EQ(steepestOf(13.0), 3.0) << "three times as steep";
}

TEST(TopologyQueries, OutliersAreNotOfTheUsualRange) {
    MeasureCurves curves;
    for (const auto& [isovalue, volume] :
         {std::pair{1.0, 100.0}, {2.0, 90.0}, {5.0, 10.0}, {9.0, 0.2}, {1e30, 0.02}, {2e30, 0.01}}) {
        curves.isovalues.push_back(isovalue);
        curves.measures.push_back({1.0, volume, 1.0, 1.0});
    }
    const auto usual = usualRange(curves, 0.5, 3e30);
    EXPECT_EQ(usual.below, 2.0);
    EXPECT_EQ(usual.above, 9.0);
    const auto whole = usualRange(curves, 0.5, 40.0); // not ten times as wide
    EXPECT_EQ(whole.below, 0.5);
    EXPECT_EQ(whole.above, 40.0);
    EXPECT_EQ(usualRange(MeasureCurves(), 1.0, 3e30).above, 3e30);
}

TEST(TopologySummary, ListsTheMostPersistentEvents) {
    const TopologyCurve curve = fivePieces();
    const auto isovalues = [&](std::size_t count) {
        std::vector<double> found;
        const auto events = curve.mostNotable(count);
        EXPECT_THAT(events, IsOk());
        for (const WeightedEvent& each : events.value()) {
            EXPECT_EQ(each.weight, each.event.persistence) << "nothing but pieces changes";
            found.push_back(each.event.isovalue);
        }
        return found;
    };
    EXPECT_EQ(isovalues(0), std::vector<double>());
    EXPECT_EQ(isovalues(2), (std::vector<double>{0, 10}));
    EXPECT_EQ(isovalues(4), (std::vector<double>{0, 2, 8, 10}));
    EXPECT_EQ(isovalues(99).size(), 6u);
}

TEST(TopologySummary, StatesWhereItsEventsBeginAndEnd) {
    EXPECT_EQ(fivePieces().ends().value(), std::pair(0.0, 10.0));
    EXPECT_FALSE(TopologyCurve().ends().value());
    std::vector<TopologyEvent> events(5000); // of several pages
    for (std::size_t i = 0; i < events.size(); ++i)
        events[i].isovalue = 0.5 * static_cast<double>(i) - 7.0;
    const TopologyCurve curve(events, {}, true);
    EXPECT_EQ(curve.ends().value(), std::pair(-7.0, 2492.5));
    EXPECT_EQ(curve.TopologySummary::ends().value(), curve.ends().value()) << "as where all are passed over";
    std::size_t seen = 0;
    EXPECT_THAT(curve.visitEvents([&](const TopologyEvent& event) {
        EXPECT_EQ(event.isovalue, events[seen].isovalue);
        return ++seen < 3333;
    }),
                IsOk());
    EXPECT_EQ(seen, 3333u);
}

// Against weights found by looking at all events for each.
TEST(TopologySummary, ListsWhatIsMostNotableOfAnyEvents) {
    std::mt19937 random(6);
    for (int round = 0; round < 200; ++round) {
        std::vector<TopologyEvent> events(1 + random() % 60);
        SurfaceCounts counts;
        double isovalue = 0.0;
        const unsigned rare = 1 + random() % 20;
        for (TopologyEvent& event : events) {
            const auto change = [&] { return random() % rare == 0 ? static_cast<std::int64_t>(random() % 3) - 1 : 0; };
            event.isovalue = isovalue += 1.0 + static_cast<double>(random() % 4);
            event.persistence = static_cast<double>(random() % 6);
            event.below = counts;
            counts.voids += change();
            counts.loops += 2 * change();
            counts.euler += 2 * change();
            event.above = counts;
        }
        const auto weightOf = [&](std::size_t at) {
            double weight = events[at].persistence;
            const auto rise = [&](const auto& countOf) {
                const auto changes = [&](const TopologyEvent& event) {
                    return countOf(event.below) != countOf(event.above);
                };
                if (!changes(events[at]))
                    return;
                double nearest = events.back().isovalue - events.front().isovalue;
                for (std::size_t other = 0; other < events.size(); ++other)
                    if (other != at && changes(events[other]))
                        nearest = std::min(nearest, std::abs(events[other].isovalue - events[at].isovalue));
                weight = std::max(weight, nearest);
            };
            rise([](const SurfaceCounts& each) { return each.handles(); });
            rise([](const SurfaceCounts& each) { return each.voids; });
            rise([](const SurfaceCounts& each) { return each.loops; });
            return weight;
        };
        std::vector<std::pair<double, std::size_t>> ranked; // greatest weight first, of equal ones the first
        for (std::size_t at = 0; at < events.size(); ++at)
            ranked.emplace_back(-weightOf(at), at);
        std::sort(ranked.begin(), ranked.end());
        ranked.resize(std::min<std::size_t>(ranked.size(), 1 + random() % 30));
        std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
        const auto found = TopologyCurve(events, {}, true).mostNotable(ranked.size());
        ASSERT_THAT(found, IsOk());
        ASSERT_EQ(found.value().size(), ranked.size());
        for (std::size_t i = 0; i < ranked.size(); ++i) {
            ASSERT_EQ(found.value()[i].event.isovalue, events[ranked[i].second].isovalue) << round;
            ASSERT_EQ(found.value()[i].weight, -ranked[i].first) << round << ", " << ranked[i].second;
        }
    }
}

// One lone tunnel among pieces, and one that opens and closes again and again.
TEST(TopologySummary, RanksTunnelsByTheirNearestChange) {
    std::vector<TopologyEvent> events;
    SurfaceCounts counts;
    const auto add = [&](double isovalue, int pieces, int tunnels, double persistence) {
        TopologyEvent event;
        event.isovalue = isovalue;
        event.below = counts;
        counts.components += pieces;
        counts.euler += 2 * pieces - 2 * tunnels;
        event.above = counts;
        event.persistence = persistence;
        events.push_back(event);
    };
    add(0, 1, 0, 100);
    for (const double isovalue : {10.0, 11.0, 12.0, 13.0, 14.0, 15.0})
        add(isovalue, 0, counts.handles() == 0 ? 1 : -1, 0);
    add(20, 1, 0, 2);
    add(40, 0, 1, 0);
    add(90, 0, -1, 0);
    add(100, -2, 0, 100);
    const TopologyCurve curve(std::move(events), {}, true);
    const auto notable = curve.mostNotable(5);
    ASSERT_THAT(notable, IsOk());
    std::vector<std::pair<double, double>> found;
    for (const WeightedEvent& each : notable.value())
        found.emplace_back(each.event.isovalue, each.weight);
    EXPECT_EQ(found, (std::vector<std::pair<double, double>>{{0, 100}, {20, 2}, {40, 25}, {90, 50}, {100, 100}}));
    EXPECT_EQ(curve.mostNotable(99).value()[3].weight, 1.0) << "its neighbours are one away";
}

} // namespace
} // namespace isoslider::topology
