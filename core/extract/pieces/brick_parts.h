#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/extract/live/edge_record.h"

namespace isoslider::extract {

/// What is connected within one brick.
struct BrickPart {
    std::uint32_t triangles = 0;
    std::array<std::uint8_t, 3> low{255, 255, 255}, high{}; ///< grid points of the brick, 0 to 8
    ClosedEdge edge; ///< the first one with a vertex of it
};

/// The parts of one brick's triangles that are connected within the brick.
struct BrickParts {
    static constexpr std::uint16_t kNone = 0xffff;
    /// A vertex on a face of the brick. `place`: its edge with the face's coordinate set to 0, so that both bricks at
    /// the face name it alike.
    struct FaceVertex {
        ClosedEdge place;
        std::uint16_t part;
    };

    std::vector<BrickPart> parts;
    std::vector<ClosedEdge> edges; ///< by record
    std::vector<std::uint16_t> partOf; ///< by record; kNone for one that no triangle has
    /// Ascending by place: at the low face of axis 0, the high one, and so on.
    std::array<std::vector<FaceVertex>, 6> faces;
};

/// O(records + triangles).
template <class Live>
BrickParts partsOf(std::span<const EdgeRecord<Live>> records, std::span<const std::uint16_t> indices);

} // namespace isoslider::extract
