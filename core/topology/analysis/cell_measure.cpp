#include "core/topology/analysis/cell_measure.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace isoslider::topology {

CellMeasure::CellMeasure(const GridGeometry& geometry) {
    const glm::dmat3 toWorld =
        geometry.direction * glm::dmat3(geometry.spacing.x, 0, 0, 0, geometry.spacing.y, 0, 0, 0, geometry.spacing.z);
    gradientToWorld_ = glm::transpose(glm::inverse(toWorld));
    areaToWorld_ = glm::determinant(toWorld) * gradientToWorld_;
    for (std::size_t e = 0; e < cell::kCellEdges.size(); ++e) {
        const unsigned corner = cell::kCellEdges[e].lowerCorner;
        places_[e] = {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
    }
}

CellSum CellMeasure::at(const cell::CornerScalars& scalars, const cell::CellState& state, double isovalue) {
    for (unsigned edges = cell::activeEdges(state.signs); edges != 0; edges &= edges - 1) {
        const auto e = static_cast<std::size_t>(std::countr_zero(edges));
        const auto& edge = cell::kCellEdges[e];
        const double a = scalars[edge.lowerCorner], b = scalars[edge.upperCorner];
        places_[e][edge.axis] = (isovalue - a) / (b - a); // the others are those of the edge
    }
    if (state.innerVertices > 0)
        placeInner(scalars, state, isovalue);
    CellSum sum;
    glm::dvec3 middle{0.0};
    for (std::size_t t = 0; t < state.triangles.size(); t += 3) {
        const glm::dvec3 &a = places_[state.triangles[t]], &b = places_[state.triangles[t + 1]],
                         &c = places_[state.triangles[t + 2]];
        const glm::dvec3 normal = glm::cross(b - a, c - a); // twice as long as the triangle is large
        const glm::dvec3 corners = a + b + c;
        sum.area += glm::length(areaToWorld_ * normal);
        // Of the field (x, 0, 0) through the triangle, which is wound so that it faces what is below.
        sum.volume += normal.x * corners.x;
        middle += corners;
    }
    sum.area *= 0.5;
    sum.volume = sum.volume / 6.0 + areaAboveOnFace(state);
    middle /= std::max<double>(1.0, static_cast<double>(state.triangles.size()));
    const auto gradient = cell::gradientInCell(scalars, middle.x, middle.y, middle.z);
    sum.gradient = sum.area * glm::length(gradientToWorld_ * glm::dvec3(gradient[0], gradient[1], gradient[2]));
    return sum;
}

// Of the unit square beyond a cell at x = 1: how much is above, within the mesh's segments.
double CellMeasure::areaAboveOnFace(const cell::CellState& state) const {
    constexpr unsigned kFace = 1;
    // Of corner i of the face, at (i & 1, i >> 1) in y and z: the triangle between it and its two edges' vertices.
    const auto triangle = [this](unsigned corner) {
        const double y = places_[(corner & 2) != 0 ? 7 : 5].y, z = places_[(corner & 1) != 0 ? 11 : 9].z;
        return 0.5 * ((corner & 1) != 0 ? 1.0 - y : y) * ((corner & 2) != 0 ? 1.0 - z : z);
    };
    const unsigned above = (state.signs >> 1 & 1u) | (state.signs >> 3 & 1u) << 1 | (state.signs >> 5 & 1u) << 2 |
                           (state.signs >> 7 & 1u) << 3;
    switch (above) {
        case 0: return 0.0;
        case 15: return 1.0;
        case 3: return 0.5 * (places_[9].z + places_[11].z);
        case 12: return 1.0 - 0.5 * (places_[9].z + places_[11].z);
        case 5: return 0.5 * (places_[5].y + places_[7].y);
        case 10: return 1.0 - 0.5 * (places_[5].y + places_[7].y);
        default: break;
    }
    const bool isJoined = std::popcount(above) == 3 || (state.joinedFaces >> kFace & 1) != 0;
    const unsigned cut = isJoined ? ~above & 15u : above; // corners that triangles part from the rest
    double area = 0.0;
    for (unsigned corner = 0; corner < 4; ++corner)
        area += (cut >> corner & 1u) != 0 ? triangle(corner) : 0.0;
    return isJoined ? 1.0 - area : area;
}

void CellMeasure::placeInner(const cell::CornerScalars& scalars, const cell::CellState& state, double isovalue) {
    std::size_t inner = cell::kInnerVertex;
    if (state.tunnel != cell::Tunnel::None) {
        const cell::TunnelWaist waist = cell::tunnelWaist(scalars, isovalue, 1.0 / 2048.0);
        for (const std::uint8_t corner : state.ring)
            places_[inner++] = {waist.x[corner & 1], waist.y[corner >> 1 & 1], waist.z[corner >> 2 & 1]};
    }
    for (const cell::CellCentre& centre : state.centres) {
        glm::dvec3 sum{0.0};
        for (unsigned edges = centre.loopEdges; edges != 0; edges &= edges - 1)
            sum += places_[static_cast<std::size_t>(std::countr_zero(edges))];
        places_[inner++] = sum / static_cast<double>(std::popcount(centre.loopEdges));
    }
}

} // namespace isoslider::topology
