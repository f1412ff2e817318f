#pragma once

#include <cstdint>

#include "core/grid/brick_grid.h"
#include "core/grid/normal_codec.h"

namespace isoslider::index {

/// The six edges at a grid point: 2 * axis + (1 if the far end lies upwards along the axis).
inline constexpr int kPointEdges = 6;

/// What a block stores for one grid point p_j: its scalar and normal, and for each of its edges in
/// the block the far end's scalar and normal (PAPER 2: E+, E-, S+, S-). An edge belongs to
/// E+ when the far scalar is greater (active just above p_j), to E- when it is smaller. Edges between
/// equal scalars are never active and appear nowhere. Key: see scalar_key.h.
template <class Key>
struct PointRecord {
    Key key = 0;
    std::uint32_t idLow = 0;
    std::uint16_t idHigh = 0;
    NormalCode normal = kNoNormal;
    std::uint8_t edgeMask = 0; ///< bit e: edge e is in the block
    std::uint8_t reserved = 0;
    NormalCode farNormals[kPointEdges] = {};
    Key farKeys[kPointEdges] = {};

    PointId id() const { return PointId(std::uint64_t{idLow} | std::uint64_t{idHigh} << 32); }
    void setId(PointId id) {
        idLow = static_cast<std::uint32_t>(id.number());
        idHigh = static_cast<std::uint16_t>(id.number() >> 32);
    }
};

/// The mask without edges whose far end lies in [begin, end): those are redundant in a block with
/// that isovalue interval, both activated and deactivated inside (PAPER 2.1).
template <class Key>
inline std::uint8_t maskWithoutRedundant(const PointRecord<Key>& record, std::uint64_t begin, std::uint64_t end) {
    std::uint8_t mask = 0;
    for (int e = 0; e < kPointEdges; ++e) {
        const std::uint64_t far = record.farKeys[e];
        mask |= static_cast<std::uint8_t>((far < begin || far >= end) << e);
    }
    return mask & record.edgeMask;
}

} // namespace isoslider::index
