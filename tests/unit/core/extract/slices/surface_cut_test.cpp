#include "core/extract/slices/surface_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/live/brick_picture.h"
#include "core/extract/slide_engine.h"
#include "preprocess/metacells/brick_list.h"
#include "tests/property/test_volumes.h"
#include "tests/support/result_matchers.h"

namespace isoslider::extract {
namespace {

using test::HasError;
using test::IsOk;

using Points = std::vector<glm::vec3>;

std::shared_ptr<const ScalarGrid> noise(const GridDims& dims, unsigned seed, double missing = 0.0) {
    GridGeometry geometry;
    geometry.dims = dims;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> values(-1.0f, 1.0f);
    return test::makeVolume<float>(ScalarType::F32, geometry, [&](auto, auto, auto) {
        const float value = values(random);
        return std::abs(value) < missing ? std::numeric_limits<float>::quiet_NaN() : value;
    });
}

SurfaceFrame wholeFrame(const ScalarGrid& grid, double isovalue) {
    auto mesh = extractFull(grid, isovalue);
    EXPECT_THAT(mesh, IsOk());
    SurfaceFrame frame;
    frame.geometry = grid.geometry();
    frame.isovalue = isovalue;
    frame.positions = std::move(mesh.value().positions);
    frame.indices = std::move(mesh.value().triangles);
    return frame;
}

SurfaceFrame slidFrame(const std::shared_ptr<const ScalarGrid>& grid, double isovalue) {
    auto engine = preprocess::makeMemoryEngine(grid);
    EXPECT_THAT(engine, IsOk());
    EXPECT_THAT(engine.value()->slideTo(isovalue), IsOk());
    SurfaceFrame frame;
    engine.value()->copyFrame(frame);
    frame.isovalue = isovalue;
    frame.geometry = grid->geometry();
    EXPECT_NE(frame.bricks, nullptr);
    return frame;
}

/// A cell that touches the face has all its corners.
bool hasCell(const ScalarGrid& grid, int axis, const std::array<std::int64_t, 3>& face) {
    for (const int side : {-1, 0}) {
        bool isWhole = true;
        for (int corner = 0; corner < 8 && isWhole; ++corner) {
            std::array<std::int64_t, 3> at = face;
            for (std::size_t a = 0; a < 3; ++a)
                at[a] += (corner >> a & 1) + (static_cast<int>(a) == axis ? side : 0);
            for (std::size_t a = 0; a < 3; ++a)
                isWhole = isWhole && at[a] >= 0 && at[a] < grid.dims()[a];
            isWhole = isWhole && std::isfinite(grid.valueAt(at[0], at[1], at[2]));
        }
        if (isWhole)
            return true;
    }
    return false;
}

/// The isoline of one plane of grid points, face by face: marching squares, and where a face is ambiguous the value
/// where its bilinear interpolant has its saddle decides.
Points isoline(const ScalarGrid& grid, int axis, std::int64_t position, double isovalue) {
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    Points points;
    std::array<std::int64_t, 3> at{};
    at[static_cast<std::size_t>(axis)] = position;
    auto& i = at[static_cast<std::size_t>(u)];
    auto& j = at[static_cast<std::size_t>(v)];
    for (j = 0; j + 1 < grid.dims()[static_cast<std::size_t>(v)]; ++j)
        for (i = 0; i + 1 < grid.dims()[static_cast<std::size_t>(u)]; ++i) {
            if (!hasCell(grid, axis, at))
                continue;
            std::array<double, 4> s{}; // around the face
            std::array<glm::dvec3, 4> p{};
            for (std::size_t k = 0; k < 4; ++k) {
                auto corner = at;
                corner[static_cast<std::size_t>(u)] += k == 1 || k == 2 ? 1 : 0;
                corner[static_cast<std::size_t>(v)] += k >= 2 ? 1 : 0;
                s[k] = grid.valueAt(corner[0], corner[1], corner[2]);
                p[k] = {corner[0], corner[1], corner[2]};
            }
            std::vector<std::size_t> crossed;
            for (std::size_t k = 0; k < 4; ++k)
                if ((s[k] >= isovalue) != (s[(k + 1) % 4] >= isovalue))
                    crossed.push_back(k);
            const auto add = [&](std::size_t k) {
                const std::size_t n = (k + 1) % 4;
                points.emplace_back(p[k] + (p[n] - p[k]) * ((isovalue - s[k]) / (s[n] - s[k])));
            };
            if (crossed.size() == 2) {
                add(crossed[0]);
                add(crossed[1]);
            } else if (crossed.size() == 4) {
                const double saddle = (s[0] * s[2] - s[1] * s[3]) / (s[0] + s[2] - s[1] - s[3]);
                // Around corner 1 and corner 3, or around corner 0 and corner 2: those that the middle is not with.
                const bool cutsOff13 = (s[0] >= isovalue) == (saddle >= isovalue);
                for (const std::size_t k :
                     cutsOff13 ? std::array<std::size_t, 4>{0, 1, 2, 3} : std::array<std::size_t, 4>{3, 0, 1, 2})
                    add(k);
            }
        }
    return points;
}

/// How many segments of `some` have none in `others` with the same ends; each stands for one.
int unmatched(const Points& some, const Points& others, float tolerance = 2e-5f) {
    std::vector<bool> isTaken(others.size() / 2, false);
    const auto isNear = [&](const glm::vec3& a, const glm::vec3& b) { return glm::distance(a, b) < tolerance; };
    int missing = 0;
    for (std::size_t i = 0; i + 1 < some.size(); i += 2) {
        bool isFound = false;
        for (std::size_t j = 0; j + 1 < others.size() && !isFound; j += 2)
            if (!isTaken[j / 2] && ((isNear(some[i], others[j]) && isNear(some[i + 1], others[j + 1])) ||
                                    (isNear(some[i], others[j + 1]) && isNear(some[i + 1], others[j]))))
                isFound = isTaken[j / 2] = true;
        missing += isFound ? 0 : 1;
    }
    return missing;
}

CutPlane across(int axis, double position) {
    CutPlane plane{glm::dvec3(0.0), position};
    plane.normal[axis] = 1.0;
    return plane;
}

Points cut(const SurfaceFrame& frame, const CutPlane& plane) {
    auto points = cutSurface(frame, plane);
    EXPECT_THAT(points, IsOk());
    return std::move(points).value();
}

TEST(SurfaceCut, OnPlanesOfGridPointsIsTheIsolineOfTheSlice) {
    const GridDims dims{19, 18, 17}; // noise: one face in six is ambiguous, planes lie within bricks and between them
    const auto grid = noise(dims, 7);
    for (const double isovalue : {-0.4, 0.05}) {
        const auto whole = wholeFrame(*grid, isovalue), slid = slidFrame(grid, isovalue);
        for (int axis = 0; axis < 3; ++axis)
            for (const std::int64_t position : {std::int64_t{0}, std::int64_t{5}, std::int64_t{8}, std::int64_t{16},
                                                dims[static_cast<std::size_t>(axis)] - 1}) {
                const Points expected = isoline(*grid, axis, position, isovalue);
                ASSERT_GT(expected.size(), 100u);
                for (const auto* frame : {&whole, &slid}) {
                    const Points found = cut(*frame, across(axis, static_cast<double>(position)));
                    EXPECT_EQ(found.size(), expected.size());
                    EXPECT_EQ(unmatched(expected, found), 0) << axis << " at " << position;
                    EXPECT_EQ(unmatched(found, expected), 0) << axis << " at " << position;
                }
            }
    }
}

TEST(SurfaceCut, BesideMissingSamplesHasTheLinesThatTheSurfaceHas) {
    const auto grid = noise({14, 13, 12}, 9, 0.04);
    const auto frame = slidFrame(grid, 0.1);
    for (int axis = 0; axis < 3; ++axis) {
        const Points expected = isoline(*grid, axis, 6, 0.1);
        const Points found = cut(frame, across(axis, 6.0));
        EXPECT_GT(expected.size(), 60u);
        EXPECT_EQ(unmatched(expected, found), 0);
        EXPECT_EQ(unmatched(found, expected), 0);
    }
}

TEST(SurfaceCut, OfAnObliquePlaneIsClosedAndLiesOnBoth) {
    GridGeometry geometry;
    geometry.dims = {30, 30, 30};
    const auto ball = test::makeVolume<float>(ScalarType::F32, geometry, [](auto x, auto y, auto z) {
        return -std::hypot(static_cast<float>(x) - 14.5f, static_cast<float>(y) - 14.5f, static_cast<float>(z) - 14.5f);
    });
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    const CutPlane plane{normal, glm::dot(normal, glm::dvec3(14.5)) + 4.0};
    for (const auto& frame : {wholeFrame(*ball, -10.0), slidFrame(ball, -10.0)}) {
        const Points points = cut(frame, plane);
        ASSERT_GT(points.size(), 60u);
        double length = 0.0;
        for (std::size_t i = 0; i < points.size(); i += 2) {
            length += glm::distance(points[i], points[i + 1]);
            EXPECT_NEAR(glm::dot(normal, glm::dvec3(points[i])), plane.offset, 1e-4);
            EXPECT_NEAR(glm::distance(points[i], glm::vec3(14.5f)), 10.0f, 0.05f);
        }
        EXPECT_NEAR(length, 2.0 * 3.14159 * std::sqrt(100.0 - 16.0), 0.3);
        // Every end is that of exactly one other segment: the line has no gaps.
        for (std::size_t i = 0; i < points.size(); ++i)
            EXPECT_EQ(std::count_if(points.begin(), points.end(),
                                    [&](const glm::vec3& p) { return glm::distance(p, points[i]) < 1e-5f; }),
                      2);
    }
}

TEST(SurfaceCut, OfAMissIsEmptyAndStopsWhenAsked) {
    const auto grid = noise({10, 10, 10}, 1);
    const auto frame = slidFrame(grid, 0.0);
    EXPECT_TRUE(cut(frame, across(2, 40.0)).empty());
    EXPECT_TRUE(cut(SurfaceFrame{}, across(2, 4.0)).empty());
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    EXPECT_THAT(cutSurface(frame, across(2, 4.0), job), HasError(ErrorCode::Cancelled));
}

} // namespace
} // namespace isoslider::extract
