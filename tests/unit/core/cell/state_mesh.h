#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/cell/cell_states.h"

namespace isoslider::cell {

using DirectedEdge = std::pair<int, int>;

/// What can be said of a state, for failure messages.
inline std::string describe(const CellState& state) {
    static constexpr const char* kTunnels[] = {"none", "above", "below"};
    return "signs " + std::to_string(state.signs) + ", joined faces " + std::to_string(state.joinedFaces) +
           ", tunnel " + kTunnels[static_cast<int>(state.tunnel)] + ", diagonal " + std::to_string(state.diagonal);
}

/// Segments of a face as the border of the cell's surface, from the face's own signs and bit: the corners
/// of a cut-off run are above on the segment's right, seen from outside the cell.
inline std::vector<DirectedEdge> segmentsOf(int face, unsigned signs, bool isJoined) {
    const auto& corners = kFaceCorners[static_cast<std::size_t>(face)];
    const auto isAbove = [&](int k) { return (signs >> corners[static_cast<std::size_t>(k & 3)] & 1u) != 0; };
    const auto edge = [&](int k) {
        return edgeBetween(corners[static_cast<std::size_t>(k & 3)], corners[static_cast<std::size_t>((k + 1) & 3)]);
    };
    std::vector<DirectedEdge> segments;
    const bool isAmbiguous = isAbove(0) == isAbove(2) && isAbove(1) == isAbove(3) && isAbove(0) != isAbove(1);
    if (isAmbiguous) {
        for (int k = 0; k < 4; ++k) // joined: corners below are cut off, one by one
            if (isAbove(k) != isJoined)
                segments.emplace_back(isJoined ? DirectedEdge(edge(k), edge(k + 3))
                                               : DirectedEdge(edge(k + 3), edge(k)));
        return segments;
    }
    for (int first = 0; first < 4; ++first) {
        if (!isAbove(first) || isAbove(first + 3))
            continue;
        int last = first;
        while (isAbove(last + 1))
            ++last;
        segments.emplace_back(edge(first + 3), edge(last));
    }
    return segments;
}

inline std::vector<DirectedEdge> segmentsOf(const CellState& state) {
    std::vector<DirectedEdge> segments;
    for (int face = 0; face < 6; ++face)
        for (const DirectedEdge& segment : segmentsOf(face, state.signs, (state.joinedFaces >> face & 1) != 0))
            segments.push_back(segment);
    std::sort(segments.begin(), segments.end());
    return segments;
}

using Triangle = std::array<int, 3>;

inline std::vector<Triangle> trianglesOf(const CellState& state) {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i + 2 < state.triangles.size(); i += 3)
        triangles.push_back({state.triangles[i], state.triangles[i + 1], state.triangles[i + 2]});
    return triangles;
}

/// How often each directed edge is used.
inline std::map<DirectedEdge, int> directedEdges(const std::vector<Triangle>& triangles) {
    std::map<DirectedEdge, int> uses;
    for (const Triangle& t : triangles)
        for (std::size_t k = 0; k < 3; ++k)
            ++uses[{t[k], t[(k + 1) % 3]}];
    return uses;
}

/// Directed edges whose opposite no triangle uses, sorted.
inline std::vector<DirectedEdge> borderOf(const std::vector<Triangle>& triangles) {
    const auto uses = directedEdges(triangles);
    std::vector<DirectedEdge> border;
    for (const auto& [edge, count] : uses)
        if (!uses.contains({edge.second, edge.first}))
            border.push_back(edge);
    return border;
}

/// True when both lie on the cell's edges, in one face.
inline bool liesInOneFace(int vertexA, int vertexB) {
    if (vertexA >= kInnerVertex || vertexB >= kInnerVertex)
        return false;
    const auto& faces = facesOfEdges();
    return (faces[static_cast<std::size_t>(vertexA)] & faces[static_cast<std::size_t>(vertexB)]) != 0;
}

/// Follows the next vertex of each until it is back; the number of cycles, or -1 where they do not close.
inline int countCycles(const std::vector<DirectedEdge>& edges) {
    std::map<int, int> next;
    for (const auto& [from, to] : edges)
        if (!next.emplace(from, to).second)
            return -1;
    int cycles = 0;
    while (!next.empty()) {
        const int start = next.begin()->first;
        int at = start;
        do {
            const auto step = next.find(at);
            if (step == next.end())
                return -1;
            at = step->second;
            next.erase(step);
        } while (at != start);
        ++cycles;
    }
    return cycles;
}

/// Pieces that hang together through common edges, each as the set of its vertices.
inline std::vector<std::set<int>> piecesOf(const std::vector<Triangle>& triangles) {
    std::vector<int> piece(triangles.size());
    for (std::size_t i = 0; i < piece.size(); ++i)
        piece[i] = static_cast<int>(i);
    const auto shareEdge = [&](const Triangle& a, const Triangle& b) {
        return std::count_if(a.begin(), a.end(), [&](int v) { return std::find(b.begin(), b.end(), v) != b.end(); }) >
               1;
    };
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = i + 1; j < triangles.size(); ++j)
            if (piece[i] != piece[j] && shareEdge(triangles[i], triangles[j]))
                std::replace(piece.begin(), piece.end(), piece[j], piece[i]);
    std::map<int, std::set<int>> vertices;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        vertices[piece[i]].insert(triangles[i].begin(), triangles[i].end());
    std::vector<std::set<int>> pieces;
    for (auto& [number, set] : vertices)
        pieces.push_back(std::move(set));
    return pieces;
}

} // namespace isoslider::cell
