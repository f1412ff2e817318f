#include "ui/model/surface/orientation_cube.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "ui/model/session/dataset.h"

namespace isoslider::model {
namespace {

glm::dvec3 outwards(StandardView side) { return standardOrientation(side) * glm::dvec3(0.0, 0.0, 1.0); }

TEST(OrientationCube, SidesHaveTheNamesOfTheirAxes) {
    for (const StandardView side : kStandardViews) {
        const glm::dvec3 normal = outwards(side);
        const int axis = axisOf(side);
        ASSERT_NEAR(std::abs(normal[axis]), 1.0, 1e-12);
        const std::string name = (normal[axis] > 0.0 ? "+" : "−") + std::string(1, "XYZ"[axis]);
        EXPECT_EQ(sideName(side, false), name);
        EXPECT_EQ(sideName(side, true), std::string(1, normal[axis] > 0.0 ? "LPS"[axis] : "RAI"[axis]));
    }
}

TEST(OrientationCube, ASideSeenStraightOnIsAloneAndUpright) {
    for (const StandardView side : kStandardViews) {
        const auto seen = visibleSides(standardOrientation(side));
        ASSERT_EQ(seen.size(), 1u);
        EXPECT_EQ(seen[0].side, side);
        EXPECT_NEAR(seen[0].facing, 1.0, 1e-12);
        EXPECT_NEAR(glm::length(seen[0].middle), 0.0, 1e-12);
        EXPECT_NEAR(seen[0].right.x, 1.0, 1e-12);
        EXPECT_NEAR(seen[0].up.y, 1.0, 1e-12);
        EXPECT_EQ(sideAt(standardOrientation(side), {0.99, -0.99}), side);
        EXPECT_EQ(sideAt(standardOrientation(side), {1.01, 0.0}), std::nullopt);
        EXPECT_EQ(sideAt(standardOrientation(side), {0.0, -1.01}), std::nullopt);
    }
}

/// What a line of sight meets first of the cube from -1 to 1, found by cutting it with all six planes.
std::optional<StandardView> metFirst(const glm::dquat& cameraToWorld, glm::dvec2 place) {
    const glm::dvec3 from = cameraToWorld * glm::dvec3(place, 10.0), way = cameraToWorld * glm::dvec3(0.0, 0.0, -1.0);
    std::optional<StandardView> first;
    double nearest = 1e9;
    for (const StandardView side : kStandardViews) {
        const glm::dvec3 normal = outwards(side);
        const double along = (1.0 - glm::dot(from, normal)) / glm::dot(way, normal);
        const glm::dvec3 met = from + along * way;
        const double farthest = std::max({std::abs(met.x), std::abs(met.y), std::abs(met.z)});
        if (farthest <= 1.0 + 1e-9 && along < nearest) {
            nearest = along;
            first = side;
        }
    }
    return first;
}

TEST(OrientationCube, ASideIsHitWhereALineOfSightMeetsItFirst) {
    std::mt19937 random(20);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> place(-1.8, 1.8);
    int hits = 0;
    for (int round = 0; round < 3000; ++round) {
        const glm::dquat turn =
            glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
        const glm::dvec2 at(place(random), place(random));
        const auto side = sideAt(turn, at);
        ASSERT_EQ(side, metFirst(turn, at)) << "round " << round;
        hits += side.has_value();
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LT(hits, 2900);
}

TEST(OrientationCube, DicomAndNiftiWithAnOrientationAndHeadersThatSayNameAPatientsDirections) {
    Dataset dataset;
    for (const auto& [format, isPatient] : {std::pair("DICOM", true), std::pair("NIfTI", true),
                                            std::pair("MetaImage", false), std::pair("Analyze", false)}) {
        dataset.format = format;
        EXPECT_EQ(isPatientSpace(dataset), isPatient) << format;
    }
    dataset.format = "NIfTI";
    dataset.notes = {"the file states no orientation"};
    EXPECT_FALSE(isPatientSpace(dataset));
    dataset.format = "NRRD";
    EXPECT_FALSE(isPatientSpace(dataset));
    dataset.statesPatientSpace = true;
    EXPECT_TRUE(isPatientSpace(dataset));
    index::IndexInfo earlier;
    adoptIndex(dataset, earlier);
    EXPECT_TRUE(isPatientSpace(dataset)) << "an earlier index does not know";
}

TEST(OrientationCube, AnIndexStatesAPatientsDirections) {
    Dataset dataset; // opened without the volume
    index::IndexInfo info;
    adoptIndex(dataset, info);
    EXPECT_FALSE(isPatientSpace(dataset));
    info.isPatientSpace = true;
    adoptIndex(dataset, info);
    EXPECT_TRUE(isPatientSpace(dataset));
}

} // namespace
} // namespace isoslider::model
