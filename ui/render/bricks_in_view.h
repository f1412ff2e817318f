#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include "core/extract/live/brick_picture.h"

namespace isoslider::render {

/// A brick that is drawn.
struct BrickInView {
    float depth;
    std::uint32_t slot;
    friend auto operator<=>(const BrickInView&, const BrickInView&) = default;
};

/// Lists the bricks with triangles that `modelToClip` brings into view, but for those wholly outside of one of `cuts`:
/// dot(xyz, place) + w >= 0, in index units. O(bricks).
void listBricksInView(std::span<const extract::PictureBrick> bricks, const glm::dmat4& modelToClip,
                      std::span<const glm::dvec4> cuts, std::vector<BrickInView>& inView);

} // namespace isoslider::render
