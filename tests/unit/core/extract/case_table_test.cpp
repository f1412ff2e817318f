#include "core/extract/case_table.h"

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

namespace isoslider::extract {
namespace {

using Segment = std::pair<int, int>; ///< directed, between cell edges

glm::vec3 corner(int c) { return {static_cast<float>(c & 1), static_cast<float>(c >> 1 & 1), static_cast<float>(c >> 2)}; }
glm::vec3 middle(int e) { return 0.5f * (corner(kCellEdges[e].lowerCorner) + corner(kCellEdges[e].upperCorner)); }
bool isAboveIn(int caseIndex, int c) { return caseIndex >> c & 1; }

// Cell edges lie in one face when their middles share a coordinate 0 or 1.
bool shareFace(int a, int b) {
    const glm::vec3 p = middle(a), q = middle(b);
    for (int axis = 0; axis < 3; ++axis)
        if (p[axis] == q[axis] && p[axis] != 0.5f)
            return true;
    return false;
}

std::vector<Segment> directedEdges(int caseIndex) {
    std::vector<Segment> edges;
    const CellCase& cell = caseTable()[static_cast<std::size_t>(caseIndex)];
    for (std::size_t t = 0; t < cell.triangleCount; ++t)
        for (std::size_t k = 0; k < 3; ++k)
            edges.emplace_back(cell.edges[3 * t + k], cell.edges[3 * t + (k + 1) % 3]);
    return edges;
}

// Where the triangles of a case end: the segments on the cell's faces.
std::set<Segment> boundary(int caseIndex) {
    const auto all = directedEdges(caseIndex);
    std::set<Segment> segments(all.begin(), all.end());
    for (const Segment& s : all)
        if (segments.contains({s.second, s.first})) {
            segments.erase({s.second, s.first});
            segments.erase(s);
        }
    return segments;
}

std::set<Segment> reversed(const std::set<Segment>& segments) {
    std::set<Segment> out;
    for (const Segment& s : segments)
        out.insert({s.second, s.first});
    return out;
}

bool hasAmbiguousFace(int caseIndex) {
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int o = side << axis, u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3);
            if (isAboveIn(caseIndex, o) == isAboveIn(caseIndex, o + u + v) && isAboveIn(caseIndex, o + u) == isAboveIn(caseIndex, o + v) &&
                isAboveIn(caseIndex, o) != isAboveIn(caseIndex, o + u))
                return true;
        }
    return false;
}

TEST(CaseTable, NumbersEdgesAsItsHeaderSays) {
    for (int e = 0; e < 12; ++e) {
        const CellEdge& edge = kCellEdges[static_cast<std::size_t>(e)];
        EXPECT_EQ(edge.axis, e / 4);
        EXPECT_EQ(edge.upperCorner - edge.lowerCorner, 1 << edge.axis);
        const int lowBit = edge.axis == 0 ? 1 : 0, highBit = edge.axis == 2 ? 1 : 2; // the other two axes
        EXPECT_EQ(edge.lowerCorner >> lowBit & 1, e & 1);
        EXPECT_EQ(edge.lowerCorner >> highBit & 1, e >> 1 & 1);
    }
}

TEST(CaseTable, UsesExactlyTheActiveEdges) {
    for (int c = 0; c < 256; ++c) {
        const CellCase& cell = caseTable()[static_cast<std::size_t>(c)];
        unsigned active = 0, used = 0;
        for (int e = 0; e < 12; ++e)
            active |= static_cast<unsigned>(isAboveIn(c, kCellEdges[e].lowerCorner) != isAboveIn(c, kCellEdges[e].upperCorner)) << e;
        for (std::size_t k = 0; k < 3u * cell.triangleCount; ++k)
            used |= 1u << cell.edges[k];
        EXPECT_EQ(cell.edgeMask, active) << c;
        EXPECT_EQ(used, active) << c;
        EXPECT_LE(cell.triangleCount, 5);
        EXPECT_EQ(cell.triangleCount == 0, c == 0 || c == 255);
    }
}

TEST(CaseTable, DrawsEveryDirectedEdgeOnceAndNoDiagonalInAFace) {
    for (int c = 0; c < 256; ++c) {
        const auto edges = directedEdges(c);
        const std::set<Segment> distinct(edges.begin(), edges.end());
        EXPECT_EQ(distinct.size(), edges.size()) << "case " << c;
        for (const auto& [from, to] : edges) {
            const bool isInner = distinct.contains({to, from});
            EXPECT_NE(isInner, shareFace(from, to)) << "case " << c << ": " << (isInner ? "diagonal in a face" : "hole inside the cell");
        }
        // Closed loops: as many segments arrive at each edge as leave it, one each.
        std::map<int, int> leaves, arrives;
        for (const auto& [from, to] : boundary(c)) {
            ++leaves[from];
            ++arrives[to];
        }
        for (int e = 0; e < 12; ++e) {
            const int expected = caseTable()[static_cast<std::size_t>(c)].edgeMask >> e & 1;
            EXPECT_EQ(leaves[e], expected) << "case " << c;
            EXPECT_EQ(arrives[e], expected) << "case " << c;
        }
    }
}

// Two cells with a common face draw the same segments there, one the other way round.
TEST(CaseTable, NeighboursCloseTheirCommonFace) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto onSide = [&](int caseIndex, float side) {
            std::set<Segment> segments;
            for (const Segment& s : boundary(caseIndex))
                if (middle(s.first)[axis] == side && middle(s.second)[axis] == side)
                    segments.insert(s);
            return segments;
        };
        const auto lowered = [&](const std::set<Segment>& segments) { // names on the lower face
            std::set<Segment> out;
            const auto opposite = [&](int e) {
                glm::vec3 p = middle(e);
                p[axis] = 0.0f;
                for (int other = 0; other < 12; ++other)
                    if (middle(other) == p)
                        return other;
                return -1;
            };
            for (const Segment& s : segments)
                out.insert({opposite(s.first), opposite(s.second)});
            return out;
        };
        std::vector<std::set<Segment>> lower, upper;
        for (int c = 0; c < 256; ++c) {
            lower.push_back(onSide(c, 0.0f));
            upper.push_back(lowered(onSide(c, 1.0f)));
        }
        for (int a = 0; a < 256; ++a)
            for (int b = 0; b < 256; ++b) {
                bool fits = true;
                for (int c = 0; c < 8; ++c)
                    if (!(c >> axis & 1))
                        fits = fits && isAboveIn(b, c) == isAboveIn(a, c | 1 << axis);
                if (fits) {
                    ASSERT_EQ(lower[static_cast<std::size_t>(b)], reversed(upper[static_cast<std::size_t>(a)])) << a << " beside " << b;
                }
            }
    }
}

TEST(CaseTable, TurnsWithTheCell) {
    for (int turnAxis = 0; turnAxis < 3; ++turnAxis) {
        const auto turn = [&](glm::vec3 p) {
            const int u = (turnAxis + 1) % 3, v = (turnAxis + 2) % 3;
            const float pu = p[u];
            p[u] = 1.0f - p[v];
            p[v] = pu;
            return p;
        };
        std::array<int, 8> cornerTo;
        std::array<int, 12> edgeTo;
        for (int c = 0; c < 8; ++c)
            for (int d = 0; d < 8; ++d)
                if (turn(corner(c)) == corner(d))
                    cornerTo[static_cast<std::size_t>(c)] = d;
        for (int e = 0; e < 12; ++e)
            for (int d = 0; d < 12; ++d)
                if (turn(middle(e)) == middle(d))
                    edgeTo[static_cast<std::size_t>(e)] = d;
        for (int c = 0; c < 256; ++c) {
            int turned = 0;
            for (int k = 0; k < 8; ++k)
                turned |= isAboveIn(c, k) << cornerTo[static_cast<std::size_t>(k)];
            std::set<Segment> expected;
            for (const Segment& s : boundary(c))
                expected.insert({edgeTo[static_cast<std::size_t>(s.first)], edgeTo[static_cast<std::size_t>(s.second)]});
            ASSERT_EQ(boundary(turned), expected) << "case " << c;
            EXPECT_EQ(caseTable()[static_cast<std::size_t>(turned)].triangleCount, caseTable()[static_cast<std::size_t>(c)].triangleCount);
        }
    }
}

TEST(CaseTable, ComplementFacesTheOtherWay) {
    int compared = 0;
    for (int c = 0; c < 256; ++c) {
        if (hasAmbiguousFace(c))
            continue;
        ++compared;
        EXPECT_EQ(boundary(255 - c), reversed(boundary(c))) << "case " << c;
    }
    EXPECT_GT(compared, 100);
}

TEST(CaseTable, FacesTowardsBelow) {
    for (int above = 0; above < 8; ++above)
        for (const bool isComplement : {false, true}) {
            const int c = isComplement ? 255 - (1 << above) : 1 << above;
            const CellCase& cell = caseTable()[static_cast<std::size_t>(c)];
            ASSERT_EQ(cell.triangleCount, 1);
            const glm::vec3 a = middle(cell.edges[0]), b = middle(cell.edges[1]), d = middle(cell.edges[2]);
            const float side = glm::dot(glm::cross(b - a, d - a), corner(above) - a);
            EXPECT_GT(isComplement ? side : -side, 0.0f) << "case " << c;
        }
}

TEST(CaseTable, PairsOfCornersHaveTheirCounts) {
    for (int a = 0; a < 8; ++a)
        for (int b = 0; b < a; ++b) {
            const int pair = 1 << a | 1 << b;
            const int distance = std::popcount(static_cast<unsigned>(a ^ b));
            // Above: two corners apart even on an ambiguous face. Below: joined there, over four triangles.
            EXPECT_EQ(caseTable()[static_cast<std::size_t>(pair)].triangleCount, 2);
            EXPECT_EQ(caseTable()[static_cast<std::size_t>(255 - pair)].triangleCount, distance == 2 ? 4 : 2);
        }
}

TEST(CaseTable, FindsTheCaseFromTheActiveEdges) {
    std::set<unsigned> masks;
    for (int c = 0; c < 256; ++c) {
        const std::uint16_t mask = caseTable()[static_cast<std::size_t>(c)].edgeMask;
        masks.insert(mask);
        const int solved = caseFromEdgeMask()[mask];
        EXPECT_TRUE(solved == c || solved == 255 - c) << c;
        EXPECT_EQ(solved & 1, 0) << "corner 0 is below";
    }
    EXPECT_EQ(masks.size(), 128u);
    for (unsigned mask = 0; mask < 4096; ++mask)
        EXPECT_EQ(isEdgeMask(static_cast<std::uint16_t>(mask)), masks.contains(mask)) << mask;
    EXPECT_FALSE(isEdgeMask(0xffff));
}

} // namespace
} // namespace isoslider::extract
