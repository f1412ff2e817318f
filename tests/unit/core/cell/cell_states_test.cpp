#include "core/cell/cell_states.h"

#include <gtest/gtest.h>

#include "tests/unit/core/cell/state_mesh.h"

namespace isoslider::cell {
namespace {

class EveryState : public testing::Test {
protected:
    template <class Check>
    static void forEach(Check&& check) {
        const auto states = cellStates();
        ASSERT_GE(states.size(), 768u);
        for (std::size_t i = 0; i < states.size() && !HasFatalFailure(); ++i) {
            SCOPED_TRACE("state " + std::to_string(i) + ": " + describe(states[i]));
            check(states[i]);
        }
    }
};

TEST_F(EveryState, NamesOnlyVerticesThatItHasAndUsesAll) {
    forEach([](const CellState& state) {
        ASSERT_EQ(state.triangles.size(), 3u * state.triangleCount);
        EXPECT_LE(state.triangleCount, kMaxStateTriangles);
        const bool hasTunnel = state.tunnel != Tunnel::None;
        EXPECT_EQ(state.innerVertices, (hasTunnel ? 6 : 0) + static_cast<int>(state.centres.size()));
        std::set<int> used(state.triangles.begin(), state.triangles.end()), expected;
        for (int e = 0; e < 12; ++e)
            if ((activeEdges(state.signs) >> e & 1) != 0)
                expected.insert(e);
        for (int k = 0; k < state.innerVertices; ++k)
            expected.insert(kInnerVertex + k);
        EXPECT_EQ(used, expected);
    });
}

TEST_F(EveryState, IsFoundByItsDecisions) {
    forEach([](const CellState& state) {
        EXPECT_EQ(state.joinedFaces & ~ambiguousFaces(state.signs), 0);
        const StateId id = stateOf(state.signs, state.joinedFaces, state.tunnel, state.diagonal);
        ASSERT_LT(id, cellStates().size());
        const CellState& found = cellStates()[id];
        EXPECT_EQ(describe(found), describe(state));
        if (!isAmbiguous(state.signs)) {
            EXPECT_EQ(id, state.signs);
        }
    });
}

TEST_F(EveryState, RepeatsNoVertexAndNoTriangle) {
    forEach([](const CellState& state) {
        std::set<std::set<int>> seen;
        for (const Triangle& t : trianglesOf(state)) {
            const std::set<int> vertices(t.begin(), t.end());
            EXPECT_EQ(vertices.size(), 3u);
            EXPECT_TRUE(seen.insert(vertices).second) << t[0] << " " << t[1] << " " << t[2];
        }
    });
}

// Each directed edge once: at most two triangles an edge, turning the same way. What is left open is what
// each face asks for by itself, in the direction that has above on the right seen from outside.
TEST_F(EveryState, HasTheFacesSegmentsAsItsOnlyBorder) {
    forEach([](const CellState& state) {
        const auto triangles = trianglesOf(state);
        for (const auto& [edge, uses] : directedEdges(triangles))
            EXPECT_EQ(uses, 1) << edge.first << " to " << edge.second;
        EXPECT_EQ(borderOf(triangles), segmentsOf(state));
    });
}

TEST_F(EveryState, DrawsNothingInAFaceButItsSegments) {
    forEach([](const CellState& state) {
        const auto segments = segmentsOf(state);
        for (const auto& [edge, uses] : directedEdges(trianglesOf(state)))
            if (liesInOneFace(edge.first, edge.second)) {
                EXPECT_TRUE(std::binary_search(segments.begin(), segments.end(), edge))
                    << edge.first << " to " << edge.second;
            }
    });
}

TEST_F(EveryState, HasTheLoopsPiecesAndEulerNumberItStates) {
    forEach([](const CellState& state) {
        const auto triangles = trianglesOf(state);
        std::set<std::pair<int, int>> edges;
        for (const auto& [edge, uses] : directedEdges(triangles))
            edges.insert(std::minmax(edge.first, edge.second));
        const std::set<int> vertices(state.triangles.begin(), state.triangles.end());
        const int euler =
            static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(triangles.size());
        const int loops = countCycles(segmentsOf(state));
        EXPECT_EQ(loops, state.loops);
        EXPECT_EQ(static_cast<int>(piecesOf(triangles).size()), state.components);
        EXPECT_EQ(state.components, state.loops - (state.tunnel != Tunnel::None ? 1 : 0));
        EXPECT_EQ(euler, 2 * state.components - loops);
    });
}

TEST_F(EveryState, HasOneFanAtEveryVertex) {
    forEach([](const CellState& state) {
        const auto triangles = trianglesOf(state);
        for (const int vertex : std::set<int>(state.triangles.begin(), state.triangles.end())) {
            std::map<int, int> next; // around the vertex
            std::set<int> arrivedAt;
            for (const Triangle& t : triangles)
                for (std::size_t k = 0; k < 3; ++k)
                    if (t[k] == vertex) {
                        next[t[(k + 1) % 3]] = t[(k + 2) % 3];
                        arrivedAt.insert(t[(k + 2) % 3]);
                    }
            int start = next.begin()->first;
            for (const auto& [from, to] : next)
                if (!arrivedAt.contains(from))
                    start = from; // open: at the cell's border
            std::size_t steps = 0;
            for (int at = start; next.contains(at) && steps <= next.size(); at = next[at]) {
                ++steps;
                if (next[at] == start)
                    break;
            }
            EXPECT_EQ(steps, next.size()) << "vertex " << vertex;
        }
    });
}

TEST_F(EveryState, SpansFromACentreOnlyLoopsItNames) {
    forEach([](const CellState& state) {
        const auto triangles = trianglesOf(state);
        const auto pieces = piecesOf(triangles);
        const int first = kInnerVertex + (state.tunnel != Tunnel::None ? 6 : 0);
        for (std::size_t k = 0; k < state.centres.size(); ++k) {
            const int centre = first + static_cast<int>(k);
            const auto piece =
                std::find_if(pieces.begin(), pieces.end(), [&](const auto& p) { return p.contains(centre); });
            ASSERT_NE(piece, pieces.end());
            unsigned edges = 0;
            for (const int vertex : *piece)
                edges |= vertex < kInnerVertex ? 1u << vertex : 0u;
            EXPECT_EQ(edges, state.centres[k].loopEdges);
        }
    });
}

TEST_F(EveryState, HasAWaistOfSixPlacesRoundItsDiagonal) {
    forEach([](const CellState& state) {
        if (state.tunnel == Tunnel::None)
            return;
        EXPECT_LT(state.diagonal, 4);
        std::set<int> places(state.ring.begin(), state.ring.end()), expected;
        for (int corner = 0; corner < 8; ++corner)
            if (corner != state.diagonal && corner != 7 - state.diagonal)
                expected.insert(corner);
        EXPECT_EQ(places, expected);
        EXPECT_NE(mayHaveTunnel(state.signs, state.joinedFaces) & (state.tunnel == Tunnel::Above ? 1u : 2u), 0u);
    });
}

TEST(CellStates, AmbiguousSignsAreThoseWithAnOpenFaceOrAnOpenInside) {
    for (unsigned signs = 0; signs < 256; ++signs) {
        const auto bits = static_cast<std::uint8_t>(signs);
        // Without ambiguous faces only two corners opposite each other leave the inside open.
        bool isOpenInside = false;
        for (unsigned d = 0; d < 4; ++d) {
            const unsigned pair = 1u << d | 1u << (7 - d);
            isOpenInside |= signs == pair || signs == (pair ^ 255u);
        }
        EXPECT_EQ(isAmbiguous(bits), isOpenInside || ambiguousFaces(bits) != 0) << signs;
    }
}

} // namespace
} // namespace isoslider::cell
