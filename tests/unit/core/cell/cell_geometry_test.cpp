// Where the triangles of a cell lie: vertices on the interpolant's surface, triangles that do not cross.

#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "tests/unit/core/cell/state_labels.h"
#include "tests/unit/core/cell/state_mesh.h"

namespace isoslider::cell {
namespace {

using test::CellScalars;
using Places = std::array<glm::dvec3, kInnerVertex + 16>;

constexpr double kLeast = 1e-4; // between inner vertices, in cells

double interpolate(const CellScalars& v, const glm::dvec3& p) {
    double sum = 0.0;
    for (unsigned i = 0; i < 8; ++i)
        sum += v[i] * ((i & 1u) != 0 ? p.x : 1.0 - p.x) * ((i & 2u) != 0 ? p.y : 1.0 - p.y) *
               ((i & 4u) != 0 ? p.z : 1.0 - p.z);
    return sum;
}

// Vertices as an extraction places them.
Places placesOf(const CellState& state, const CellScalars& scalars, double isovalue, double least = kLeast) {
    Places places{};
    for (std::size_t e = 0; e < 12; ++e) {
        const CellEdge& edge = kCellEdges[e];
        const double low = scalars[edge.lowerCorner] - isovalue, high = scalars[edge.upperCorner] - isovalue;
        places[e] = glm::dvec3(edge.lowerCorner & 1, edge.lowerCorner >> 1 & 1, edge.lowerCorner >> 2 & 1);
        places[e][edge.axis] = (low < 0) != (high < 0) ? low / (low - high) : 0.5;
    }
    std::size_t next = kInnerVertex;
    if (state.tunnel != Tunnel::None) {
        const TunnelWaist waist = tunnelWaist(scalars, isovalue, least);
        for (const std::uint8_t at : state.ring)
            places[next++] = {waist.x[at & 1], waist.y[at >> 1 & 1], waist.z[at >> 2 & 1]};
    }
    for (const CellCentre& centre : state.centres) {
        double count = 0.0;
        for (std::size_t e = 0; e < 12; ++e)
            if ((centre.loopEdges >> e & 1) != 0) {
                places[next] += places[e];
                count += 1.0;
            }
        places[next++] /= count;
    }
    return places;
}

double volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    return glm::dot(glm::cross(b - a, c - a), d - a);
}

// The segment crosses the inside of the triangle, by more than rounding.
bool pierces(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& t) {
    constexpr double kZero = 1e-11;
    const double start = volume(t[0], t[1], t[2], from), end = volume(t[0], t[1], t[2], to);
    if (!(start > kZero && end < -kZero) && !(start < -kZero && end > kZero))
        return false;
    int turns = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double turn = volume(from, to, t[k], t[(k + 1) % 3]);
        turns += turn > kZero ? 1 : turn < -kZero ? -1 : 0;
    }
    return std::abs(turns) == 3;
}

// An edge of one through the inside of the other. Edges that meet the other triangle in a common vertex only
// do not count, and do not come out as crossings.
bool cross(const Triangle& a, const Triangle& b, const Places& places) {
    const auto at = [&](int vertex) { return places[static_cast<std::size_t>(vertex)]; };
    const auto goesThrough = [&](const Triangle& edges, const Triangle& t) {
        const auto belongs = [&](int vertex) { return std::find(t.begin(), t.end(), vertex) != t.end(); };
        for (std::size_t k = 0; k < 3; ++k) {
            const int from = edges[k], to = edges[(k + 1) % 3];
            if (!belongs(from) && !belongs(to) && pierces(at(from), at(to), {at(t[0]), at(t[1]), at(t[2])}))
                return true;
        }
        return false;
    };
    return goesThrough(a, b) || goesThrough(b, a);
}

struct Crossings {
    int cells = 0;
    int ofTwoPieces = 0; // cells in which triangles of different pieces cross
    int ofOnePiece = 0;
};

void countCrossings(const CellState& state, const CellScalars& scalars, Crossings& crossings) {
    const auto triangles = trianglesOf(state);
    const auto pieces = piecesOf(triangles);
    const Places places = placesOf(state, scalars, 0.0);
    const auto pieceOf = [&](const Triangle& t) {
        return std::find_if(pieces.begin(), pieces.end(), [&](const auto& piece) { return piece.contains(t[0]); });
    };
    bool isOfTwo = false, isOfOne = false;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = i + 1; j < triangles.size(); ++j)
            if (cross(triangles[i], triangles[j], places))
                (pieceOf(triangles[i]) == pieceOf(triangles[j]) ? isOfOne : isOfTwo) = true;
    crossings.cells += 1;
    crossings.ofTwoPieces += isOfTwo;
    crossings.ofOnePiece += isOfOne;
}

TEST(CellGeometry, TellsCrossingTrianglesFromTouchingOnes) {
    Places places{};
    places[0] = {0, 0, 0}, places[1] = {1, 0, 0}, places[2] = {0, 1, 0};
    places[3] = {0.2, 0.2, -1}, places[4] = {0.2, 0.2, 1}, places[5] = {2, 2, 0.1}, places[6] = {0.6, 0.6, 1};
    EXPECT_TRUE(cross({0, 1, 2}, {3, 4, 5}, places));
    EXPECT_TRUE(cross({3, 4, 5}, {0, 1, 2}, places));
    EXPECT_TRUE(cross({0, 1, 2}, {0, 3, 4}, places)) << "from a common corner";
    EXPECT_FALSE(cross({0, 1, 2}, {0, 1, 4}, places)) << "a common edge";
    EXPECT_FALSE(cross({0, 1, 2}, {4, 5, 6}, places));
}

// Triangles are flat where the surface is curved, so topology alone does not rule crossings out; none was
// found in eight million cells. ISOSLIDER_PRINT_CROSSINGS lists them by state.
TEST(CellGeometry, TrianglesOfACellDoNotCross) {
    const ClassWitnesses found = findClasses(7, 60);
    std::map<std::string, Crossings> byState;
    Crossings all;
    for (const auto& witnesses : found.classes)
        for (const CellScalars& witness : witnesses)
            for (int symmetry = 0; symmetry < 96; ++symmetry) {
                const CellScalars cell = test::turned(witness, symmetry);
                const CellState& state = stateAt(cell, 0.0);
                Crossings& crossings = byState[describe(state)];
                const Crossings before = crossings;
                countCrossings(state, cell, crossings);
                all.cells += 1;
                all.ofTwoPieces += crossings.ofTwoPieces - before.ofTwoPieces;
                all.ofOnePiece += crossings.ofOnePiece - before.ofOnePiece;
            }
    if (std::getenv("ISOSLIDER_PRINT_CROSSINGS") != nullptr)
        for (const auto& [state, c] : byState)
            if (c.ofTwoPieces + c.ofOnePiece > 0)
                std::cout << state << ": of " << c.cells << " cells " << c.ofTwoPieces << " with crossing pieces, "
                          << c.ofOnePiece << " with a piece that crosses itself\n";
    RecordProperty("cells", all.cells);
    RecordProperty("ofTwoPieces", all.ofTwoPieces);
    RecordProperty("ofOnePiece", all.ofOnePiece);
    EXPECT_EQ(all.ofTwoPieces, 0) << "of " << all.cells;
    EXPECT_EQ(all.ofOnePiece, 0) << "of " << all.cells;
}

// A random cell with a tunnel at isovalue 0.
CellScalars tunnelCell(test::Random& random) {
    for (;;)
        if (const CellScalars cell = untiedCell(random); stateAt(cell, 0.0).tunnel != Tunnel::None)
            return cell;
}

// The box of the roots has six corners on the surface. The other two state which diagonal the tunnel winds
// round.
TEST(TunnelWaists, LieOnTheSurface) {
    test::Random random(31);
    int told = 0;
    for (int i = 0; i < 2000; ++i) {
        const CellScalars cell = tunnelCell(random);
        const CellState& state = stateAt(cell, 0.0);
        const Places places = placesOf(state, cell, 0.0, 1e-13);
        const double greatest = std::abs(
            *std::max_element(cell.begin(), cell.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
        for (std::size_t k = 0; k < 6; ++k)
            ASSERT_LT(std::abs(interpolate(cell, places[kInnerVertex + k])), 1e-11 * greatest)
                << test::toString(cell, 0.0);
        const TunnelWaist waist = tunnelWaist(cell, 0.0, 1e-13);
        const auto d = static_cast<std::size_t>(state.diagonal);
        told += std::abs(interpolate(cell, {waist.x[d & 1], waist.y[d >> 1], waist.z[0]})) > 1e-10 * greatest;
    }
    EXPECT_GT(told, 1900);
}

TEST(TunnelWaists, KeepApartAndOffTheFaces) {
    test::Random random(32);
    for (int i = 0; i < 2000; ++i) {
        const CellScalars cell = tunnelCell(random);
        const TunnelWaist waist = tunnelWaist(cell, 0.0, kLeast);
        for (const auto& ends : {waist.x, waist.y, waist.z}) {
            ASSERT_GE(ends[0], 0.99 * kLeast) << test::toString(cell, 0.0);
            ASSERT_GE(ends[1] - ends[0], 0.99 * kLeast) << test::toString(cell, 0.0);
            ASSERT_LE(ends[1], 1.0 - 0.99 * kLeast) << test::toString(cell, 0.0);
        }
    }
}

// The least one is where a tunnel is born, and scalars may be of any size.
TEST(TunnelWaists, KeepApartWhereTheyHaveNoSize) {
    test::Random random(33);
    int tunnels = 0;
    for (int i = 0; i < 20000; ++i) {
        const auto kind = static_cast<test::CellKind>(test::pickInt(random, 0, test::kCellKinds - 1));
        const CellScalars cell = test::randomCell(kind, random);
        const double isovalue = test::randomIsovalue(cell, random);
        if (stateAt(cell, isovalue).tunnel == Tunnel::None)
            continue;
        ++tunnels;
        const TunnelWaist waist = tunnelWaist(cell, isovalue, kLeast);
        for (const auto& ends : {waist.x, waist.y, waist.z}) {
            ASSERT_GE(ends[0], 0.99 * kLeast) << test::toString(cell, isovalue);
            ASSERT_GE(ends[1] - ends[0], 0.99 * kLeast) << test::toString(cell, isovalue);
            ASSERT_LE(ends[1], 1.0 - 0.99 * kLeast) << test::toString(cell, isovalue);
        }
    }
    EXPECT_GT(tunnels, 300);
}

TEST(CellGradient, IsTheDifferenceQuotient) {
    test::Random random(37);
    for (int i = 0; i < 2000; ++i) {
        const CellScalars cell = test::randomCell(test::CellKind::Uniform, random);
        const glm::dvec3 p(test::pickUnit(random), test::pickUnit(random), test::pickUnit(random));
        const std::array<double, 3> gradient = gradientInCell(cell, p.x, p.y, p.z);
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 step(0.0);
            step[axis] = 0.25; // linear along each axis: no step is too long
            const double quotient = (interpolate(cell, p + step) - interpolate(cell, p - step)) / 0.5;
            ASSERT_NEAR(gradient[static_cast<std::size_t>(axis)], quotient, 1e-12);
        }
    }
}

} // namespace
} // namespace isoslider::cell
