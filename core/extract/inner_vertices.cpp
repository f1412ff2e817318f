#include "core/extract/inner_vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/grid/gradient.h"

namespace isoslider::extract {
namespace {

// Least distance, in cells, of inner vertices from faces and from each other, so that they stay apart as
// floats.
double leastDistance(const std::array<std::int64_t, 3>& origin) {
    const std::int64_t farthest = std::max({origin[0], origin[1], origin[2]}) + 1;
    return std::max(1.0 / 2048, 4.0 * std::numeric_limits<float>::epsilon() * static_cast<double>(farthest));
}

glm::vec3 unitOr(const glm::vec3& direction, const glm::vec3& otherwise) {
    const glm::vec3 unit = normalizedOrZero(direction);
    return unit == glm::vec3(0.0f) ? otherwise : unit;
}

// In cells from the first point of the cell's brick.
float placeInBrick(std::int64_t origin, double inCell) {
    return static_cast<float>(static_cast<double>(origin & (kBrickSide - 1)) + inCell);
}

void placeWaist(const InnerVertexCell& c, double isovalue, const glm::vec3& inverseSpacing, double least,
                InnerVertex* vertices) {
    const cell::TunnelWaist waist = cell::tunnelWaist(c.scalars, isovalue, least);
    const glm::vec3 fallback =
        c.edgeNormals[static_cast<std::size_t>(std::countr_zero(cell::activeEdges(c.state->signs)))];
    for (std::size_t k = 0; k < 6; ++k) {
        const unsigned corner = c.state->ring[k];
        const double x = waist.x[corner & 1], y = waist.y[corner >> 1 & 1], z = waist.z[corner >> 2];
        vertices[k].place = {placeInBrick(c.origin[0], x), placeInBrick(c.origin[1], y), placeInBrick(c.origin[2], z)};
        const auto gradient = cell::gradientInCell(c.scalars, x, y, z);
        const double length = std::max({std::abs(gradient[0]), std::abs(gradient[1]), std::abs(gradient[2])});
        glm::vec3 direction(0.0f); // scaled, so that its square neither overflows nor vanishes
        if (length > 0.0 && std::isfinite(length))
            for (int a = 0; a < 3; ++a)
                direction[a] = static_cast<float>(-gradient[static_cast<std::size_t>(a)] / length) * inverseSpacing[a];
        vertices[k].normal = encodeNormal(unitOr(direction, fallback));
    }
}

InnerVertex placeCentre(const InnerVertexCell& c, const cell::CellCentre& centre) {
    std::array<glm::vec3, 12> positions, normals;
    std::size_t count = 0;
    for (unsigned edges = centre.loopEdges; edges != 0; edges &= edges - 1, ++count) {
        const auto e = static_cast<std::size_t>(std::countr_zero(edges));
        positions[count] = c.edgePositions[e];
        normals[count] = c.edgeNormals[e];
    }
    return placeLoopCentre({positions.data(), count}, {normals.data(), count}, c.origin, 1);
}

} // namespace

std::span<const std::uint16_t> edgesOfInnerVertices() {
    static const std::vector<std::uint16_t> edges = [] {
        std::vector<std::uint16_t> made;
        for (const cell::CellState& state : cell::cellStates()) {
            unsigned its = 0;
            if (state.tunnel != cell::Tunnel::None) // see placeWaist()
                its = 1u << std::countr_zero(cell::activeEdges(state.signs));
            for (const cell::CellCentre& centre : state.centres)
                its |= centre.loopEdges;
            made.push_back(static_cast<std::uint16_t>(its));
        }
        return made;
    }();
    return edges;
}

InnerVertex placeLoopCentre(std::span<const glm::vec3> positions, std::span<const glm::vec3> normals,
                            const std::array<std::int64_t, 3>& origin, std::int32_t side) {
    const double least = leastDistance(origin);
    glm::vec3 placeSum(0.0f), normalSum(0.0f);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        placeSum += positions[i] - glm::vec3(static_cast<float>(origin[0]), static_cast<float>(origin[1]),
                                             static_cast<float>(origin[2]));
        normalSum += normals[i];
    }
    InnerVertex vertex;
    for (int a = 0; a < 3; ++a) {
        const double inCell =
            std::clamp(static_cast<double>(placeSum[a] / static_cast<float>(positions.size())), least, side - least);
        vertex.place[a] = placeInBrick(origin[static_cast<std::size_t>(a)], inCell);
    }
    vertex.normal = encodeNormal(unitOr(normalSum, normals.front()));
    return vertex;
}

void placeInnerVertices(const InnerVertexCell& cell, double isovalue, const glm::vec3& inverseSpacing,
                        InnerVertex* vertices) {
    const double least = leastDistance(cell.origin);
    std::size_t next = 0;
    if (cell.state->tunnel != cell::Tunnel::None) {
        placeWaist(cell, isovalue, inverseSpacing, least, vertices);
        next = 6;
    }
    for (const cell::CellCentre& centre : cell.state->centres)
        vertices[next++] = placeCentre(cell, centre);
}

} // namespace isoslider::extract
