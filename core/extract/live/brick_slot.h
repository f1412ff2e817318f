#pragma once

#include <cstdint>

#include "core/base/strong_id.h"

namespace isoslider::extract {

struct BrickSlotTag;
/// Number of a live brick: its place in the tables of the live surface and of what feeds it. Not the brick's index in
/// the grid.
using BrickSlot = StrongId<BrickSlotTag, std::uint32_t>;

} // namespace isoslider::extract
