#pragma once

#include <optional>
#include <span>

#include <glm/vec4.hpp>

#include "core/extract/pieces/surface_hit.h"
#include "ui/model/pieces/piece_tints.h"

namespace isoslider::model {

/// As extract::firstHit(), of the pieces that are shown, where they are within all of `cuts`: those of cutsOf() in the
/// frame's index units.
std::optional<extract::SurfaceHit> firstShownHit(const extract::SurfaceFrame& frame, const PieceOptions& pieces,
                                                 std::span<const glm::dvec4> cuts, const glm::dvec3& from,
                                                 const glm::dvec3& to);

} // namespace isoslider::model
