#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "core/extract/pieces/surface_hit.h"
#include "core/extract/surface_frame.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/model/surface/clipping.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::model {

class Session;
struct ViewOptions;

/// A surface that is drawn.
struct ShownSurface {
    SurfaceId id{};
    bool isOfSecond = false; ///< volume
    bool isSeeThrough = false; ///< more than half
    std::shared_ptr<const extract::SurfaceFrame> frame; ///< not null
    PieceOptions pieces; ///< which of them are hidden
};

/// Those that the user lets be seen, as far as their pictures are known; the active one first.
std::vector<ShownSurface> shownSurfaces(const Session& session, const ViewOptions& view);

/// Where a line of sight meets one of them first: one that is see-through only if there is no other behind it.
struct ShownPlace {
    std::size_t surface = 0; ///< among them
    extract::SurfaceHit hit; ///< in index units of its frame
    glm::dvec3 place{0.0}; ///< world axes, about the centre of the volume
};
/// Between two places on world axes about the centre of `volume`, the viewer's end first. What is clipped or hidden is
/// not met.
std::optional<ShownPlace> firstShownPlace(std::span<const ShownSurface> surfaces, const Clipping& clipping,
                                          const GridGeometry& volume, const glm::dvec3& from, const glm::dvec3& to);

} // namespace isoslider::model
