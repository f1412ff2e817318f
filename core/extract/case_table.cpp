#include "core/extract/case_table.h"

#include <vector>

#include "core/base/check.h"

namespace isoslider::extract {

const std::array<CellEdge, 12> kCellEdges{{{0, 1, 0}, {2, 3, 0}, {4, 5, 0}, {6, 7, 0},
                                           {0, 2, 1}, {1, 3, 1}, {4, 6, 1}, {5, 7, 1},
                                           {0, 4, 2}, {1, 5, 2}, {2, 6, 2}, {3, 7, 2}}};

namespace {

// Corners of each face, counter-clockwise seen from outside: x0 x1 y0 y1 z0 z1.
constexpr int kFaceCorners[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

int edgeBetween(int a, int b) {
    for (int e = 0; e < 12; ++e)
        if ((kCellEdges[e].lowerCorner == a && kCellEdges[e].upperCorner == b) ||
            (kCellEdges[e].lowerCorner == b && kCellEdges[e].upperCorner == a))
            return e;
    checkFailed("corners share an edge", __FILE__, __LINE__);
}

// Bit f: edge lies in face f.
std::array<int, 12> facesOfEdges() {
    std::array<int, 12> faces{};
    for (int f = 0; f < 6; ++f)
        for (int k = 0; k < 4; ++k)
            faces[edgeBetween(kFaceCorners[f][k], kFaceCorners[f][(k + 1) % 4])] |= 1 << f;
    return faces;
}

using Loop = std::vector<int>;

// Where each active edge's outgoing segment leads; -1 for inactive edges.
std::array<int, 12> traceSegments(int caseIndex) {
    std::array<int, 12> next;
    next.fill(-1);
    for (const auto& corners : kFaceCorners) {
        for (int k = 0; k < 4; ++k) {
            const bool above = caseIndex >> corners[k] & 1;
            const bool previousAbove = caseIndex >> corners[(k + 3) % 4] & 1;
            if (!above || previousAbove)
                continue; // not the start of an above run
            int last = k;
            while (caseIndex >> corners[(last + 1) % 4] & 1)
                last = (last + 1) % 4;
            next[edgeBetween(corners[(k + 3) % 4], corners[k])] =
                edgeBetween(corners[last], corners[(last + 1) % 4]);
        }
    }
    return next;
}

std::vector<Loop> loopsOfCase(int caseIndex) {
    const std::array<int, 12> next = traceSegments(caseIndex);
    std::array<bool, 12> visited{};
    std::vector<Loop> loops;
    for (int start = 0; start < 12; ++start) {
        if (next[start] < 0 || visited[start])
            continue;
        Loop loop;
        for (int e = start; !visited[e]; e = next[e]) {
            visited[e] = true;
            loop.push_back(e);
        }
        loops.push_back(loop);
    }
    return loops;
}

// Triangulates loop[first..last], whose edge (first, last) is already there, by trying every apex.
// A diagonal may not join two vertices of one face.
bool triangulate(const Loop& loop, std::size_t first, std::size_t last, const std::array<int, 12>& faces,
                 std::vector<int>& triangles) {
    if (last - first < 2)
        return true;
    const auto isFree = [&](std::size_t a, std::size_t b) {
        return b == a + 1 || (faces[loop[a]] & faces[loop[b]]) == 0;
    };
    for (std::size_t apex = first + 1; apex < last; ++apex) {
        if (!isFree(first, apex) || !isFree(apex, last))
            continue;
        const std::size_t mark = triangles.size();
        triangles.insert(triangles.end(), {loop[first], loop[apex], loop[last]});
        if (triangulate(loop, first, apex, faces, triangles) && triangulate(loop, apex, last, faces, triangles))
            return true;
        triangles.resize(mark);
    }
    return false;
}

std::array<CellCase, 256> buildCaseTable() {
    std::array<CellCase, 256> table{};
    const std::array<int, 12> faces = facesOfEdges();
    for (int caseIndex = 0; caseIndex < 256; ++caseIndex) {
        CellCase& cell = table[caseIndex];
        for (int e = 0; e < 12; ++e)
            if ((caseIndex >> kCellEdges[e].lowerCorner & 1) != (caseIndex >> kCellEdges[e].upperCorner & 1))
                cell.edgeMask |= static_cast<std::uint16_t>(1u << e);
        std::vector<int> triangles;
        for (const Loop& loop : loopsOfCase(caseIndex))
            ISO_CHECK(triangulate(loop, 0, loop.size() - 1, faces, triangles));
        ISO_CHECK(triangles.size() <= cell.edges.size());
        cell.triangleCount = static_cast<std::uint8_t>(triangles.size() / 3);
        for (std::size_t i = 0; i < triangles.size(); ++i)
            cell.edges[i] = static_cast<std::uint8_t>(triangles[i]);
    }
    return table;
}

} // namespace

const std::array<CellCase, 256>& caseTable() {
    static const std::array<CellCase, 256> table = buildCaseTable();
    return table;
}

const std::array<std::uint8_t, 4096>& caseFromEdgeMask() {
    static const std::array<std::uint8_t, 4096> table = [] {
        std::array<std::uint8_t, 4096> cases{};
        for (int caseIndex = 0; caseIndex < 256; caseIndex += 2) // even: corner 0 is below
            cases[caseTable()[caseIndex].edgeMask] = static_cast<std::uint8_t>(caseIndex);
        return cases;
    }();
    return table;
}

bool isEdgeMask(std::uint16_t mask) {
    return mask == 0 || (mask < 4096 && caseFromEdgeMask()[mask] != 0);
}

} // namespace isoslider::extract
