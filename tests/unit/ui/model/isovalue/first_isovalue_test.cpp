#include "ui/model/isovalue/first_isovalue.h"

#include <limits>

#include <gtest/gtest.h>

#include "ui/model/isovalue/isovalue_model.h"

namespace isoslider::model {
namespace {

class FirstIsovalueTest : public ::testing::Test {
protected:
    FirstIsovalue first_;
    int changes_ = 0;
    Subscription subscription_ = first_.changed().observe([this] { ++changes_; });
};

TEST_F(FirstIsovalueTest, GivesWayOnceToABetterOne) {
    EXPECT_FALSE(first_.isovalue());
    EXPECT_FALSE(first_.canImprove());
    first_.begin({3.0, "guess"}, false);
    EXPECT_TRUE(first_.canImprove());
    EXPECT_EQ(first_.reason(), "guess");
    first_.improve({4.0, "known"});
    EXPECT_EQ(first_.isovalue(), 4.0);
    EXPECT_EQ(first_.reason(), "known");
    EXPECT_FALSE(first_.canImprove());
    first_.improve({5.0, "again"});
    EXPECT_EQ(first_.isovalue(), 4.0);
    EXPECT_EQ(changes_, 2);
}

TEST_F(FirstIsovalueTest, StaysIfItWasAskedForOrIsTheBest) {
    first_.begin({3.0, ""}, false);
    EXPECT_FALSE(first_.canImprove());
    EXPECT_EQ(first_.isovalue(), 3.0) << "a preview that misses the range keeps it";
    first_.begin({3.0, "known"}, true);
    EXPECT_FALSE(first_.canImprove());
    EXPECT_EQ(first_.reason(), "known");
}

TEST_F(FirstIsovalueTest, StatesWhyItIsNotTheOneAskedFor) {
    EXPECT_EQ(first_.noteOnAsked(0.0, 255.0), "");
    first_.begin({300.0, ""}, false);
    EXPECT_EQ(first_.noteOnAsked(0.0, 255.0), "300 is above all samples; the greatest, 255, was taken");
    EXPECT_EQ(first_.noteOnAsked(0.0, 400.0), "") << "a preview missed the end of the range";
    first_.noteRequest(254.0);
    EXPECT_EQ(first_.noteOnAsked(0.0, 255.0), "") << "the handle has been moved";
    first_.begin({5.0, ""}, false, "no deviation");
    EXPECT_EQ(first_.noteOnAsked(5.0, 5.0), "no deviation");
    first_.begin({5.0, ""}, false);
    EXPECT_EQ(first_.noteOnAsked(5.0, 5.0), "");
}

TEST_F(FirstIsovalueTest, EndsWhereTheHandleMoves) {
    first_.begin({3.0, "guess"}, false);
    first_.noteRequest(3.0);
    EXPECT_TRUE(first_.canImprove()) << "the move to it is none away from it";
    first_.noteRequest(3.5);
    EXPECT_FALSE(first_.isovalue());
    EXPECT_EQ(first_.reason(), "");
    first_.improve({4.0, "late"});
    EXPECT_FALSE(first_.isovalue());
    first_.noteRequest(3.0);
    first_.end();
    EXPECT_EQ(changes_, 2);
}

TEST_F(FirstIsovalueTest, WhatIsUsedKeepsItsReason) {
    first_.begin({3.0, "guess"}, false);
    first_.keep();
    EXPECT_FALSE(first_.canImprove());
    first_.improve({4.0, "late"});
    EXPECT_EQ(first_.reason(), "guess");
    first_.begin({5.0, "of another volume"}, false);
    EXPECT_TRUE(first_.canImprove());
}

TEST(ReferenceIsovalue, StaysWithinTheRangeOfItsVolume) {
    IsovalueModel model;
    int changes = 0;
    const auto subscription = model.observe([&] { ++changes; });
    model.setReference(1.0);
    EXPECT_FALSE(model.reference()) << "there is no range";
    model.setDomain(0.0, 10.0, 5.0);
    changes = 0;
    model.setReference(12.0);
    EXPECT_EQ(model.reference(), 10.0);
    model.setReference(10.0);
    model.setReference(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(model.reference(), 10.0);
    EXPECT_EQ(changes, 1);
    model.changeDomain(0.0, 8.0, 5.0);
    EXPECT_EQ(model.reference(), 8.0);
    model.setReference(std::nullopt);
    EXPECT_FALSE(model.reference());
    model.setReference(2.0);
    model.setDomain(0.0, 10.0, 5.0);
    EXPECT_FALSE(model.reference()) << "another volume";
    model.setReference(2.0);
    model.clearDomain();
    EXPECT_FALSE(model.reference());
}

} // namespace
} // namespace isoslider::model
