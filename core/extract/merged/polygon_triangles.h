#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

namespace isoslider::extract {

/// A corner of a merged cell's polygon.
struct PolygonCorner {
    glm::vec3 position;
    std::uint8_t faces = 0; ///< bit f: it lies in face f of the cell
};

/// The polygon of a cell with one loop, by its signs: the edges of its corners, and its triangles by numbers of those.
struct CellPolygon {
    std::uint8_t edgeCount = 0, triangleCount = 0;
    std::array<std::uint8_t, 12> edges{};
    std::array<std::array<std::uint32_t, 3>, 5> triangles{};
};
/// By signs; of ambiguous signs, whatever.
const std::array<CellPolygon, 256>& cellPolygons();

/// The triangulation of least area without a diagonal between corners of one face: such an edge could be one of the
/// neighbour's mesh, too. Three corner numbers each, in the order of the corners. Empty where there is none; then the
/// polygon is to be spanned from a vertex inside the cell. O(k^3) time, O(k^2) memory, kept for the next polygon.
class PolygonTriangulation {
public:
    /// REQUIRES: at least three corners.
    void make(std::span<const PolygonCorner> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

private:
    // Rows are whole vectors, and one vector more.
    std::vector<float> least_; ///< by i and j: of the polygon i, i + 1, ..., j
    std::vector<float> leastTo_; ///< the same by j and i
    std::vector<float> x_, y_, z_; ///< of the corners
    std::vector<std::uint32_t> apex_; ///< by i and j: of the polygon's triangle on the side from i to j
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open_;
};

} // namespace isoslider::extract
