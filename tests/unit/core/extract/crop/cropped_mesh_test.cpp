#include "core/extract/crop/cropped_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/mesh/certificate.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/support/result_matchers.h"

namespace isoslider::extract {
namespace {

using test::HasError;
using test::IsOk;

/// Whole numbers below `values`: if these are few, many ties, and all kinds of ambiguous cells.
ScalarGrid randomGrid(const GridDims& dims, int values, unsigned seed) {
    GridGeometry geometry;
    geometry.dims = dims;
    geometry.spacing = {0.5, 2.0, 1.25};
    geometry.origin = {100.0, -7.0, 3.0};
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> chance(0, std::max(1, values) - 1);
    std::vector<std::uint8_t> samples(static_cast<std::size_t>(pointCount(dims)));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double x = static_cast<double>(i % static_cast<std::size_t>(dims[0])) + seed;
        const double rest = static_cast<double>(i / static_cast<std::size_t>(dims[0]));
        // Waves where none are to be random: areas of the sides that no surface crosses.
        samples[i] = static_cast<std::uint8_t>(
            values > 0 ? chance(random) : std::lround(100.0 + 60.0 * std::sin(0.6 * x) * std::cos(0.02 * rest)));
    }
    return ScalarGrid::fromValues<std::uint8_t>(geometry, ScalarType::U8, samples);
}

std::uint8_t sampleAt(const ScalarGrid& grid, std::int64_t x, std::int64_t y, std::int64_t z) {
    const GridDims& dims = grid.geometry().dims;
    return grid.values<std::uint8_t>()[static_cast<std::size_t>(x + dims[0] * (y + dims[1] * z))];
}

ScalarGrid croppedGrid(const ScalarGrid& grid, const CellBox& box) {
    GridGeometry geometry = grid.geometry();
    std::vector<std::uint8_t> samples;
    for (std::int64_t z = box.low[2]; z <= box.high[2]; ++z)
        for (std::int64_t y = box.low[1]; y <= box.high[1]; ++y)
            for (std::int64_t x = box.low[0]; x <= box.high[0]; ++x)
                samples.push_back(sampleAt(grid, x, y, z));
    for (std::size_t a = 0; a < 3; ++a) {
        geometry.dims[a] = box.high[a] - box.low[a] + 1;
        geometry.origin[static_cast<int>(a)] += geometry.spacing[static_cast<int>(a)] * static_cast<double>(box.low[a]);
    }
    return ScalarGrid::fromValues<std::uint8_t>(geometry, ScalarType::U8, samples);
}

/// Triangles by the places of their corners, whatever their order.
std::multiset<std::array<float, 9>> placesOf(const SurfaceMesh& mesh) {
    std::multiset<std::array<float, 9>> all;
    for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
        std::array<std::array<float, 3>, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& place = mesh.positions[mesh.triangles[i + k]];
            corners[k] = {place.x, place.y, place.z};
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        std::array<float, 9> flat{};
        for (std::size_t k = 0; k < 9; ++k)
            flat[k] = corners[k / 3][k % 3];
        all.insert(flat);
    }
    return all;
}

CellBox randomBox(const GridDims& dims, std::mt19937& random) {
    CellBox box;
    for (std::size_t a = 0; a < 3; ++a) {
        box.low[a] = std::uniform_int_distribution<std::int64_t>(0, dims[a] - 2)(random);
        box.high[a] = std::uniform_int_distribution<std::int64_t>(box.low[a] + 1, dims[a] - 1)(random);
    }
    return box;
}

TEST(CropMesh, IsTheSurfaceOfTheCroppedVolume) {
    std::mt19937 random(11);
    const GridDims dims{9, 8, 10};
    for (unsigned seed = 0; seed < 40; ++seed) {
        const ScalarGrid grid = randomGrid(dims, seed % 2 == 0 ? 4 : 200, seed);
        const double isovalue = seed % 2 == 0 ? 1 + seed % 3 : 90.5;
        const SurfaceMesh whole = extractFull(grid, isovalue).value();
        const CellBox box = randomBox(dims, random);
        const auto cropped = cropMesh(whole, box, BoxSides::Open);
        ASSERT_THAT(cropped, IsOk());
        const SurfaceMesh wanted = extractFull(croppedGrid(grid, box), isovalue).value();
        EXPECT_EQ(cropped.value().edgeIds, wanted.edgeIds) << seed;
        EXPECT_EQ(cropped.value().triangles, wanted.triangles) << seed;
        ASSERT_EQ(cropped.value().positions.size(), wanted.positions.size());
        for (std::size_t v = 0; v < wanted.positions.size(); ++v)
            EXPECT_LT(glm::distance(cropped.value().positions[v], wanted.positions[v]), 1e-5f);
        EXPECT_EQ(cropped.value().geometry, wanted.geometry);
    }
}

TEST(CropMesh, IsClosedAtTheSidesOfAnyBox) {
    std::mt19937 random(12);
    const GridDims dims{9, 8, 10};
    int closed = 0;
    for (unsigned seed = 0; seed < 120; ++seed) {
        const std::array<int, 3> values{4, 200, 0};
        const ScalarGrid grid = randomGrid(dims, values[seed % 3], 1000 + seed);
        const double isovalue = seed % 3 == 0 ? 1 + seed % 2 : 60.5 + seed % 80;
        const SurfaceMesh whole = extractFull(grid, isovalue).value();
        const CellBox box = randomBox(dims, random);
        const auto result = cropMesh(whole, box, BoxSides::Closed);
        if (cropMesh(whole, box, BoxSides::Open).value().triangles.empty()) {
            EXPECT_THAT(result, HasError(ErrorCode::InvalidArgument));
            continue;
        }
        ASSERT_THAT(result, IsOk()) << seed;
        const SurfaceMesh& mesh = result.value();
        const auto certificate = mesh::certify(mesh, {"", 0, "", {}, {}});
        EXPECT_TRUE(certificate.report.isClosed) << seed;
        EXPECT_TRUE(mesh::faultsOf(certificate).empty()) << seed << ": " << mesh::faultsOf(certificate).front();
        EXPECT_GT(certificate.report.enclosedVolume, 0.0);
        ++closed;
        // Grid points of the sides are vertices exactly where they are inside.
        std::set<std::array<std::int64_t, 3>> points;
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            const glm::vec3& place = mesh.positions[v];
            if (v >= mesh.edgeIds.size() && place == glm::round(place))
                points.insert({std::lround(place.x), std::lround(place.y), std::lround(place.z)});
        }
        for (std::int64_t z = 0; z < mesh.geometry.dims[2]; ++z)
            for (std::int64_t y = 0; y < mesh.geometry.dims[1]; ++y)
                for (std::int64_t x = 0; x < mesh.geometry.dims[0]; ++x) {
                    const bool isOnSide = x == 0 || y == 0 || z == 0 || x == mesh.geometry.dims[0] - 1 ||
                                          y == mesh.geometry.dims[1] - 1 || z == mesh.geometry.dims[2] - 1;
                    const bool isInside = sampleAt(grid, x + box.low[0], y + box.low[1], z + box.low[2]) >= isovalue;
                    EXPECT_EQ(points.contains({x, y, z}), isOnSide && isInside) << seed;
                }
    }
    EXPECT_GT(closed, 80) << "the test shows something";
}

TEST(CropMesh, KnowsWhetherASurfaceThatMissesTheSidesIsAroundOrWithin) {
    for (const bool isCavity : {false, true}) {
        std::vector<std::uint8_t> samples(7 * 7 * 7, isCavity ? 10 : 0);
        samples[3 + 7 * (3 + 7 * 3)] = isCavity ? 0 : 10;
        GridGeometry geometry;
        geometry.dims = {7, 7, 7};
        const auto grid = ScalarGrid::fromValues<std::uint8_t>(geometry, ScalarType::U8, samples);
        const SurfaceMesh whole = extractFull(grid, 5.0).value();
        const SurfaceMesh mesh = cropMesh(whole, {{1, 1, 1}, {5, 5, 5}}, BoxSides::Closed).value();
        const auto report = mesh::checkMesh(mesh);
        EXPECT_TRUE(report.isClosed && report.isManifold && report.isOriented);
        EXPECT_EQ(report.components, isCavity ? 2u : 1u);
        const double octahedron = 4.0 / 3.0 * 0.125;
        EXPECT_NEAR(report.enclosedVolume, isCavity ? 64.0 - octahedron : octahedron, 1e-6);
    }
}

TEST(CropMesh, TheLiveSurfaceIsCroppedTheSame) {
    const auto grid = std::make_shared<const ScalarGrid>(randomGrid({21, 19, 18}, 9, 77));
    auto engine = preprocess::makeMemoryEngine(grid);
    ASSERT_THAT(engine, IsOk());
    ASSERT_THAT(engine.value()->slideTo(3.0), IsOk());
    ASSERT_THAT(engine.value()->slideTo(5.0), IsOk());
    const CellBox box{{3, 8, 2}, {17, 16, 13}};
    const SurfaceMesh mesh = cropMesh(engine.value()->mesh().value(), box, BoxSides::Closed).value();
    EXPECT_EQ(placesOf(mesh), placesOf(cropMesh(extractFull(*grid, 5.0).value(), box, BoxSides::Closed).value()));
    EXPECT_TRUE(mesh::checkMesh(mesh).isClosed);
}

TEST(CropMesh, RefusesWhatCannotBeClosed) {
    SurfaceMesh merged = extractFull(randomGrid({5, 5, 5}, 9, 1), 4.0).value();
    merged.mergeBound.limit = 0.5;
    EXPECT_THAT(cropMesh(merged, {{0, 0, 0}, {4, 4, 4}}, BoxSides::Open), HasError(ErrorCode::InvalidArgument));
    // A sample is missing, so the surface is open inside the box.
    std::vector<float> samples;
    for (int i = 0; i < 9 * 9 * 9; ++i)
        samples.push_back(i == 4 + 9 * (4 + 9 * 4) ? std::nanf("") : static_cast<float>(i % 9));
    GridGeometry geometry;
    geometry.dims = {9, 9, 9};
    const SurfaceMesh open =
        extractFull(ScalarGrid::fromValues<float>(geometry, ScalarType::F32, samples), 3.5).value();
    EXPECT_THAT(cropMesh(open, {{0, 0, 0}, {8, 8, 8}}, BoxSides::Closed), HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(cropMesh(open, {{0, 0, 0}, {8, 8, 3}}, BoxSides::Closed), IsOk()) << "not in this box";
}

TEST(CutMesh, LeavesWhatLiesWithinAndSharesTheCut) {
    const ScalarGrid grid = randomGrid({12, 11, 10}, 200, 5);
    const SurfaceMesh whole = extractFull(grid, 80.5).value();
    const glm::dvec4 plane(0.6, -0.64, 0.48, -2.9);
    const SurfaceMesh cut = cutMesh(whole, std::array{plane}).value();
    const SurfaceMesh other = cutMesh(whole, std::array{-plane}).value();
    const auto side = [&](const glm::vec3& place) { return glm::dot(glm::dvec3(plane), glm::dvec3(place)) + plane.w; };
    const auto areaOf = [](const SurfaceMesh& mesh) {
        double area = 0.0;
        for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
            const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.triangles[i + k]]); };
            area += glm::length(glm::cross(at(1) - at(0), at(2) - at(0))) / 2.0;
        }
        return area;
    };
    for (const std::uint32_t vertex : cut.triangles)
        EXPECT_GE(side(cut.positions[vertex]), -1e-5);
    EXPECT_NEAR(areaOf(cut) + areaOf(other), areaOf(whole), 1e-4 * areaOf(whole));
    EXPECT_GT(areaOf(cut), 0.1 * areaOf(whole));
    EXPECT_GT(areaOf(other), 0.1 * areaOf(whole));
    // Open edges lie on the plane or where the surface was open: no crack along it.
    const auto openEdges = [](const SurfaceMesh& mesh) {
        std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges, open;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            edges.emplace(mesh.triangles[i], mesh.triangles[i % 3 == 2 ? i - 2 : i + 1]);
        for (const auto& [a, b] : edges)
            if (!edges.contains({b, a}))
                open.emplace(a, b);
        return open;
    };
    int onPlane = 0;
    for (const auto& [a, b] : openEdges(cut)) {
        const bool isOnPlane = std::abs(side(cut.positions[a])) < 1e-5 && std::abs(side(cut.positions[b])) < 1e-5;
        const auto isAtEnd = [&](const glm::vec3& place) {
            return place.x == 0 || place.y == 0 || place.z == 0 || place.x == 11 || place.y == 10 || place.z == 9;
        };
        EXPECT_TRUE(isOnPlane || (isAtEnd(cut.positions[a]) && isAtEnd(cut.positions[b])));
        onPlane += isOnPlane;
    }
    EXPECT_GT(onPlane, 50);
}

TEST(CutMesh, OnAPlaneOfGridPointsCutsNoTriangle) {
    const ScalarGrid grid = randomGrid({12, 11, 10}, 200, 6);
    const SurfaceMesh whole = extractFull(grid, 80.5).value();
    const SurfaceMesh cut = cutMesh(whole, std::array{glm::dvec4(1.0, 0.0, 0.0, -4.0)}).value();
    EXPECT_EQ(cut.positions.size(), whole.positions.size()) << "no vertex is new";
    EXPECT_LT(cut.triangles.size(), whole.triangles.size());
}

} // namespace
} // namespace isoslider::extract
