#include "core/extract/full_extraction.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "core/cell/cell_states.h"
#include "core/grid/classification.h"
#include "core/mesh/mesh_checks.h"
#include "core/mesh/soup_topology.h"
#include "tests/property/random_volumes.h"
#include "tests/support/cell_signs.h"
#include "tests/support/result_matchers.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

SurfaceMesh extracted(const ScalarGrid& grid, double isovalue) {
    auto mesh = extractFull(grid, isovalue);
    EXPECT_THAT(mesh, IsOk());
    return std::move(mesh).value();
}

// A field over the cube from -1 to 1, `side` points along each axis; world units are those of the cube.
template <class Function>
std::shared_ptr<const ScalarGrid> cubeField(std::int64_t side, const Function& field) {
    GridGeometry geometry = test::cubeGeometry(side);
    geometry.spacing = glm::dvec3(2.0 / static_cast<double>(side - 1));
    geometry.origin = glm::dvec3(-1.0);
    return test::makeVolume<float>(ScalarType::F32, geometry, [&](auto x, auto y, auto z) {
        return field(glm::dvec3(-1.0) + geometry.spacing * glm::dvec3(static_cast<double>(x), static_cast<double>(y),
                                                                      static_cast<double>(z)));
    });
}

double ball(const glm::dvec3& p) { return 1.0 - glm::length(p - glm::dvec3(0.01, 0.02, -0.03)); }
double torus(const glm::dvec3& p) {
    const double ring = std::sqrt(p.x * p.x + p.y * p.y) - 0.55;
    return 0.9 - std::sqrt(ring * ring + p.z * p.z);
}

TEST(FullExtraction, SphereIsClosedAndItsAreaConverges) {
    const double radius = 0.7; // isovalue 0.3
    const double area = 4.0 * std::numbers::pi * radius * radius;
    double before = 1.0;
    for (const std::int64_t side : {9, 17, 33, 65}) {
        const auto report = mesh::checkMesh(extracted(*cubeField(side, ball), 1.0 - radius));
        EXPECT_TRUE(report.isManifold && report.isClosed && report.isOriented) << side;
        EXPECT_EQ(report.euler, 2);
        EXPECT_EQ(report.components, 1u);
        EXPECT_EQ(report.degenerateTriangles, 0u);
        const double error = std::abs(report.area / area - 1.0);
        EXPECT_LT(error, 0.4 * before) << side << ": second order at least, up to a constant";
        before = error;
        if (side == 65) {
            EXPECT_LT(error, 2e-3);
            // Above is inside, triangles face below: outwards.
            EXPECT_NEAR(report.enclosedVolume / (area * radius / 3.0), 1.0, 3e-3);
        }
    }
}

TEST(FullExtraction, TorusHasEulerNumberZero) {
    const auto report = mesh::checkMesh(extracted(*cubeField(40, torus), 0.7));
    EXPECT_TRUE(report.isManifold && report.isClosed && report.isOriented);
    EXPECT_EQ(report.euler, 0);
    EXPECT_EQ(report.genus, 1);
    EXPECT_EQ(report.components, 1u);
    const double area = 4.0 * std::numbers::pi * std::numbers::pi * 0.55 * 0.2;
    EXPECT_NEAR(report.area / area, 1.0, 0.02);
}

TEST(FullExtraction, NormalsPointAwayFromTheBall) {
    const SurfaceMesh surface = extracted(*cubeField(33, ball), 0.3);
    const auto toWorld = surface.geometry.indexToWorld();
    for (std::size_t i = 0; i < surface.positions.size(); ++i) {
        const glm::dvec3 p(toWorld * glm::dvec4(surface.positions[i], 1.0f));
        const glm::dvec3 outwards = glm::normalize(p - glm::dvec3(0.01, 0.02, -0.03));
        ASSERT_GT(glm::dot(glm::dvec3(surface.normals[i]), outwards), 0.995);
    }
}

TEST(FullExtraction, MirroredGeometryStillFacesOutwards) {
    const auto plain = cubeField(17, ball);
    GridGeometry geometry = plain->geometry();
    geometry.spacing.y = -geometry.spacing.y;
    const ScalarGrid mirrored(geometry, plain->type(), {plain->bytes().begin(), plain->bytes().end()});
    EXPECT_EQ(extracted(mirrored, 0.3).triangles, extracted(*plain, 0.3).triangles)
        << "index space knows no handedness";
    EXPECT_GT(mesh::checkMesh(extracted(mirrored, 0.3)).enclosedVolume, 0.0);
}

// Few values, so that most isovalues tie, inside a border below all of them.
std::shared_ptr<const ScalarGrid> closedNoise(unsigned seed, const GridDims& dims, int values) {
    GridGeometry geometry;
    geometry.dims = dims;
    std::mt19937 random(seed);
    return test::makeVolume<std::int16_t>(
        ScalarType::I16, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
            const bool isBorder =
                x == 0 || y == 0 || z == 0 || x + 1 == dims[0] || y + 1 == dims[1] || z + 1 == dims[2];
            const int value = static_cast<int>(random() % static_cast<unsigned>(values));
            return isBorder ? -5 : value;
        });
}

TEST(FullExtraction, EveryClosedGridGivesAClosedOrientedManifold) {
    for (unsigned seed = 0; seed < 25; ++seed) {
        const int values = 2 + static_cast<int>(seed % 7);
        const auto grid = closedNoise(seed, {3 + seed % 9, 4 + seed % 5, 9}, values);
        for (double isovalue = -0.5; isovalue <= values - 1; isovalue += 0.5) { // ties and gaps
            SCOPED_TRACE("seed " + std::to_string(seed) + " at " + std::to_string(isovalue));
            const auto report = mesh::checkMesh(extracted(*grid, isovalue));
            ASSERT_TRUE(report.isManifold && report.isClosed && report.isOriented);
            ASSERT_EQ(report.duplicateTriangles, 0u);
            ASSERT_EQ(report.refusedByOpenMesh, 0u);
            ASSERT_GT(report.triangles, 0u);
        }
    }
}

TEST(FullExtraction, OpensOnlyAtTheBox) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        const auto grid = test::noiseVolume({9, 8, 7}, seed, 6);
        const SurfaceMesh surface = extracted(*grid, 3.0);
        std::set<std::pair<std::uint32_t, std::uint32_t>> directed;
        for (std::size_t i = 0; i < surface.triangles.size(); i += 3)
            for (std::size_t k = 0; k < 3; ++k)
                ASSERT_TRUE(directed.insert({surface.triangles[i + k], surface.triangles[i + (k + 1) % 3]}).second);
        for (const auto& [a, b] : directed) {
            if (directed.contains({b, a}))
                continue;
            bool onBox = false;
            for (int axis = 0; axis < 3; ++axis)
                for (const float side : {0.0f, static_cast<float>(grid->dims()[axis] - 1)})
                    onBox = onBox || (surface.positions[a][axis] == side && surface.positions[b][axis] == side);
            ASSERT_TRUE(onBox);
        }
    }
}

// A second extraction, written for this test: cell by cell, corner by corner. Vertices by name: the edge id,
// or for the inner vertices of cells the order in which they come.
constexpr EdgeId kFirstInner = EdgeId{1} << 60;

std::vector<std::array<EdgeId, 3>> slowTriangles(const ScalarGrid& grid, double isovalue) {
    const GridDims& n = grid.dims();
    std::vector<std::array<EdgeId, 3>> triangles;
    EdgeId nextInner = kFirstInner;
    for (std::int64_t z = 0; z + 1 < n[2]; ++z)
        for (std::int64_t y = 0; y + 1 < n[1]; ++y)
            for (std::int64_t x = 0; x + 1 < n[0]; ++x) {
                cell::CornerScalars scalars;
                bool isWhole = true;
                for (unsigned c = 0; c < 8; ++c) {
                    scalars[c] = grid.valueAt(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
                    isWhole = isWhole && std::isfinite(scalars[c]);
                }
                if (!isWhole)
                    continue;
                const std::uint8_t signs = cell::signsOf(scalars, isovalue);
                const cell::CellState& state = cell::cellStates()[cell::resolveCell(signs, scalars, isovalue).state];
                const auto nameOf = [&](std::uint8_t vertex) {
                    if (vertex >= cell::kInnerVertex)
                        return nextInner + vertex - cell::kInnerVertex;
                    const cell::CellEdge& edge = cell::kCellEdges[vertex];
                    const std::int64_t px = x + (edge.lowerCorner & 1), py = y + (edge.lowerCorner >> 1 & 1),
                                       pz = z + (edge.lowerCorner >> 2);
                    return static_cast<EdgeId>(4 * (px + n[0] * (py + n[1] * pz)) + edge.axis);
                };
                for (std::size_t k = 0; k < state.triangles.size(); k += 3)
                    triangles.push_back(
                        {nameOf(state.triangles[k]), nameOf(state.triangles[k + 1]), nameOf(state.triangles[k + 2])});
                nextInner += state.innerVertices;
            }
    return triangles;
}

bool isManifold(const SurfaceMesh& surface) {
    std::vector<mesh::Triangle> triangles;
    for (std::size_t i = 0; i < surface.triangles.size(); i += 3)
        triangles.push_back({surface.triangles[i], surface.triangles[i + 1], surface.triangles[i + 2]});
    return mesh::analyseTopology(triangles, surface.positions.size()).value().isManifold();
}

TEST(FullExtraction, GivesTheTrianglesOfEveryWholeCellAndNoOtherVertex) {
    for (std::uint64_t seed = test::testSeed(40), last = seed + 80; seed < last && !HasFailure(); ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 14);
        double isovalue = volume.min;
        for (int k = 0; k < 4; ++k) {
            isovalue = test::nextIsovalue(volume, isovalue, random);
            SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description + " at " +
                         std::to_string(isovalue));
            const SurfaceMesh surface = extracted(*volume.grid, isovalue);
            std::vector<std::array<EdgeId, 3>> triangles;
            std::vector<bool> isUsed(surface.positions.size(), false);
            const auto nameOf = [&](std::uint32_t vertex) {
                return vertex < surface.edgeIds.size() ? surface.edgeIds[vertex]
                                                       : kFirstInner + (vertex - surface.edgeIds.size());
            };
            for (std::size_t i = 0; i < surface.triangles.size(); i += 3) {
                const std::uint32_t* t = surface.triangles.data() + i;
                triangles.push_back({nameOf(t[0]), nameOf(t[1]), nameOf(t[2])});
                isUsed[t[0]] = isUsed[t[1]] = isUsed[t[2]] = true;
            }
            ASSERT_EQ(triangles, slowTriangles(*volume.grid, isovalue)) << "in grid order too";
            ASSERT_TRUE(std::all_of(isUsed.begin(), isUsed.end(), [](bool used) { return used; }))
                << "a vertex without a triangle";
            ASSERT_TRUE(std::is_sorted(surface.edgeIds.begin(), surface.edgeIds.end()));
            ASSERT_TRUE(isManifold(surface)) << "beside missing values too";
        }
    }
}

// Four cells around one edge, of which only two opposite ones have all their corners: they touch in one point.
TEST(FullExtraction, SplitsAVertexWhereTwoCellsOnlyTouch) {
    constexpr float kMissingValue = std::numeric_limits<float>::quiet_NaN();
    const auto grid = test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(3), [](auto x, auto y, auto z) {
        const bool isMissing = (x == 2 && y == 0) || (x == 0 && y == 2) || z == 2;
        return isMissing ? kMissingValue : static_cast<float>(z);
    });
    const SurfaceMesh surface = extracted(*grid, 0.25);
    // Two squares from the edges along z; the one at (1, 1) belongs to both.
    EXPECT_EQ(surface.triangleCount(), 4u);
    EXPECT_EQ(surface.activeEdgeCount(), 7u);
    ASSERT_EQ(surface.edgeIds.size(), 8u);
    EXPECT_TRUE(isManifold(surface));
    const auto twice = std::adjacent_find(surface.edgeIds.begin(), surface.edgeIds.end());
    ASSERT_NE(twice, surface.edgeIds.end());
    const auto at = static_cast<std::size_t>(twice - surface.edgeIds.begin());
    EXPECT_EQ(surface.positions[at], glm::vec3(1.0f, 1.0f, 0.25f));
    EXPECT_EQ(surface.positions[at], surface.positions[at + 1]);
    EXPECT_EQ(surface.normals[at], surface.normals[at + 1]);
}

TEST(FullExtraction, VerticesLieWhereTheLineCrossesTheIsovalue) {
    const auto grid = test::noiseVolume({7, 8, 9}, 5, 200);
    for (const double isovalue : {17.0, 80.25, 199.0}) {
        const SurfaceMesh surface = extracted(*grid, isovalue);
        ASSERT_FALSE(surface.positions.empty());
        for (std::size_t i = 0; i < surface.edgeIds.size(); ++i) {
            const int axis = static_cast<int>(surface.edgeIds[i] % 4);
            const auto point = static_cast<std::int64_t>(surface.edgeIds[i] / 4);
            std::int64_t p[3] = {point % 7, point / 7 % 8, point / 56};
            const double s1 = grid->valueAt(p[0], p[1], p[2]);
            const glm::dvec3 lower(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
            ++p[axis];
            const double s2 = grid->valueAt(p[0], p[1], p[2]);
            glm::dvec3 expected = lower;
            expected[axis] += (isovalue - s1) / (s2 - s1);
            ASSERT_LT(glm::length(glm::dvec3(surface.positions[i]) - expected), 2e-6);
        }
    }
}

TEST(FullExtraction, DoesNotDependOnThreads) {
    const auto grid = test::hillsVolume({40, 30, 37});
    SurfaceMesh one;
    tbb::task_arena(1).execute([&] { one = extracted(*grid, 400.0); });
    const SurfaceMesh all = extracted(*grid, 400.0);
    EXPECT_EQ(one.edgeIds, all.edgeIds);
    EXPECT_EQ(one.triangles, all.triangles);
    EXPECT_EQ(one.positions, all.positions);
    EXPECT_EQ(one.normals, all.normals);
}

TEST(FullExtraction, IsEmptyWhereThereIsNothing) {
    EXPECT_TRUE(extracted(*test::noiseVolume({9, 1, 9}, 1), 5.0).positions.empty());
    EXPECT_TRUE(extracted(*test::noiseVolume({1, 1, 1}, 1), 5.0).positions.empty());
    const auto grid = test::noiseVolume({5, 5, 5}, 1);
    EXPECT_TRUE(extracted(*grid, 0.0).positions.empty()) << "all above";
    EXPECT_TRUE(extracted(*grid, 20.0).positions.empty()) << "all below";
    EXPECT_TRUE(extracted(*grid, std::numeric_limits<double>::quiet_NaN()).positions.empty());
}

TEST(FullExtraction, StopsOnRequest) {
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(extractFull(*test::hillsVolume({20, 20, 20}), 300.0, job), test::HasError(ErrorCode::Cancelled));
}

} // namespace
} // namespace isoslider::extract
