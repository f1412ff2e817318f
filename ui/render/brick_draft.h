#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/extract/live/edge_record.h"

namespace isoslider::render {

/// Appends the indices of a coarser surface over the same records to `coarse`: the vertices of each block of
/// `blockCells` cells a side become one of them, and triangles that lose a corner go; of blocks of 2 a third is left,
/// of blocks of 4 a tenth. What lies on the sides of the brick is only merged along them, by a rule that both bricks
/// beside it follow alike, so no cracks open. O(records + indices). REQUIRES: indices are in range, three a triangle;
/// blocks of 2 or 4.
void coarsenBrick(std::span<const extract::EdgeRecord<float>> records, std::span<const std::uint16_t> indices,
                  int blockCells, std::vector<std::uint16_t>& coarse);

} // namespace isoslider::render
