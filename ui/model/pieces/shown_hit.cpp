#include "ui/model/pieces/shown_hit.h"

#include "ui/model/surface/clipping.h"

namespace isoslider::model {

std::optional<extract::SurfaceHit> firstShownHit(const extract::SurfaceFrame& frame, const PieceOptions& pieces,
                                                 std::span<const glm::dvec4> cuts, const glm::dvec3& from,
                                                 const glm::dvec3& to) {
    const auto part = partWithin(cuts, from, to);
    if (!part)
        return std::nullopt;
    if (!frame.pieces)
        return extract::firstHit(frame, part->first, part->second, [](std::uint32_t) { return true; });
    const PieceDisplay display(*frame.pieces, frame.geometry, pieces);
    return extract::firstHit(frame, part->first, part->second,
                             [&](std::uint32_t piece) { return display.isShown(piece); });
}

} // namespace isoslider::model
