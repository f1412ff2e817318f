#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include <glm/vec3.hpp>

#include "core/extract/edge_interpolation.h"
#include "core/extract/live/brick_bits.h"
#include "core/grid/normal_codec.h"

namespace isoslider::extract {

/// What is kept of a vertex inside a cell, for it is a function of no edge.
struct InnerRecord {
    glm::vec3 place; ///< in cells from the brick's first grid point
    NormalCode normal = 0;
    std::uint16_t level = 0; ///< of the cell
};
static_assert(sizeof(InnerRecord) == 16);

/// A mesh vertex of a live brick with all that it is made from: what does not change while the isovalue slides between
/// the scalars of its edge. Position and normal are functions of the record and the isovalue (vertexOf()); a vertex
/// shader evaluates the same formula. Records are read from a brick's codes and points where they are wanted; some
/// surfaces keep those of vertices on edges, too, a column per field (VertexGroup in vertex_kernels.h).
///
/// Two kinds. On an active edge: its place, the scalars and quantised normals at both ends; beside merged cells, at the
/// ends of the leaf edge of 2^level cells that contains the active edge. Inside a cell (few have such vertices): the
/// position itself, in cells from the brick's first grid point.
template <class Live>
struct EdgeRecord {
    ClosedEdge edge{}; ///< for a vertex inside a cell kInside + the cell's level
    std::uint16_t levelOrUpperZ = 0; ///< of the leaf edge; inside: upper half of z as bits of a float
    NormalCode normal1 = 0; ///< at the edge's lower grid point; inside: the normal
    NormalCode normal2 = 0; ///< at its upper one; inside: lower half of z
    Live scalar1{}, scalar2{}; ///< at the lower and upper grid point; inside: x and y

    static constexpr ClosedEdge kInside{3 << kEdgeAxisShift};

    bool isInside() const { return edge >= kInside; }
    static EdgeRecord inside(const InnerRecord& inner) {
        const auto z = std::bit_cast<std::uint32_t>(inner.place.z);
        return {kInside + inner.level,
                static_cast<std::uint16_t>(z >> 16),
                inner.normal,
                static_cast<NormalCode>(z & 0xffff),
                static_cast<Live>(inner.place.x),
                static_cast<Live>(inner.place.y)};
    }
    glm::vec3 insidePlace() const {
        return {static_cast<float>(scalar1), static_cast<float>(scalar2),
                std::bit_cast<float>(static_cast<std::uint32_t>(levelOrUpperZ) << 16 | normal2)};
    }
};

static_assert(sizeof(EdgeRecord<float>) == 16 && sizeof(EdgeRecord<double>) == 24);

struct MeshVertex {
    glm::vec3 position; ///< grid index units
    glm::vec3 normal; ///< unit, along the grid's axes, towards lower scalars
};

/// `origin`: grid coordinates of the brick's first point.
template <class Live>
inline MeshVertex vertexOf(const EdgeRecord<Live>& record, const std::array<std::int32_t, 3>& origin, Live isovalue) {
    const glm::vec3 first(static_cast<float>(origin[0]), static_cast<float>(origin[1]), static_cast<float>(origin[2]));
    if (record.isInside())
        return {first + record.insidePlace(), decodeNormal(record.normal1)};
    const int axis = axisOf(record.edge);
    const int side = 1 << record.levelOrUpperZ;
    auto place = coordsOf(startOf(record.edge));
    place[static_cast<std::size_t>(axis)] &=
        ~(side - 1); // of the leaf edge: leaf edges are aligned at multiples of their length
    const float t = static_cast<float>(edgeFraction<Live>(record.scalar1, record.scalar2, isovalue));
    glm::vec3 position(first.x + static_cast<float>(place[0]), first.y + static_cast<float>(place[1]),
                       first.z + static_cast<float>(place[2]));
    position[axis] += t * static_cast<float>(side);
    return {position, edgeNormal(record.normal1, record.normal2, t, axis, record.scalar1 < record.scalar2)};
}

} // namespace isoslider::extract
