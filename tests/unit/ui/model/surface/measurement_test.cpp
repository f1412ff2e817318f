#include "ui/model/surface/measurement.h"

#include <cmath>

#include <gtest/gtest.h>

namespace isoslider::model {
namespace {

TEST(Measurement, HasUpToThreePlacesAndThenBeginsAgain) {
    MeasuredPlaces places;
    places = withPlace(places, {1, 0, 0});
    places = withPlace(places, {1, 0, 0}); // as a double click does
    EXPECT_EQ(places.size(), 1u);
    places = withPlace(places, {2, 0, 0});
    EXPECT_FALSE(measuredAngle(places));
    places = withPlace(places, {1, 0, 0});
    EXPECT_EQ(places, (MeasuredPlaces{{1, 0, 0}, {2, 0, 0}, {1, 0, 0}}));
    EXPECT_EQ(withPlace(places, {3, 0, 0}), (MeasuredPlaces{{3, 0, 0}}));
    EXPECT_EQ(withPlace(places, {1, 0, 0}), places);
}

TEST(Measurement, AnglesAreThoseAtTheSecondPlace) {
    const auto angle = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        return measuredAngle({a, b, c}).value();
    };
    EXPECT_NEAR(angle({5, 1, 1}, {1, 1, 1}, {1, 1, 3}), 90.0, 1e-12);
    EXPECT_NEAR(angle({1, 0, 0}, {0, 0, 0}, {-2, 0, 0}), 180.0, 1e-12);
    EXPECT_NEAR(angle({1, 0, 0}, {0, 0, 0}, {7, 0, 0}), 0.0, 1e-12);
    EXPECT_NEAR(angle({1, 0, 0}, {0, 0, 0}, {1, 1, 0}), 45.0, 1e-12);
    EXPECT_NEAR(angle({1, 0, 0}, {0, 0, 0}, {1, 1e-9, 0}), 1e-9 * 180.0 / 3.141592653589793, 1e-15)
        << "small ones, too";
    EXPECT_NEAR(angle({1e-100, 0, 0}, {0, 0, 0}, {0, 1e100, 0}), 90.0, 1e-12);
}

TEST(Measurement, HasNoAngleWithoutTwoDirections) {
    EXPECT_FALSE(measuredAngle({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}));
    EXPECT_FALSE(measuredAngle({{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
    EXPECT_FALSE(measuredAngle({{1, 0, 0}, {0, 0, 0}, {std::nan(""), 0, 0}}));
}

} // namespace
} // namespace isoslider::model
