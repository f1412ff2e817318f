#include "core/grid/grid_geometry.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "core/grid/world_normals.h"

namespace isoslider {
namespace {

void expectOrthonormal(const glm::dmat3& axes) {
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            EXPECT_NEAR(glm::dot(axes[a], axes[b]), a == b ? 1.0 : 0.0, 1e-15) << a << ' ' << b;
    EXPECT_GT(glm::determinant(axes), 0.0);
}

TEST(NormalToWorld, IsPerpendicularToWhatIsPerpendicularInTheGrid) {
    GridGeometry geometry;
    EXPECT_TRUE(hasOrthogonalAxes(geometry));
    geometry.direction = glm::dmat3(0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, -1.0);
    EXPECT_TRUE(hasOrthogonalAxes(geometry));
    EXPECT_EQ(normalToWorld(geometry), geometry.direction);
    geometry.direction = glm::dmat3(1.0, 0.0, 0.0, 0.5, std::sqrt(0.75), 0.0, 0.1, 0.2, std::sqrt(0.95));
    EXPECT_FALSE(hasOrthogonalAxes(geometry));
    // Of a plane where 0.3 x + 0.9 y + 0.2 z is the same, two ways within it.
    const glm::dvec3 normal = normalToWorld(geometry) * glm::dvec3(0.3, 0.9, 0.2);
    for (const glm::dvec3 way : {glm::dvec3(0.9, -0.3, 0.0), glm::dvec3(0.0, 0.2, -0.9)})
        EXPECT_NEAR(glm::dot(normal, geometry.direction * way), 0.0, 1e-12);
    EXPECT_GT(glm::dot(normal, geometry.direction * glm::dvec3(0.3, 0.9, 0.2)), 0.0);
}

TEST(CompleteAxes, PutsTwoPerpendicularAxesOnOne) {
    const glm::dvec3 firsts[] = {{1, 0, 0},  {0, 1, 0},     {0, 0, 1},     {-1, 0, 0},
                                 {0, -1, 0}, {0.6, 0.8, 0}, {0.6, 0, -0.8}};
    for (const glm::dvec3& first : firsts) {
        glm::dmat3 axes(1.0);
        axes[0] = first;
        completeAxes(axes, 1);
        EXPECT_EQ(axes[0], first);
        expectOrthonormal(axes);
    }
    glm::dmat3 identity(1.0);
    completeAxes(identity, 1);
    EXPECT_EQ(identity, glm::dmat3(1.0));
}

TEST(CompleteAxes, PutsOneOnTwoAndLeavesThree) {
    glm::dmat3 axes(0, 1, 0, -1, 0, 0, 7, 7, 7);
    completeAxes(axes, 2);
    EXPECT_EQ(axes, glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1));
    const glm::dmat3 skewed(1, 0, 0, 1, 1, 0, 0, 0, -1);
    glm::dmat3 same = skewed;
    completeAxes(same, 3);
    EXPECT_EQ(same, skewed);
}

} // namespace
} // namespace isoslider
