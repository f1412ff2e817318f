#include "core/extract/merged/merged_extraction.h"

#include <algorithm>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "core/cell/merged_cell.h"
#include "core/extract/full_extraction.h"
#include "core/extract/merged/merged_interpolant.h"
#include "core/mesh/certificate.h"
#include "core/mesh/mesh_checks.h"
#include "tests/property/random_volumes.h"
#include "tests/support/result_matchers.h"

namespace isoslider::extract {
namespace {

using test::IsOk;
using Measure = MergeBound::Measure;
using Place = std::array<std::int64_t, 3>;

SurfaceMesh merged(const ScalarGrid& grid, double isovalue, const MergeBound& bound, int maxLevel = kMaxMergeLevel) {
    auto mesh = extractMerged(grid, isovalue, bound, maxLevel);
    EXPECT_THAT(mesh, IsOk());
    return std::move(mesh).value();
}

const MergeBound kBounds[] = {{Measure::Scalar, 0.5},   {Measure::Scalar, 3.0},   {Measure::Scalar, 1e9},
                              {Measure::Distance, 0.1}, {Measure::Distance, 0.5}, {Measure::Distance, 1e9}};

TEST(MergedExtraction, WithoutABoundIsTheFullExtraction) {
    test::Random random(test::testSeed(1));
    for (int i = 0; i < 60; ++i) {
        const test::RandomVolume volume = test::randomVolume(random, 40);
        if (!volume.hasFinite)
            continue;
        const double isovalue = volume.samples[random() % volume.samples.size()];
        const auto full = extractFull(*volume.grid, isovalue);
        ASSERT_THAT(full, IsOk());
        const SurfaceMesh mesh = merged(*volume.grid, isovalue, {});
        ASSERT_EQ(mesh.edgeIds, full.value().edgeIds) << volume.description;
        ASSERT_EQ(mesh.triangles, full.value().triangles) << volume.description;
        ASSERT_EQ(mesh.positions, full.value().positions) << volume.description;
        ASSERT_EQ(mesh.normals, full.value().normals) << volume.description;
    }
}

TEST(MergedExtraction, HasNoCrackAndTheSameTopology) {
    test::Random random(test::testSeed(2));
    std::uint64_t merges = 0, centres = 0;
    for (int i = 0; i < 40; ++i) {
        const auto grid = i % 4 == 3 ? test::randomVolume(random, 30).grid : test::patchyVolume(random);
        for (const MergeBound& bound : kBounds) {
            const double isovalue =
                i % 4 == 3 ? 40.0 * test::unitRandom(random) : 140.0 * test::unitRandom(random) - 50.0;
            const auto full = extractFull(*grid, isovalue);
            ASSERT_THAT(full, IsOk());
            const SurfaceMesh mesh = merged(*grid, isovalue, bound);
            const mesh::MeshReport expected = mesh::checkMesh(full.value()), report = mesh::checkMesh(mesh);
            const auto where = testing::Message() << "volume " << i << ", isovalue " << isovalue << ", bound "
                                                  << static_cast<int>(bound.measure) << " " << bound.limit;
            ASSERT_TRUE(report.isManifold && report.isOriented) << where;
            ASSERT_EQ(report.duplicateTriangles, 0u) << where;
            ASSERT_EQ(report.components, expected.components) << where;
            ASSERT_EQ(report.euler, expected.euler) << where;
            ASSERT_EQ(report.boundaryLoops, expected.boundaryLoops) << where;
            const mesh::Certificate certificate = mesh::certify(mesh, {"", std::nullopt, ""});
            ASSERT_EQ(certificate.openAt(mesh::OpenAt::Elsewhere).edges, 0u) << where;
            merges += full.value().triangleCount() - mesh.triangleCount();
            centres += mesh.positions.size() - mesh.edgeIds.size();
        }
    }
    EXPECT_GT(merges, 10000u);
    EXPECT_GT(centres, 0u);
}

// On a vertex's active edge, the sample differs from the merged cell's interpolant by the bound at most, at both ends,
// and the interpolant is the isovalue at the vertex. So the sampled field there is within the bound; if the vertex lies
// on another part of its leaf edge, it is at the nearest end within twice the bound.
TEST(MergedExtraction, KeepsVerticesWithinTheBoundOfTheirActiveEdges) {
    test::Random random(test::testSeed(4));
    std::uint64_t moved = 0, outside = 0;
    for (int i = 0; i < 30; ++i) {
        const auto grid = test::patchyVolume(random);
        const double isovalue = 140.0 * test::unitRandom(random) - 50.0;
        const GridDims& dims = grid->dims();
        const auto samples = grid->values<float>();
        for (const double limit : {0.2, 1.0, 5.0}) {
            const SurfaceMesh mesh = merged(*grid, isovalue, {Measure::Scalar, limit});
            for (std::size_t v = 0; v < mesh.edgeIds.size(); ++v) {
                const std::uint64_t point = mesh.edgeIds[v] / 4;
                const auto axis = static_cast<std::size_t>(mesh.edgeIds[v] % 4);
                const std::uint64_t coords[3] = {point % static_cast<std::uint64_t>(dims[0]),
                                                 point / static_cast<std::uint64_t>(dims[0]) %
                                                     static_cast<std::uint64_t>(dims[1]),
                                                 point / static_cast<std::uint64_t>(dims[0] * dims[1])};
                const std::uint64_t stride =
                    axis == 0 ? 1 : static_cast<std::uint64_t>(axis == 1 ? dims[0] : dims[0] * dims[1]);
                const double a = static_cast<double>(samples[point]), b = static_cast<double>(samples[point + stride]);
                const double t =
                    static_cast<double>(mesh.positions[v][static_cast<int>(axis)]) - static_cast<double>(coords[axis]);
                const double field = a + std::clamp(t, 0.0, 1.0) * (b - a);
                const bool isOnEdge = t >= 0.0 && t <= 1.0;
                ASSERT_LE(std::abs(field - isovalue), (isOnEdge ? 1.0 : 2.0) * limit + 1e-3)
                    << "volume " << i << ", t " << t;
                moved += std::abs(field - isovalue) > 1e-3;
                outside += !isOnEdge;
            }
        }
    }
    EXPECT_GT(moved, 1000u);
    EXPECT_GT(outside, 0u);
}

double fieldAt(const ScalarGrid& grid, const glm::dvec3& place) {
    const GridDims& dims = grid.dims();
    const auto samples = grid.values<float>();
    cell::CornerScalars corners;
    Place cell;
    for (std::size_t a = 0; a < 3; ++a)
        cell[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(place[static_cast<int>(a)]), 0, dims[a] - 2);
    for (std::size_t c = 0; c < 8; ++c)
        corners[c] = static_cast<double>(samples[static_cast<std::size_t>(
            (cell[0] + (c & 1 ? 1 : 0)) +
            dims[0] * ((cell[1] + (c & 2 ? 1 : 0)) + dims[1] * (cell[2] + (c & 4 ? 1 : 0))))]);
    return MergedInterpolant(corners, 1.0)
        .at({place.x - static_cast<double>(cell[0]), place.y - static_cast<double>(cell[1]),
             place.z - static_cast<double>(cell[2])});
}

// How far the field is from the isovalue inside triangles, ascending. Triangles of patchy volumes.
std::vector<double> errorsWithin(double limit) {
    test::Random random(test::testSeed(5));
    std::vector<double> errors;
    for (int i = 0; i < 30; ++i) {
        const auto grid = test::patchyVolume(random);
        const double isovalue = 140.0 * test::unitRandom(random) - 50.0;
        const SurfaceMesh mesh = merged(*grid, isovalue, {Measure::Scalar, limit});
        for (std::size_t k = 0; k < mesh.triangles.size(); k += 3) {
            const auto corner = [&](std::size_t n) { return glm::dvec3(mesh.positions[mesh.triangles[k + n]]); };
            for (const glm::dvec3 weights : {glm::dvec3(1, 1, 1) / 3.0, glm::dvec3(2, 1, 1) / 4.0,
                                             glm::dvec3(1, 2, 1) / 4.0, glm::dvec3(1, 1, 2) / 4.0}) {
                const double field =
                    fieldAt(*grid, weights.x * corner(0) + weights.y * corner(1) + weights.z * corner(2));
                if (!std::isnan(field)) // beside a missing sample
                    errors.push_back(std::abs(field - isovalue));
            }
        }
    }
    std::sort(errors.begin(), errors.end());
    return errors;
}

// A triangle is flat where the field is not, merged or not. Of all places in triangles, 99.9 % are off by no more than
// the bound beyond that.
TEST(MergedExtraction, StaysWithinTheBoundInsideTriangles) {
    const auto nearlyAll = [](const std::vector<double>& errors) { return errors[errors.size() * 999 / 1000]; };
    const double own = nearlyAll(errorsWithin(0.0));
    for (const double limit : {0.5, 2.0, 5.0, 10.0}) {
        const std::vector<double> errors = errorsWithin(limit);
        ASSERT_GT(errors.size(), 10000u);
        EXPECT_LE(nearlyAll(errors), own + limit) << limit;
        RecordProperty("largest within " + std::to_string(limit), std::to_string(errors.back()));
    }
}

using Triangle = std::array<glm::dvec3, 3>;

// Whether the inside of the segment passes through the inside of the triangle.
bool pierces(const glm::dvec3& from, const glm::dvec3& to, const Triangle& t) {
    const glm::dvec3 u = t[1] - t[0], v = t[2] - t[0], along = to - from, h = glm::cross(along, v);
    const double size = glm::dot(u, h);
    if (std::abs(size) < 1e-9 * glm::length(u) * glm::length(v) * glm::length(along))
        return false; // beside each other
    constexpr double kInside = 1e-6;
    const glm::dvec3 s = from - t[0], q = glm::cross(s, u);
    const double a = glm::dot(s, h) / size, b = glm::dot(along, q) / size, c = glm::dot(v, q) / size;
    return a > kInside && b > kInside && a + b < 1 - kInside && c > kInside && c < 1 - kInside;
}

TEST(MergedExtraction, HasNoTrianglesThatIntersectInACell) {
    test::Random random(test::testSeed(6));
    std::uint64_t pairs = 0, intersections = 0;
    for (int i = 0; i < 40; ++i) {
        const auto grid = test::patchyVolume(random);
        for (const MergeBound& bound : kBounds) {
            const double isovalue = 140.0 * test::unitRandom(random) - 50.0;
            const SurfaceMesh mesh = merged(*grid, isovalue, bound);
            const LeafLevels levels =
                LeafLevels::find(SampleView<float>{grid->values<float>().data(), grid->dims()}, isovalue, bound);
            std::map<Place, std::vector<Triangle>> byLeaf;
            for (std::size_t k = 0; k < mesh.triangles.size(); k += 3) {
                Triangle triangle;
                for (std::size_t n = 0; n < 3; ++n)
                    triangle[n] = mesh.positions[mesh.triangles[k + n]];
                const glm::dvec3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
                Place cell;
                for (std::size_t a = 0; a < 3; ++a)
                    cell[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(middle[static_cast<int>(a)]), 0,
                                                       levels.cells()[a] - 1);
                const std::int64_t inside = (std::int64_t{1} << levels.level(cell[0], cell[1], cell[2])) - 1;
                byLeaf[{cell[0] & ~inside, cell[1] & ~inside, cell[2] & ~inside}].push_back(triangle);
            }
            for (const auto& [leaf, triangles] : byLeaf)
                for (std::size_t a = 0; a < triangles.size(); ++a)
                    for (std::size_t b = 0; b < triangles.size(); ++b) {
                        if (a == b)
                            continue;
                        ++pairs;
                        for (std::size_t n = 0; n < 3; ++n)
                            intersections += pierces(triangles[a][n], triangles[a][(n + 1) % 3], triangles[b]);
                    }
        }
    }
    EXPECT_EQ(intersections, 0u);
    EXPECT_GT(pairs, 100000u);
}

// The definition, on plain arrays, cell by cell and without what the product knows of its parts.
class LeavesByDefinition {
public:
    LeavesByDefinition(const ScalarGrid& grid, double isovalue, const MergeBound& bound)
        : samples_(grid.values<float>()), dims_(grid.dims()), isovalue_(isovalue), bound_(bound) {}

    int levelOf(const Place& cell) {
        int level = 0;
        for (int n = 1; n <= kMaxMergeLevel; ++n) {
            const std::int64_t inside = (std::int64_t{1} << n) - 1;
            if (isUsable({cell[0] & ~inside, cell[1] & ~inside, cell[2] & ~inside}, n))
                level = n;
        }
        return level;
    }

private:
    float at(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return samples_[static_cast<std::size_t>(x + dims_[0] * (y + dims_[1] * z))];
    }
    bool isUsable(const Place& o, int n) {
        if (n == 0)
            return true;
        if (const auto known = known_.find({o, n}); known != known_.end())
            return known->second;
        return known_[{o, n}] = isUsableAnew(o, n);
    }

    bool isUsableAnew(const Place& o, int n) {
        const std::int64_t side = std::int64_t{1} << n, half = side / 2;
        for (std::size_t a = 0; a < 3; ++a)
            if (o[a] + side >= dims_[a])
                return false;
        for (int c = 0; c < 8; ++c)
            if (!isUsable({o[0] + half * (c & 1), o[1] + half * (c >> 1 & 1), o[2] + half * (c >> 2)}, n - 1))
                return false;
        cell::MergedSigns signs = 0;
        for (int p = 0; p < 27; ++p)
            signs |= cell::MergedSigns{at(o[0] + half * (p % 3), o[1] + half * (p / 3 % 3), o[2] + half * (p / 9)) >=
                                       isovalue_}
                     << p;
        for (std::int64_t z = 0; z <= side; ++z)
            for (std::int64_t y = 0; y <= side; ++y)
                for (std::int64_t x = 0; x <= side; ++x) {
                    if (!std::isfinite(at(o[0] + x, o[1] + y, o[2] + z)))
                        return false;
                    for (int axis = 0; axis < 3; ++axis) {
                        const Place from{x, y, z};
                        Place to = from;
                        if (++to[static_cast<std::size_t>(axis)] > side)
                            continue;
                        if (isBad(o, side, from, to))
                            return false;
                    }
                }
        return cell::keepsTopology(signs);
    }

    // The product of three weights for each corner, by axis.
    double interpolant(const Place& o, std::int64_t side, double x, double y, double z) const {
        const double s = static_cast<double>(side);
        double sum = 0.0;
        for (int c = 0; c < 8; ++c)
            sum += static_cast<double>(at(o[0] + side * (c & 1), o[1] + side * (c >> 1 & 1), o[2] + side * (c >> 2))) *
                   (c & 1 ? x / s : 1 - x / s) * (c >> 1 & 1 ? y / s : 1 - y / s) * (c >> 2 ? z / s : 1 - z / s);
        return sum;
    }

    bool isBad(const Place& o, std::int64_t side, const Place& from, const Place& to) const {
        const double a = static_cast<double>(at(o[0] + from[0], o[1] + from[1], o[2] + from[2]));
        const double b = static_cast<double>(at(o[0] + to[0], o[1] + to[1], o[2] + to[2]));
        if ((a >= isovalue_) == (b >= isovalue_))
            return false;
        const auto T = [&](double x, double y, double z) { return interpolant(o, side, x, y, z); };
        const auto d = [](std::int64_t i) { return static_cast<double>(i); };
        const double error = std::max(std::abs(a - T(d(from[0]), d(from[1]), d(from[2]))),
                                      std::abs(b - T(d(to[0]), d(to[1]), d(to[2]))));
        if (bound_.measure == Measure::Scalar)
            return error > bound_.limit;
        const std::array<double, 3> m{0.5 * d(from[0] + to[0]), 0.5 * d(from[1] + to[1]), 0.5 * d(from[2] + to[2])};
        // Exact for a trilinear function: it is linear along each axis.
        const double gx = T(m[0] + 0.5, m[1], m[2]) - T(m[0] - 0.5, m[1], m[2]);
        const double gy = T(m[0], m[1] + 0.5, m[2]) - T(m[0], m[1] - 0.5, m[2]);
        const double gz = T(m[0], m[1], m[2] + 0.5) - T(m[0], m[1], m[2] - 0.5);
        return error > bound_.limit * std::sqrt(gx * gx + gy * gy + gz * gz);
    }

    std::span<const float> samples_;
    GridDims dims_;
    double isovalue_;
    MergeBound bound_;
    std::map<std::pair<Place, int>, bool> known_;
};

TEST(LeafLevels, AreThoseOfTheDefinition) {
    test::Random random(test::testSeed(3));
    LeafCounts seen{};
    for (int i = 0; i < 24; ++i) {
        const auto grid = test::patchyVolume(random);
        const MergeBound bound = kBounds[static_cast<std::size_t>(i) % std::size(kBounds)];
        const double isovalue = 140.0 * test::unitRandom(random) - 50.0;
        const SampleView<float> view{grid->values<float>().data(), grid->dims()};
        const LeafLevels leaves = LeafLevels::find(view, isovalue, bound);
        LeavesByDefinition reference(*grid, isovalue, bound);
        for (std::int64_t z = 0; z < leaves.cells()[2]; ++z)
            for (std::int64_t y = 0; y < leaves.cells()[1]; ++y)
                for (std::int64_t x = 0; x < leaves.cells()[0]; ++x) {
                    ASSERT_EQ(leaves.level(x, y, z), reference.levelOf({x, y, z}))
                        << "volume " << i << " at " << x << " " << y << " " << z;
                    ++seen[static_cast<std::size_t>(leaves.level(x, y, z))];
                }
    }
    for (std::size_t n = 0; n < 5; ++n)
        EXPECT_GT(seen[n], 0u) << n;
}

TEST(MergedExtraction, CountsActiveLeavesAndKeepsToTheLevelAllowed) {
    const auto grid = test::makeVolume<std::uint16_t>(ScalarType::U16, test::cubeGeometry(33),
                                                      [](auto x, auto y, auto z) { return 40 * x + 3 * y + 2 * z; });
    const MergeBound bound{Measure::Distance, 0.01};
    for (int level = 0; level <= kMaxMergeLevel; ++level) {
        LeafCounts leaves{};
        const auto mesh = extractMerged(*grid, 700.0, bound, level, {}, &leaves);
        ASSERT_THAT(mesh, IsOk());
        for (std::size_t n = 0; n < leaves.size(); ++n)
            EXPECT_EQ(leaves[n] > 0, static_cast<int>(n) == level) << n << " of " << level;
        // A plane of 32 x 32 cells: linear fields merge all the way.
        EXPECT_NEAR(mesh::checkMesh(mesh.value()).area, 1024.0 * std::sqrt(1.0 + 13.0 / 1600.0), 1e-2) << level;
    }
}

} // namespace
} // namespace isoslider::extract
