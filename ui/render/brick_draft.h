#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/extract/inner_vertices.h"
#include "core/extract/live/edge_record.h"
#include "core/extract/live/vertex_code.h"

namespace isoslider::render {

/// The vertices and triangles of a brick, as a picture has them.
struct BrickSurface {
    std::span<const extract::VertexCode> codes; ///< those on edges in the order of the edges, then those inside cells
    const extract::InnerRecord* inner = nullptr;
    std::span<const std::uint16_t> indices; ///< in range, three a triangle
};

/// A coarser surface over some of the brick's vertices.
struct CoarseSurface {
    std::vector<std::uint16_t> vertices; ///< the numbers of those that stay, ascending
    std::vector<std::uint16_t> indices; ///< places in `vertices`, three a triangle
};

/// Makes `coarse` a coarser surface of the brick: the vertices of each block of `blockCells` cells a side become one of
/// them, and triangles that lose a corner go; of blocks of 2 a third is left, of blocks of 4 an eighth, of blocks of 8
/// a twentieth. What lies on the sides of the brick is only merged along them, by a rule that both bricks beside it
/// follow alike, so no cracks open. O(codes + indices). REQUIRES: blocks of 2, 4 or 8.
void coarsenBrick(const BrickSurface& surface, int blockCells, CoarseSurface& coarse);

} // namespace isoslider::render
