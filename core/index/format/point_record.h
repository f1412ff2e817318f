#pragma once

#include <cstdint>

#include "core/grid/brick_grid.h"

namespace isoslider::index {

/// The six edges at a grid point: 2 * axis + (1 if the far end lies upwards along the axis).
inline constexpr int kPointEdges = 6;

/// What a record states. Of a point: the edges at it. Where cells are merged (PAPER 2.2), besides: that an edge of the
/// grid carries a vertex on a leaf edge of some level, or that a merged cell is a leaf, from one key to another. Of
/// such an interval each end has a record, and the other end is the first of its entries.
namespace record_form {
inline constexpr std::uint8_t kPoint = 0;
inline constexpr int kLevels = 4; ///< of leaf edges: 0 to 3
inline constexpr std::uint8_t kEdges = 1, kLeaves = kEdges + 3 * kLevels, kEnd = kLeaves + kLevels - 1;

constexpr std::uint8_t edge(int axis, int level) { return static_cast<std::uint8_t>(kEdges + axis + 3 * level); }
constexpr std::uint8_t leaf(int level) { return static_cast<std::uint8_t>(kLeaves + level - 1); }
constexpr bool isEdge(std::uint8_t form) { return form >= kEdges && form < kLeaves; }
constexpr int axisOf(std::uint8_t form) { return (form - kEdges) % 3; }
constexpr int levelOf(std::uint8_t form) { return isEdge(form) ? (form - kEdges) / 3 : form - kLeaves + 1; }

/// Entries of an edge on a leaf edge: the interval's other end, then the leaf edge's lower and upper end.
inline constexpr int kOtherEnd = 1, kLowerEnd = 3, kUpperEnd = 5;
constexpr std::uint8_t maskOf(std::uint8_t form) {
    return isEdge(form) ? 1u << kOtherEnd | 1u << kLowerEnd | 1u << kUpperEnd : 1u << kOtherEnd;
}
} // namespace record_form

/// What a block stores for one grid point p_j: its scalar, and for each of its edges in the block the far end's scalar
/// (PAPER 2: E+, E-, S+, S-). An edge belongs to E+ when the far scalar is greater (active just above p_j), to E- when
/// it is smaller. Edges between equal scalars are never active and appear nowhere. Key: see scalar_key.h.
///
/// DEVIATION from the paper, 2: there, records hold normals too, and scalars and normals of far ends. A point has up to
/// six of them and stands at several levels, so they were four fifths of an index. The samples, which are stored once,
/// give them; of an edge a page states in which direction it goes (FarEnds).
///
/// Of another form (record_form): `id` is the edge's lower point, or the merged cell's first one.
template <class Key>
struct PointRecord {
    Key key = 0;
    std::uint32_t idLow = 0;
    std::uint16_t idHigh = 0;
    std::uint8_t edgeMask = 0; ///< bit e: edge e is in the block
    std::uint8_t form = record_form::kPoint;
    Key farKeys[kPointEdges] = {};

    PointId id() const { return PointId(std::uint64_t{idLow} | std::uint64_t{idHigh} << 32); }
    void setId(PointId id) {
        idLow = static_cast<std::uint32_t>(id.number());
        idHigh = static_cast<std::uint16_t>(id.number() >> 32);
    }
};

/// What a page states of far ends. Whoever walks needs no more than directions, and of edges the samples give the rest.
enum class FarEnds : std::uint8_t {
    Keys, ///< their keys
    Directions, ///< of points only whether they are greater; of other forms their keys
};

/// The mask without edges whose far end lies in [begin, end): those are redundant in a block with
/// that isovalue interval, both activated and deactivated inside (PAPER 2.1).
template <class Key>
inline std::uint8_t maskWithoutRedundant(const PointRecord<Key>& record, std::uint64_t begin, std::uint64_t end) {
    if (record.form != record_form::kPoint) {
        const std::uint64_t other = record.farKeys[record_form::kOtherEnd];
        return other >= begin && other < end ? 0 : record.edgeMask;
    }
    std::uint8_t mask = 0;
    for (int e = 0; e < kPointEdges; ++e) {
        const std::uint64_t far = record.farKeys[e];
        mask |= static_cast<std::uint8_t>((far < begin || far >= end) << e);
    }
    return mask & record.edgeMask;
}

} // namespace isoslider::index
