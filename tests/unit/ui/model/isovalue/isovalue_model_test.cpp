#include "ui/model/isovalue/isovalue_model.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class IsovalueModelTest : public ::testing::Test {
protected:
    IsovalueModelTest() {
        EXPECT_TRUE(model_.setDomain(-1000.0, 3000.0, 300.0));
        subscription_ = model_.observe([this] { ++notified_; });
    }
    IsovalueModel model_;
    Subscription subscription_;
    int notified_ = 0;
};

TEST_F(IsovalueModelTest, ClampsRequestsToTheRange) {
    EXPECT_TRUE(model_.request(5000.0));
    EXPECT_EQ(model_.requested(), 3000.0);
    EXPECT_TRUE(model_.request(-kInfinity));
    EXPECT_EQ(model_.requested(), -1000.0);
}

TEST_F(IsovalueModelTest, B021_ARangeOfOneValueIsAPoint) {
    EXPECT_TRUE(model_.setDomain(5.0, 5.0, 5.0));
    EXPECT_EQ(model_.fraction(), 0.0);
    for (const double fraction : {0.0, 0.5, 1.0})
        EXPECT_EQ(model_.atFraction(fraction), 5.0);
    const int before = notified_;
    EXPECT_FALSE(model_.request(4.0));
    EXPECT_FALSE(model_.request(kInfinity));
    EXPECT_FALSE(model_.step(0.5));
    EXPECT_FALSE(model_.step(-1.0));
    EXPECT_EQ(model_.requested(), 5.0);
    EXPECT_EQ(notified_, before);
}

TEST_F(IsovalueModelTest, RefusesNan) {
    EXPECT_FALSE(model_.request(kNan));
    EXPECT_EQ(model_.requested(), 300.0);
    EXPECT_EQ(notified_, 0);
}

TEST_F(IsovalueModelTest, EqualValueNotifiesNobody) {
    EXPECT_FALSE(model_.request(300.0));
    model_.request(4000.0);
    EXPECT_EQ(notified_, 1);
    EXPECT_FALSE(model_.request(3500.0)); // clamps to the same end
    model_.setDisplayed(3000.0, 4.0);
    model_.setDisplayed(3000.0, 4.0);
    EXPECT_EQ(notified_, 2);
}

TEST_F(IsovalueModelTest, KeepsRequestedAndDisplayedApart) {
    EXPECT_FALSE(model_.hasDisplayed());
    model_.setDisplayed(300.0, 1.0);
    model_.request(310.0);
    EXPECT_EQ(model_.displayed(), 300.0);
    EXPECT_TRUE(model_.isLagging());
    model_.setDisplayed(310.0, 2.0);
    EXPECT_FALSE(model_.isLagging());
}

TEST_F(IsovalueModelTest, AChangedRangeKeepsWhatIsDisplayed) {
    model_.setDisplayed(300.0, 1.0);
    notified_ = 0;
    int requests = 0;
    const auto subscription = model_.observeRequest([&](double) { ++requests; });
    EXPECT_TRUE(model_.changeDomain(-1200.0, 3100.0, 300.0));
    EXPECT_EQ(model_.min(), -1200.0);
    EXPECT_EQ(model_.max(), 3100.0);
    EXPECT_EQ(model_.requested(), 300.0);
    EXPECT_TRUE(model_.hasDisplayed());
    EXPECT_FALSE(model_.isLagging());
    EXPECT_TRUE(model_.changeDomain(-1200.0, 200.0, 300.0));
    EXPECT_EQ(model_.requested(), 200.0);
    EXPECT_TRUE(model_.isLagging());
    EXPECT_TRUE(model_.changeDomain(-1200.0, 200.0, 300.0));
    EXPECT_EQ(notified_, 2); // the last changed nothing
    EXPECT_EQ(requests, 0);
    EXPECT_FALSE(model_.changeDomain(1.0, 0.0, 0.5));
    EXPECT_FALSE(IsovalueModel().changeDomain(0.0, 1.0, 0.5));
}

TEST_F(IsovalueModelTest, StepsByFractionsOfTheRange) {
    EXPECT_TRUE(model_.step(0.001));
    EXPECT_DOUBLE_EQ(model_.requested(), 304.0);
    EXPECT_TRUE(model_.step(-0.1));
    EXPECT_DOUBLE_EQ(model_.requested(), -96.0);
}

TEST_F(IsovalueModelTest, StepsOverTheWholeDoubleRange) {
    const double huge = std::numeric_limits<double>::max();
    ASSERT_TRUE(model_.setDomain(-huge, huge, 0.0));
    EXPECT_TRUE(model_.step(0.25));
    EXPECT_TRUE(std::isfinite(model_.requested()));
    EXPECT_DOUBLE_EQ(model_.requested(), huge / 2.0);
    EXPECT_DOUBLE_EQ(model_.fraction(), 0.75);
}

TEST_F(IsovalueModelTest, RefusesABadDomainAndKeepsTheOldOne) {
    EXPECT_FALSE(model_.setDomain(2.0, 1.0, 1.5));
    EXPECT_FALSE(model_.setDomain(0.0, kInfinity, 1.5));
    EXPECT_FALSE(model_.setDomain(0.0, 1.0, kNan));
    EXPECT_EQ(model_.max(), 3000.0);
    EXPECT_EQ(notified_, 0);
}

TEST_F(IsovalueModelTest, WithoutARangeNothingCanBeRequested) {
    model_.clearDomain();
    EXPECT_FALSE(model_.request(1.0));
    EXPECT_FALSE(model_.hasDomain());
}

TEST_F(IsovalueModelTest, ARangeOfOneValueHasAFraction) {
    ASSERT_TRUE(model_.setDomain(7.0, 7.0, 9.0));
    EXPECT_EQ(model_.requested(), 7.0);
    EXPECT_EQ(model_.fraction(), 0.0);
}

TEST_F(IsovalueModelTest, FractionAndValueAreInverse) {
    model_.request(model_.atFraction(0.37));
    EXPECT_NEAR(model_.fraction(), 0.37, 1e-12);
    EXPECT_EQ(model_.atFraction(2.0), 3000.0);
}

TEST_F(IsovalueModelTest, RequestObserversHearOnlyRequests) {
    std::vector<double> heard;
    const auto subscription = model_.observeRequest([&](double isovalue) { heard.push_back(isovalue); });
    model_.setDisplayed(300.0, 1.0);
    model_.request(301.0);
    model_.request(301.0);
    EXPECT_EQ(heard, std::vector<double>{301.0});
}

TEST(ObserverList, AnObserverMayLeaveWhileNotified) {
    ObserverList<> list;
    Subscription first, second;
    int calls = 0;
    first = list.observe([&] {
        ++calls;
        second.reset();
    });
    second = list.observe([&] { calls += 100; });
    list.notify();
    EXPECT_EQ(calls, 1);
}

TEST(ObserverList, ASubscriptionMayOutliveTheList) {
    Subscription subscription;
    {
        ObserverList<> list;
        subscription = list.observe([] {});
    }
    subscription.reset();
}

TEST(IsovalueModel, StepsLeadToMultiplesOfTheUnit) {
    IsovalueModel model;
    model.setDomain(0.0, 255.0, 92.5);
    model.setStepRule({1.0, nullptr});
    model.step(kFineStep);
    EXPECT_EQ(model.requested(), 93.0);
    model.step(-kFineStep);
    EXPECT_EQ(model.requested(), 92.0);
    model.step(kPageStep);
    EXPECT_EQ(model.requested(), 102.0);
    model.step(-kLargePageStep);
    EXPECT_EQ(model.requested(), 2.0);
    model.step(kFineStep / kPrecisionFactor);
    EXPECT_EQ(model.requested(), 2.1);
    model.step(-kLargePageStep);
    EXPECT_EQ(model.requested(), 0.0) << "clamped";
}

TEST(IsovalueModel, StepsLeadFromStopToStop) {
    IsovalueModel model;
    model.setDomain(0.0, 10.0, 3.0);
    model.setStepRule({1.0, std::make_shared<std::vector<double>>(std::vector<double>{0.0, 0.5, 4.0, 10.0})});
    model.step(kFineStep);
    EXPECT_EQ(model.requested(), 4.0);
    model.step(-kFineStep);
    EXPECT_EQ(model.requested(), 0.5);
    model.step(2.0 * kFineStep);
    EXPECT_EQ(model.requested(), 10.0);
    model.step(kPageStep);
    EXPECT_EQ(model.requested(), 10.0);
    model.step(-kPageStep);
    EXPECT_EQ(model.requested(), 0.0);
}

} // namespace
} // namespace isoslider::model
