#include "ui/model/topology/topology_model.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

using topology::MeasureCurves;
using topology::SurfaceCounts;
using topology::TopologyEvent;

/// As many pieces as events have happened, and one.
class ListedSummary final : public topology::TopologySummary {
public:
    explicit ListedSummary(std::vector<TopologyEvent> events, MeasureCurves curves = {})
        : events_(std::move(events)), curves_(std::move(curves)) {
        SurfaceCounts counts;
        for (TopologyEvent& event : events_) {
            counts.euler = 2 * ++counts.components;
            event.below = counts;
        }
    }

    std::uint64_t eventCount() const override { return events_.size(); }
    Result<SurfaceCounts> at(double isovalue) const override {
        SurfaceCounts counts;
        counts.components = 1;
        for (const auto& event : events_)
            counts.components += event.isovalue < isovalue ? 1 : 0;
        counts.euler = 2 * counts.components;
        return counts;
    }
    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override {
        for (const auto& event : events_)
            if (!visit(event))
                break;
        return {};
    }
    bool areCountsExact() const override { return true; }
    const MeasureCurves& curves() const override { return curves_; }

private:
    std::vector<TopologyEvent> events_;
    MeasureCurves curves_;
};

TopologyEvent event(double isovalue, double persistence) {
    TopologyEvent made;
    made.isovalue = isovalue;
    made.persistence = persistence;
    made.above.components = 1;
    made.above.euler = 2;
    return made;
}

TopologyModel::Content contentOf(std::vector<TopologyEvent> events, MeasureCurves curves = {}) {
    return TopologyModel::contentOf(std::make_shared<ListedSummary>(std::move(events), std::move(curves))).value();
}

double isovalueOf(const TopologyModel& model, std::optional<std::size_t> at) {
    return at ? model.events()[*at].isovalue : std::nan("");
}

TEST(TopologyModel, IsEmptyAtFirst) {
    TopologyModel model;
    EXPECT_EQ(model.state(), TopologyState::None);
    EXPECT_EQ(model.eventCount(), 0u);
    EXPECT_FALSE(model.next(0.0));
    EXPECT_FALSE(model.previous(0.0));
    EXPECT_FALSE(model.countsAt(0.0));
    EXPECT_TRUE(model.curve(TopologyQuantity::Pieces).values.empty());
    EXPECT_FALSE(model.valueAt(TopologyQuantity::Area, 0.0));
    model.choose(3);
    EXPECT_FALSE(model.chosen());
    EXPECT_EQ(model.fractionOf(1.0), 0.0);
    EXPECT_EQ(model.persistenceAt(0.5), 0.0);
}

TEST(TopologyModel, AnOutlierDoesNotMakeAllOtherEventsSmall) {
    TopologyModel model;
    topology::MeasureCurves curves;
    for (const auto& [isovalue, volume] : {std::pair{1.0, 100.0}, {2.0, 90.0}, {9.0, 0.2}, {1e30, 0.02}}) {
        curves.isovalues.push_back(isovalue);
        curves.measures.push_back({1.0, volume, 1.0, 1.0});
    }
    model.setContent(contentOf({event(1.0, 5.0), event(2.0, 1e30), event(4.0, 3.0), event(1e30, 1e30)}, curves));
    EXPECT_EQ(model.greatestPersistence(), 7.0);
    EXPECT_EQ(model.shown().size(), 4u);
    EXPECT_EQ(model.fractionOf(1e30), 1.0);
}

TEST(TopologyModel, GoesFromEventToEvent) {
    TopologyModel model;
    model.setContent(contentOf({event(1.0, 5.0), event(2.0, 5.0), event(4.0, 5.0)}));
    EXPECT_EQ(isovalueOf(model, model.next(-10.0)), 1.0);
    EXPECT_EQ(isovalueOf(model, model.next(1.0)), 1.0) << "at its isovalue an event has not happened";
    EXPECT_EQ(isovalueOf(model, model.next(model.justPast(0))), 2.0);
    EXPECT_FALSE(model.next(model.justPast(2)));
    EXPECT_EQ(isovalueOf(model, model.previous(10.0)), 4.0);
    EXPECT_EQ(isovalueOf(model, model.previous(model.justPast(2))), 2.0);
    EXPECT_FALSE(model.previous(model.justPast(0)));
    EXPECT_EQ(isovalueOf(model, model.passed(0.5, 1.5)), 1.0);
    EXPECT_EQ(isovalueOf(model, model.passed(1.5, 0.5)), 1.0) << "either way";
    EXPECT_EQ(isovalueOf(model, model.passed(1.0, model.justPast(0))), 1.0) << "at its isovalue it has not happened";
    EXPECT_FALSE(model.passed(model.justPast(0), 2.0));
    EXPECT_FALSE(model.passed(0.5, 0.5));
    const auto most = model.passed(-10.0, 10.0);
    ASSERT_TRUE(most);
    for (const std::size_t event : model.shown())
        EXPECT_LE(model.events()[event].persistence, model.events()[*most].persistence);
    // There and back again.
    double isovalue = -10.0;
    for (const double expected : {1.0, 2.0, 4.0}) {
        const auto at = model.next(isovalue);
        ASSERT_TRUE(at);
        EXPECT_EQ(isovalueOf(model, at), expected);
        isovalue = model.justPast(*at);
    }
    for (const double expected : {2.0, 1.0}) {
        const auto at = model.previous(isovalue);
        ASSERT_TRUE(at);
        EXPECT_EQ(isovalueOf(model, at), expected);
        isovalue = model.justPast(*at);
    }
}

TEST(TopologyModel, PassesTiesInOneStep) {
    TopologyModel model;
    model.setContent(contentOf({event(1.0, 5.0), event(1.0, 7.0), event(1.0, 6.0), event(3.0, 5.0)}));
    const auto first = model.next(0.0);
    ASSERT_TRUE(first);
    EXPECT_EQ(isovalueOf(model, first), 1.0);
    EXPECT_EQ(isovalueOf(model, model.next(model.justPast(*first))), 3.0);
    EXPECT_FALSE(model.previous(model.justPast(*first)));
}

TEST(TopologyModel, ShowsWhatLastsAndIsOfTheWantedKind) {
    TopologyModel model;
    auto tunnel = event(2.5, 40.0);
    tunnel.above = tunnel.below;
    tunnel.above.euler = -2;
    model.setContent(contentOf({event(1.0, 100.0), event(2.0, 1.0), tunnel, event(3.0, 50.0)}));
    EXPECT_EQ(model.leastPersistence(), 2.0);
    EXPECT_EQ(model.shown(), (std::vector<std::size_t>{0, 2, 3}));
    model.setLeastPersistence(0.0);
    EXPECT_EQ(model.shown().size(), 4u);
    model.setLeastPersistence(45.0);
    EXPECT_EQ(model.shown(), (std::vector<std::size_t>{0, 3}));
    model.setLeastPersistence(0.0);
    int changes = 0;
    const auto subscription = model.changed().observe([&] { ++changes; });
    model.setEventFilter(EventFilter::Tunnels);
    EXPECT_EQ(model.shown(), std::vector<std::size_t>{2});
    EXPECT_EQ(isovalueOf(model, model.next(0.0)), 2.5);
    EXPECT_EQ(changes, 1);
    model.setEventFilter(EventFilter::Tunnels);
    model.setLeastPersistence(0.0);
    model.setLeastPersistence(std::nan(""));
    model.setLeastPersistence(-1.0);
    EXPECT_EQ(changes, 1) << "nothing was changed";
    model.setEventFilter(EventFilter::Voids);
    EXPECT_TRUE(model.shown().empty());
    EXPECT_FALSE(model.next(0.0));
}

TEST(TopologyModel, ScalesPersistencesLogarithmically) {
    TopologyModel model;
    model.setContent(contentOf({event(1.0, 1e6)}));
    EXPECT_EQ(model.persistenceAt(0.0), 0.0);
    EXPECT_NEAR(model.persistenceAt(0.5), 1e3, 1e-6);
    EXPECT_EQ(model.persistenceAt(1.0), 1e6);
    for (const double fraction : {0.1, 0.5, 1.0})
        EXPECT_NEAR(model.fractionOf(model.persistenceAt(fraction)), fraction, 1e-12);
    EXPECT_EQ(model.fractionOf(0.0), 0.0);
    EXPECT_EQ(model.fractionOf(1e-3), 0.0) << "below the scale";
    EXPECT_EQ(model.fractionOf(1e9), 1.0);
}

TEST(TopologyModel, TakesAnyNumber) {
    const double infinity = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
    TopologyModel model;
    model.setContent(
        contentOf({event(-most, infinity), event(0.0, 0.0), event(1e-310, 1e-310), event(most, infinity)}));
    EXPECT_TRUE(std::isfinite(model.greatestPersistence()));
    EXPECT_EQ(model.shown().size(), 2u);
    EXPECT_EQ(model.justPast(3), infinity);
    EXPECT_GT(model.justPast(2), 1e-310);
    model.setLeastPersistence(0.0);
    EXPECT_EQ(isovalueOf(model, model.next(1e-312)), 1e-310);
    for (const double isovalue : model.curve(TopologyQuantity::Pieces).isovalues)
        EXPECT_TRUE(std::isfinite(isovalue));
    model.setContent(contentOf({event(1.0, 0.0)}));
    EXPECT_EQ(model.shown().size(), 1u) << "where none lasts, all are shown";
    EXPECT_EQ(model.persistenceAt(1.0), 0.0);
}

TEST(TopologyModel, ForgetsWhatWasChosenWithTheVolume) {
    TopologyModel model;
    model.setContent(contentOf({event(1.0, 5.0), event(2.0, 5.0)}));
    int choices = 0;
    const auto subscription = model.chosenChanged().observe([&] { ++choices; });
    model.choose(1);
    EXPECT_EQ(model.chosen(), std::optional<std::size_t>(1));
    model.choose(1);
    EXPECT_EQ(choices, 2) << "chosen again: to be seen again";
    model.setAnalysing();
    EXPECT_FALSE(model.chosen());
    EXPECT_EQ(choices, 3);
    EXPECT_EQ(model.state(), TopologyState::Analysing);
    EXPECT_EQ(model.greatestPersistence(), 0.0);
    model.setFailed("no space");
    EXPECT_EQ(model.problem(), "no space");
    EXPECT_EQ(model.state(), TopologyState::Failed);
}

TEST(TopologyModel, HasTheCurvesThatWereMade) {
    TopologyModel model;
    model.setContent(contentOf({event(1.0, 5.0), event(2.0, 5.0)}));
    EXPECT_TRUE(model.hasCurve(TopologyQuantity::Pieces));
    EXPECT_FALSE(model.hasCurve(TopologyQuantity::Area));
    EXPECT_TRUE(model.curve(TopologyQuantity::Area).values.empty());
    EXPECT_EQ(model.valueAt(TopologyQuantity::Pieces, 1.5), 2.0);
    const auto pieces = model.curve(TopologyQuantity::Pieces);
    ASSERT_FALSE(pieces.values.empty());
    EXPECT_EQ(pieces.isovalues.front(), 1.0);
    EXPECT_EQ(pieces.isovalues.back(), 2.0);
    EXPECT_EQ(pieces.values.back(), 2.0);

    MeasureCurves curves;
    curves.isovalues = {0.0, 10.0};
    curves.measures = {{2.0, 8.0, 20.0, 1.0}, {4.0, 0.0, 40.0, 3.0}};
    model.setContent(contentOf({}, curves));
    EXPECT_TRUE(model.hasCurve(TopologyQuantity::Gradient));
    EXPECT_FALSE(model.hasCurve(TopologyQuantity::Pieces)) << "one count everywhere";
    EXPECT_EQ(model.curve(TopologyQuantity::Volume).values, (std::vector<double>{8.0, 0.0}));
    EXPECT_EQ(model.valueAt(TopologyQuantity::Area, 5.0), 3.0);
    EXPECT_EQ(model.valueAt(TopologyQuantity::Triangles, 99.0), 40.0);
}

} // namespace
} // namespace isoslider::model
