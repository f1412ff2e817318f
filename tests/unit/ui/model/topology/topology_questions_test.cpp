// What can be asked of a topology: suggestions, isovalues with a count or a measure, and what lies between two.
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/topology/topology_curve.h"
#include "tests/support/result_matchers.h"
#include "tests/unit/ui/main_thread_queue.h"
#include "ui/model/topology/comparison.h"
#include "ui/model/topology/question_model.h"
#include "ui/model/topology/suggested_isovalue.h"

namespace isoslider::model {
namespace {

using test::HasError;
using test::IsOk;
using testing::ElementsAre;
using topology::MeasureCurves;
using topology::PieceChanges;
using topology::SurfaceCounts;
using topology::TopologyEvent;
using Curve = topology::TopologyCurve;

/// Pieces: 1 above 0, 2 above 2, 3 above 4, 1 above 6, none above 10; a tunnel above 2 up to 6. The volume falls from
/// 100 to 0, the area rises to 50 at 5 and falls again.
Curve fewEvents(bool hasCurves = true, bool areCountsExact = true) {
    std::vector<TopologyEvent> events;
    SurfaceCounts counts;
    const auto add = [&](double isovalue, std::int64_t pieces, std::int64_t tunnels, PieceChanges changes) {
        TopologyEvent event;
        event.isovalue = isovalue;
        event.below = counts;
        counts.components = pieces;
        counts.euler = 2 * pieces - 2 * tunnels;
        event.above = counts;
        event.pieces = changes;
        event.persistence = 1.0;
        events.push_back(event);
    };
    add(0, 1, 0, {1, 0, 0, 0});
    add(2, 2, 1, {0, 0, 0, 1});
    add(4, 3, 1, {1, 0, 0, 0});
    add(6, 1, 0, {0, 1, 1, 0});
    add(10, 0, 0, {0, 1, 0, 0});
    MeasureCurves curves;
    for (int i = 0; hasCurves && i <= 10; ++i) {
        curves.isovalues.push_back(i);
        curves.measures.push_back({i < 5 ? 10.0 * i : 10.0 * (10 - i), 100.0 - 10.0 * i, 20.0, 1.0});
    }
    return {std::move(events), std::move(curves), areCountsExact};
}

// --- suggestions

TEST(SuggestedIsovalues, AreOneForEachReasonAndTheHistogramsLast) {
    using topology::SuggestionReason;
    const std::vector<topology::Suggestion> ofTopology{{7.0, SuggestionReason::StrongestGradient},
                                                       {12.0, SuggestionReason::WidestInterval},
                                                       {3.0, SuggestionReason::HalfVolume},
                                                       {4.0, SuggestionReason::HalfVolume}};
    const auto suggested = suggestedIsovalues(ofTopology, 5.0, {0.0, 10.0});
    ASSERT_EQ(suggested.size(), 3u) << "12 is not within the range";
    EXPECT_EQ(suggested[0], (SuggestedIsovalue{7.0, "greatest mean gradient on the surface, weighed by its size"}));
    EXPECT_EQ(suggested[1].isovalue, 3.0);
    EXPECT_EQ(suggested[2], (SuggestedIsovalue{5.0, kHistogramReason}));
    EXPECT_TRUE(suggestedIsovalues({}, std::nullopt, {0.0, 10.0}).empty());
    EXPECT_EQ(suggestionText({32.5, "middle of something"}), "32.5: middle of something");
}

TEST(SuggestedIsovalues, AreWholeNumbersOfWholeNumbers) {
    const SuggestedRange bytes{0.0, 255.0, ScalarType::U8}, hounsfield{-1024.0, 3071.0, ScalarType::I16};
    EXPECT_EQ(suggestedAs(124.0234375, bytes), 125.0) << "the same samples are above both";
    EXPECT_EQ(suggestedAs(124.0, bytes), 124.0);
    EXPECT_EQ(suggestedAs(254.5, bytes), 255.0);
    EXPECT_EQ(suggestedAs(-386.79296875, hounsfield), -386.0);
    EXPECT_EQ(suggestedAs(124.0234375, {0.0, 255.0, ScalarType::F32}), 124.0234375);
    EXPECT_EQ(suggestedAs(0.2, {0.0, 1.0, ScalarType::U8}), 0.5) << "of a mask the surface is between its samples";
    EXPECT_EQ(suggestedAs(7.0, {7.0, 7.0, ScalarType::I32}), 7.0);
    const auto suggested =
        suggestedIsovalues({{124.0234375, topology::SuggestionReason::StrongestGradient}}, std::nullopt, bytes);
    ASSERT_EQ(suggested.size(), 1u);
    EXPECT_EQ(suggested[0].isovalue, 125.0);
}

// --- what is typed

TEST(IsovalueQuery, TakesWholeNumbersForCountsAndNumbersForMeasures) {
    const auto valueOf = [](QueryQuantity quantity, const char* typed) {
        const auto query = queryOf(quantity, typed);
        return query.isOk() ? query.value().value : -1.0;
    };
    EXPECT_EQ(valueOf(QueryQuantity::Pieces, "12"), 12.0);
    EXPECT_EQ(valueOf(QueryQuantity::Pieces, " 1,234 "), 1234.0);
    EXPECT_EQ(valueOf(QueryQuantity::Voids, "0"), 0.0);
    EXPECT_EQ(valueOf(QueryQuantity::Area, "1.5e3"), 1500.0);
    for (const char* typed : {"2.5", "-1", "x", "1x", "", "nan", "inf", "1e300", "--1"})
        EXPECT_THAT(queryOf(QueryQuantity::Tunnels, typed), HasError(ErrorCode::InvalidArgument)) << typed;
    for (const char* typed : {"-1", "x", "", "nan", "inf", "1e999"})
        EXPECT_THAT(queryOf(QueryQuantity::Volume, typed), HasError(ErrorCode::InvalidArgument)) << typed;
}

// --- what is found

std::vector<std::string> found(const Curve& curve, QueryQuantity quantity, double value) {
    const auto answer = findIsovalues(curve, {quantity, value});
    EXPECT_THAT(answer, IsOk());
    std::vector<std::string> texts;
    for (const auto& interval : answer.value().intervals)
        texts.push_back(intervalText(interval));
    EXPECT_EQ(answer.value().count, texts.size());
    return texts;
}

TEST(FindIsovalues, ByCountsAndByMeasures) {
    const Curve curve = fewEvents();
    EXPECT_THAT(found(curve, QueryQuantity::Pieces, 1), ElementsAre("0 … 2", "6 … 10"));
    EXPECT_THAT(found(curve, QueryQuantity::Pieces, 3), ElementsAre("4 … 6"));
    EXPECT_THAT(found(curve, QueryQuantity::Tunnels, 1), ElementsAre("2 … 6"));
    EXPECT_THAT(found(curve, QueryQuantity::Voids, 0), ElementsAre("0 … 10"));
    EXPECT_THAT(found(curve, QueryQuantity::Area, 25), ElementsAre("2.5", "7.5"));
    EXPECT_THAT(found(curve, QueryQuantity::Volume, 35), ElementsAre("6.5"));
    EXPECT_TRUE(found(curve, QueryQuantity::Pieces, 7).empty());
    const auto none = findIsovalues(curve, {QueryQuantity::Pieces, 7});
    EXPECT_EQ(none.value().least, 1.0);
    EXPECT_EQ(none.value().greatest, 3.0);
    const auto area = findIsovalues(curve, {QueryQuantity::Area, 51});
    EXPECT_EQ(area.value().greatest, 50.0);
}

TEST(FindIsovalues, LeadsToOneThatHasIt) {
    const Curve curve = fewEvents();
    for (const double pieces : {1.0, 2.0, 3.0}) {
        const auto answer = findIsovalues(curve, {QueryQuantity::Pieces, pieces});
        for (const auto& interval : answer.value().intervals)
            EXPECT_EQ(valueAt(curve, QueryQuantity::Pieces, isovalueIn(interval)).value(), pieces);
    }
    // Between neighbouring doubles only the upper one is within.
    const double next = std::nextafter(1.0, 2.0);
    EXPECT_EQ(isovalueIn({1.0, next}), next);
    EXPECT_EQ(isovalueIn({3.0, 3.0}), 3.0);
    const double most = std::numeric_limits<double>::max();
    EXPECT_EQ(isovalueIn({-most, most}), 0.0);
}

TEST(FindIsovalues, KeepsTheWidestOfMany) {
    std::vector<TopologyEvent> events;
    double isovalue = 0.0;
    for (int i = 0; i < 1000; ++i) {
        TopologyEvent event;
        isovalue += i % 2 == 0 ? 1.0 : 1.0 + i;
        event.isovalue = isovalue;
        event.below.components = i % 2;
        event.above.components = (i + 1) % 2;
        events.push_back(event);
    }
    const Curve curve(std::move(events), {}, true);
    const auto answer = findIsovalues(curve, {QueryQuantity::Pieces, 1});
    ASSERT_THAT(answer, IsOk());
    EXPECT_EQ(answer.value().count, 500u);
    ASSERT_EQ(answer.value().intervals.size(), kMostFound);
    double least = 1e9, before = 0.0;
    for (const auto& interval : answer.value().intervals) {
        least = std::min(least, interval.above - interval.below);
        EXPECT_GT(interval.below, before) << "they ascend";
        before = interval.below;
    }
    EXPECT_GE(least, 600.0);
}

TEST(IsovalueQuery, KnowsWhatCanBeAskedFor) {
    EXPECT_TRUE(isKnown(fewEvents(), QueryQuantity::Tunnels));
    EXPECT_TRUE(isKnown(fewEvents(), QueryQuantity::Area));
    EXPECT_FALSE(isKnown(fewEvents(false), QueryQuantity::Volume));
    EXPECT_FALSE(isKnown(fewEvents(true, false), QueryQuantity::Tunnels)) << "samples are missing";
    EXPECT_TRUE(isKnown(fewEvents(true, false), QueryQuantity::Pieces));
    EXPECT_FALSE(isKnown(Curve(), QueryQuantity::Pieces));
    EXPECT_EQ(valueAt(fewEvents(), QueryQuantity::Volume, 2.5).value(), 75.0);
}

// --- what lies between

TEST(Comparison, CountsOnTheWayFromTheReference) {
    const Curve curve = fewEvents();
    const auto sums = topology::ChangeSums::of(curve);
    const auto up = compare(curve, sums.value(), 1.0, 7.0);
    ASSERT_THAT(up, IsOk());
    EXPECT_EQ(up.value().before.components, 1);
    EXPECT_EQ(up.value().after.components, 1);
    EXPECT_EQ(up.value().events, 3u);
    EXPECT_EQ(up.value().appear, 1u);
    EXPECT_EQ(up.value().disappear, 1u);
    EXPECT_EQ(up.value().split, 1u);
    EXPECT_EQ(up.value().join, 1u);
    EXPECT_EQ(up.value().volumeBetween, 60.0);
    // Downwards, everything is the other way round.
    const auto partly = compare(curve, sums.value(), 3.0, 1.0);
    EXPECT_EQ(partly.value().before.components, 2);
    EXPECT_EQ(partly.value().after.components, 1);
    EXPECT_EQ(partly.value().join, 1u) << "what splits upwards";
    EXPECT_EQ(partly.value().split, 0u);
    EXPECT_EQ(partly.value().volumeBetween, 20.0) << "never negative";
    EXPECT_EQ(partly.value().measuresBefore->volume, 70.0);
    EXPECT_EQ(partly.value().measuresAfter->volume, 90.0);
    const auto gone = compare(curve, sums.value(), 5.0, 3.0);
    EXPECT_EQ(gone.value().disappear, 1u) << "what appears upwards";
    EXPECT_EQ(gone.value().appear, 0u);
    const auto same = compare(curve, sums.value(), 5.0, 5.0);
    EXPECT_EQ(same.value().events, 0u);
    EXPECT_EQ(same.value().volumeBetween, 0.0);
}

TEST(Comparison, StatesNoVolumeWithoutCurves) {
    const Curve curve = fewEvents(false, false);
    const auto found = compare(curve, topology::ChangeSums::of(curve).value(), 1.0, 7.0);
    ASSERT_THAT(found, IsOk());
    EXPECT_FALSE(found.value().volumeBetween);
    EXPECT_FALSE(found.value().measuresBefore);
    EXPECT_FALSE(found.value().areCountsExact);
}

// --- the model of the search

/// Waits in every pass until it may go on; may fail.
class SlowSummary final : public topology::TopologySummary {
public:
    std::uint64_t eventCount() const override { return curve_.eventCount(); }
    Result<SurfaceCounts> at(double isovalue) const override { return curve_.at(isovalue); }
    bool areCountsExact() const override { return true; }
    const MeasureCurves& curves() const override { return curve_.curves(); }
    Status visitEvents(const std::function<bool(const TopologyEvent&)>& visit) const override {
        std::unique_lock lock(mutex_);
        ++passes_;
        wake_.wait(lock, [this] { return !isHeld_; });
        if (fails_)
            return makeError(ErrorCode::IoError, "the disk is gone");
        return curve_.visitEvents(visit);
    }
    void hold(bool isHeld) {
        const std::lock_guard lock(mutex_);
        isHeld_ = isHeld;
        wake_.notify_all();
    }
    void fail() {
        const std::lock_guard lock(mutex_);
        fails_ = true;
    }
    int passes() const {
        const std::lock_guard lock(mutex_);
        return passes_;
    }

private:
    Curve curve_ = fewEvents();
    mutable std::mutex mutex_;
    mutable std::condition_variable wake_;
    mutable int passes_ = 0;
    bool isHeld_ = false, fails_ = false;
};

class QuestionModelTest : public ::testing::Test {
protected:
    QuestionModelTest() { topology_.setContent(TopologyModel::contentOf(summary_).value()); }
    ~QuestionModelTest() override { summary_->hold(false); }
    bool wait() {
        return queue_.runUntil([this] { return question_.state() != QuestionState::Searching; });
    }

    test::MainThreadQueue queue_;
    std::shared_ptr<SlowSummary> summary_ = std::make_shared<SlowSummary>();
    TopologyModel topology_;
    QuestionModel question_{topology_, std::make_shared<BackgroundJobs>(queue_.poster())};
};

TEST_F(QuestionModelTest, AnswersInWords) {
    EXPECT_EQ(question_.state(), QuestionState::Empty);
    EXPECT_EQ(question_.answerText("mm"), "");
    const auto answerTo = [this](QueryQuantity quantity, const char* typed) {
        question_.ask(quantity, typed);
        EXPECT_TRUE(wait());
        return question_.answerText("mm");
    };
    EXPECT_EQ(answerTo(QueryQuantity::Pieces, "1"), "2 intervals with 1 piece");
    EXPECT_EQ(answerTo(QueryQuantity::Tunnels, "1"), "1 interval with 1 tunnel");
    EXPECT_EQ(answerTo(QueryQuantity::Loops, "0"), "1 interval with 0 boundary loops");
    EXPECT_EQ(answerTo(QueryQuantity::Area, "25"), "2 isovalues with an area of 25 mm²");
    EXPECT_EQ(answerTo(QueryQuantity::Pieces, "7"), "No isovalue has 7 pieces; the most is 3");
    EXPECT_EQ(answerTo(QueryQuantity::Pieces, "0"), "No isovalue has 0 pieces; the least is 1");
    EXPECT_EQ(answerTo(QueryQuantity::Area, "51"), "No isovalue has an area of 51 mm²; the most is 50 mm²");
    EXPECT_EQ(question_.answerText(""), "No isovalue has an area of 51 units²; the most is 50 units²");
    EXPECT_EQ(answerTo(QueryQuantity::Volume, "1e9"),
              "No isovalue has a volume of 1,000,000,000 mm³ above it; the most is 100 mm³");
    EXPECT_EQ(answerTo(QueryQuantity::Pieces, "2.5"), "Only whole numbers are counted");
    EXPECT_EQ(question_.state(), QuestionState::Invalid);
    EXPECT_EQ(answerTo(QueryQuantity::Pieces, "  "), "");
    EXPECT_EQ(question_.state(), QuestionState::Empty);
}

TEST_F(QuestionModelTest, OnlyTheNewestQuestionIsAnswered) {
    summary_->hold(true);
    const int before = summary_->passes();
    std::vector<std::uint64_t> counts;
    const auto subscription = question_.changed().observe([&] {
        if (question_.state() == QuestionState::Answered)
            counts.push_back(question_.found().count);
    });
    for (const char* typed : {"1", "3", "7", "2"})
        question_.ask(QueryQuantity::Pieces, typed);
    EXPECT_EQ(question_.answerText(""), "Searching…");
    summary_->hold(false);
    ASSERT_TRUE(wait());
    EXPECT_EQ(question_.answerText(""), "1 interval with 2 pieces");
    EXPECT_EQ(counts, std::vector<std::uint64_t>{1});
    EXPECT_LE(summary_->passes(), before + 2) << "what was asked in between was not searched for";
}

TEST_F(QuestionModelTest, WhatWasFoundStaysWhileTheNextIsSearchedFor) {
    question_.ask(QueryQuantity::Pieces, "1");
    ASSERT_TRUE(wait());
    summary_->hold(true);
    question_.ask(QueryQuantity::Pieces, "3");
    EXPECT_EQ(question_.state(), QuestionState::Searching);
    EXPECT_EQ(question_.found().intervals.size(), 2u);
    summary_->hold(false);
    ASSERT_TRUE(wait());
    EXPECT_EQ(question_.found().intervals.size(), 1u);
}

TEST_F(QuestionModelTest, StatesAFailure) {
    summary_->fail();
    question_.ask(QueryQuantity::Pieces, "1");
    ASSERT_TRUE(wait());
    EXPECT_EQ(question_.state(), QuestionState::Failed);
    EXPECT_NE(question_.answerText("").find("the disk is gone"), std::string::npos) << question_.answerText("");
    EXPECT_TRUE(question_.found().intervals.empty());
}

TEST_F(QuestionModelTest, FollowsTheVolume) {
    question_.ask(QueryQuantity::Pieces, "1");
    ASSERT_TRUE(wait());
    int changes = 0;
    const auto subscription = question_.changed().observe([&] { ++changes; });
    topology_.setLeastPersistence(0.5);
    EXPECT_EQ(changes, 0) << "a filter changes no answer";
    topology_.clear();
    EXPECT_EQ(question_.state(), QuestionState::Empty);
    EXPECT_TRUE(question_.found().intervals.empty());
    topology_.setContent(TopologyModel::contentOf(std::make_shared<Curve>(fewEvents(false))).value());
    ASSERT_TRUE(wait());
    EXPECT_EQ(question_.found().count, 2u) << "the same question";
    question_.ask(QueryQuantity::Area, "5");
    EXPECT_EQ(question_.answerText(""), "Not known for this volume: area");
}

TEST_F(QuestionModelTest, EndsWhileItSearches) {
    auto question = std::make_unique<QuestionModel>(topology_, std::make_shared<BackgroundJobs>(queue_.poster()));
    summary_->hold(true);
    question->ask(QueryQuantity::Pieces, "1");
    summary_->hold(false);
    question.reset();
    queue_.runAll();
}

TEST(TopologyModelContent, HoldsSuggestionsAndSums) {
    const auto curve = std::make_shared<Curve>(fewEvents());
    const auto content = TopologyModel::contentOf(curve);
    ASSERT_THAT(content, IsOk());
    EXPECT_EQ(content.value().suggestions.size(), topology::suggestIsovalues(*curve).value().size());
    EXPECT_GE(content.value().suggestions.size(), 2u);
    EXPECT_EQ(content.value().changes.below(*curve, 11.0).value().events, 5u);
}

} // namespace
} // namespace isoslider::model
