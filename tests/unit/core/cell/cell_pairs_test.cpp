// Two cells that share a face: most codes that are right in a cell fail here.

#include <gtest/gtest.h>

#include "tests/unit/core/cell/state_mesh.h"

namespace isoslider::cell {
namespace {

// The four edges of the lower cell's far face and those of the upper cell's near face: the same edges.
std::map<int, int> commonEdges(int axis) {
    std::map<int, int> lowerOf;
    for (int e = 0; e < 12; ++e) {
        const CellEdge& edge = kCellEdges[static_cast<std::size_t>(e)];
        if (edge.axis != axis && (edge.lowerCorner >> axis & 1) == 0)
            lowerOf[e] = edgeBetween(edge.lowerCorner | 1 << axis, edge.upperCorner | 1 << axis);
    }
    return lowerOf;
}

// Signs of the four corners of a face by their place, and its bit.
int faceKey(const CellState& state, int axis, int side) {
    int key = 0, shift = 0;
    for (int corner = 0; corner < 8; ++corner)
        if ((corner >> axis & 1) == side)
            key |= (state.signs >> corner & 1) << shift++;
    return key | (state.joinedFaces >> (2 * axis + side) & 1) << 4;
}

std::vector<DirectedEdge> borderIn(const std::vector<Triangle>& triangles, unsigned face) {
    std::vector<DirectedEdge> border;
    for (const DirectedEdge& edge : borderOf(triangles)) {
        const auto& faces = facesOfEdges();
        const unsigned common =
            edge.first < kInnerVertex && edge.second < kInnerVertex
                ? faces[static_cast<std::size_t>(edge.first)] & faces[static_cast<std::size_t>(edge.second)]
                : 0u;
        if ((common >> face & 1u) != 0)
            border.push_back(edge);
    }
    return border;
}

class FacePairs : public testing::TestWithParam<int> {
protected:
    // The upper cell's vertices after the lower's, but for those on common edges.
    void SetUp() override {
        const auto common = commonEdges(GetParam());
        for (const CellState& state : cellStates()) {
            std::vector<Triangle> triangles = trianglesOf(state);
            lowerBorders_.push_back(borderIn(triangles, static_cast<unsigned>(2 * GetParam() + 1)));
            std::vector<DirectedEdge> border = borderIn(triangles, static_cast<unsigned>(2 * GetParam()));
            lower_.push_back(triangles);
            const auto moved = [&](int vertex) { return common.contains(vertex) ? common.at(vertex) : vertex + 100; };
            for (Triangle& t : triangles)
                t = {moved(t[0]), moved(t[1]), moved(t[2])};
            for (DirectedEdge& edge : border)
                edge = {moved(edge.second), moved(edge.first)}; // turned round, as the lower cell has it
            std::sort(border.begin(), border.end());
            upperBorders_.push_back(border);
            upper_.push_back(std::move(triangles));
        }
    }

    // One use of each direction of an edge at most; triangles within a cell are distinct by other tests.
    void expectWelded(std::size_t below, std::size_t above) const {
        std::set<std::set<int>> triangles;
        std::map<DirectedEdge, int> uses;
        for (const auto* cell : {&lower_[below], &upper_[above]})
            for (const Triangle& t : *cell) {
                ASSERT_TRUE(triangles.insert(std::set<int>(t.begin(), t.end())).second) << "a triangle twice";
                for (std::size_t k = 0; k < 3; ++k) {
                    const int count = ++uses[DirectedEdge(t[k], t[(k + 1) % 3])];
                    ASSERT_EQ(count, 1) << "edge " << t[k] << " to " << t[(k + 1) % 3];
                }
            }
    }

    std::vector<std::vector<Triangle>> lower_, upper_;
    std::vector<std::vector<DirectedEdge>> lowerBorders_, upperBorders_;
};

TEST_P(FacePairs, WeldIntoAManifold) {
    const auto states = cellStates();
    std::map<int, std::vector<std::size_t>> byFarFace, byNearFace;
    for (std::size_t i = 0; i < states.size(); ++i) {
        byFarFace[faceKey(states[i], GetParam(), 1)].push_back(i);
        byNearFace[faceKey(states[i], GetParam(), 0)].push_back(i);
    }
    std::size_t pairs = 0;
    for (const auto& [key, belows] : byFarFace)
        for (const std::size_t below : belows)
            for (const std::size_t above : byNearFace[key]) {
                ++pairs;
                ASSERT_EQ(lowerBorders_[below], upperBorders_[above])
                    << describe(states[below]) << " | " << describe(states[above]);
                // Vertices of different cells are joined in the common face only: nothing else can clash.
                const bool mayClash = key != 0 && key != 15;
                if (mayClash)
                    expectWelded(below, above);
                ASSERT_FALSE(HasFatalFailure()) << describe(states[below]) << " | " << describe(states[above]);
            }
    RecordProperty("pairs", static_cast<int>(pairs));
    EXPECT_GT(pairs, 30000u);
}

INSTANTIATE_TEST_SUITE_P(Axes, FacePairs, testing::Values(0, 1, 2));

} // namespace
} // namespace isoslider::cell
