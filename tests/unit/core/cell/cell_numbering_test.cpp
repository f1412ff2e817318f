#include "core/cell/cell_numbering.h"

#include <bit>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

namespace isoslider::cell {
namespace {

glm::ivec3 cornerPlace(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2 & 1}; }

TEST(CellNumbering, EdgesJoinNeighboursAlongTheirAxis) {
    unsigned seen = 0;
    for (int e = 0; e < 12; ++e) {
        const CellEdge& edge = kCellEdges[static_cast<std::size_t>(e)];
        EXPECT_EQ(edge.axis, e / 4);
        EXPECT_EQ(edge.upperCorner, edge.lowerCorner | 1 << edge.axis);
        EXPECT_NE(edge.upperCorner, edge.lowerCorner);
        EXPECT_EQ(edgeBetween(edge.lowerCorner, edge.upperCorner), e);
        EXPECT_EQ(edgeBetween(edge.upperCorner, edge.lowerCorner), e);
        // The place across: the two other axes, lower one first.
        const glm::ivec3 p = cornerPlace(edge.lowerCorner);
        const int first = edge.axis == 0 ? 1 : 0, second = edge.axis == 2 ? 1 : 2;
        EXPECT_EQ(e % 4, p[first] + 2 * p[second]);
        seen |= 1u << e;
    }
    EXPECT_EQ(seen, 0xfffu);
}

TEST(CellNumbering, FacesTurnCounterClockwiseSeenFromOutside) {
    for (int face = 0; face < 6; ++face) {
        const auto& corners = kFaceCorners[static_cast<std::size_t>(face)];
        glm::ivec3 outwards(0);
        outwards[face / 2] = face % 2 == 0 ? -1 : 1;
        for (std::size_t k = 0; k < 4; ++k) {
            const glm::ivec3 a = cornerPlace(corners[k]), b = cornerPlace(corners[(k + 1) % 4]),
                             c = cornerPlace(corners[(k + 2) % 4]);
            EXPECT_EQ(a[face / 2], face % 2);
            const glm::dvec3 turn = glm::cross(glm::dvec3(b - a), glm::dvec3(c - b));
            EXPECT_EQ(turn, glm::dvec3(outwards)) << "face " << face << " corner " << k;
        }
    }
}

TEST(CellNumbering, EveryEdgeLiesInTheTwoFacesOfBothItsEnds) {
    for (std::size_t e = 0; e < 12; ++e) {
        unsigned expected = 0;
        for (unsigned face = 0; face < 6; ++face) {
            const auto isIn = [&](unsigned corner) { return (corner >> face / 2 & 1u) == face % 2; };
            if (isIn(kCellEdges[e].lowerCorner) && isIn(kCellEdges[e].upperCorner))
                expected |= 1u << face;
        }
        EXPECT_EQ(facesOfEdges()[e], expected);
        EXPECT_EQ(std::popcount(expected), 2);
    }
}

TEST(CellNumbering, ActiveEdgesAreThoseWhoseEndsDifferInSign) {
    for (unsigned signs = 0; signs < 256; ++signs) {
        unsigned expected = 0;
        for (unsigned e = 0; e < 12; ++e)
            expected |= ((signs >> kCellEdges[e].lowerCorner ^ signs >> kCellEdges[e].upperCorner) & 1u) << e;
        const std::uint16_t mask = activeEdges(static_cast<std::uint8_t>(signs));
        ASSERT_EQ(mask, expected) << signs;
    }
}

TEST(CellNumbering, AmbiguousFacesHaveAlternatingCorners) {
    for (unsigned signs = 0; signs < 256; ++signs) {
        unsigned expected = 0;
        for (unsigned face = 0; face < 6; ++face) {
            unsigned changes = 0;
            const auto& c = kFaceCorners[face];
            for (unsigned k = 0; k < 4; ++k)
                changes += (signs >> c[k] ^ signs >> c[(k + 1) % 4]) & 1u;
            if (changes == 4)
                expected |= 1u << face;
        }
        EXPECT_EQ(ambiguousFaces(static_cast<std::uint8_t>(signs)), expected) << signs;
    }
}

} // namespace
} // namespace isoslider::cell
