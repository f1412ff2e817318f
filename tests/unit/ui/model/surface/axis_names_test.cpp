#include "ui/model/surface/axis_names.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace isoslider::model {
namespace {

const glm::dvec3 kX(1.0, 0.0, 0.0), kY(0.0, 1.0, 0.0), kZ(0.0, 0.0, 1.0);

AxisNames namesOf(const glm::dvec3& first, const glm::dvec3& second, const glm::dvec3& third) {
    GridGeometry geometry;
    geometry.direction = {first, second, third};
    return AxisNames(geometry);
}

std::string all(const AxisNames& names) { return names.nameOf(0) + names.nameOf(1) + names.nameOf(2); }

std::string inRows(const AxisNames& names) {
    std::string text;
    for (int row = 0; row < 3; ++row)
        text += names.nameOf(names.gridAxisInRow(row));
    return text;
}

TEST(AxisNames, AreThoseOfTheWorldWhereTheGridLiesAlongIt) {
    EXPECT_EQ(all(AxisNames()), "XYZ");
    EXPECT_EQ(all(namesOf(kX, kY, kZ)), "XYZ");
    EXPECT_EQ(all(namesOf(-kX, -kY, kZ)), "XYZ");
    EXPECT_EQ(all(namesOf(kZ, kX, -kY)), "ZXY");
    EXPECT_TRUE(namesOf(-kX, kY, kZ).areInOrder());
    EXPECT_FALSE(namesOf(kZ, kX, -kY).areInOrder());
    for (const AxisNames& names : {namesOf(kX, kY, kZ), namesOf(-kX, kY, kZ), namesOf(kZ, kX, -kY)}) {
        EXPECT_TRUE(names.areOfWorld());
        EXPECT_EQ(inRows(names), "XYZ");
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_EQ(names.gridAxisOf(names.worldAxisOf(axis)), axis);
    }
}

TEST(AxisNames, OfATurnedGridAreNoneOfTheWorlds) {
    const glm::dmat3 tilt = glm::mat3_cast(glm::angleAxis(0.01, glm::normalize(glm::dvec3(1.0, 2.0, -1.0))));
    const AxisNames turned = namesOf(tilt * kZ, tilt * kX, tilt * kY);
    EXPECT_EQ(all(turned), "ijk");
    EXPECT_EQ(inRows(turned), "ijk") << "in the order of the file";
    EXPECT_EQ(turned.gridAxisOf(2), 0) << "the nearest to z";
    EXPECT_FALSE(turned.areInOrder());
    EXPECT_EQ(all(namesOf(kX, kY, glm::normalize(glm::dvec3(0.3, 0.0, 1.0)))), "ijk") << "as in a monoclinic cell";
}

TEST(AxisNames, PlacesInAPatientHaveTheirDirections) {
    const glm::dvec3 place(-32.0, 17.0, 46.0);
    EXPECT_EQ(placeText(place, false, 5), "-32, 17, 46");
    EXPECT_EQ(placeText(place, true, 5), "R 32, P 17, S 46");
    EXPECT_EQ(placeText(-place, true, 5), "L 32, A 17, I 46");
    EXPECT_EQ(coordinateText(0, 0.0, true, 5), "L 0");
    EXPECT_EQ(worldAxisName(1, true), "A–P");
    EXPECT_EQ(worldAxisName(1, false), "Y");
}

} // namespace
} // namespace isoslider::model
