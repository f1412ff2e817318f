#pragma once

#include "core/base/strong_id.h"

namespace isoslider::index {

struct SkipLevelTag;
/// A level of the skip list: 0 has a block for each distinct value, each level above fewer and longer ones. Not a level
/// of detail.
using SkipLevel = StrongId<SkipLevelTag, int>;

inline constexpr SkipLevel kLevel0{0};

constexpr SkipLevel above(SkipLevel level, int steps = 1) { return SkipLevel(level.number() + steps); }
constexpr SkipLevel below(SkipLevel level) { return SkipLevel(level.number() - 1); }

} // namespace isoslider::index
