#pragma once

#include <memory>
#include <optional>

#include <glm/vec3.hpp>

#include "core/extract/surface_frame.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/model/surface/surface_list.h"

namespace isoslider::render {

/// How a surface is drawn.
struct SurfaceLook {
    std::optional<glm::vec3> colour; ///< linear light; none: SceneColours
    float opacity = 1.0f;
    bool isVisible = true;

    bool isOpaque() const { return opacity > 0.999f; }
    bool operator==(const SurfaceLook&) const = default;
};

/// As the user has set it. The first of all colours is that of SceneColours, whose inside is slate.
SurfaceLook lookOf(const model::ListedSurface& surface);

/// A surface beside the one that slides.
struct InactiveSurface {
    model::SurfaceId id{};
    std::shared_ptr<const extract::SurfaceFrame> frame; ///< not null
    SurfaceLook look;
    model::HiddenPieces hiddenPieces; ///< of pieces that the frame has
    bool isOfVolume = true; ///< that slides, not of a second one

    bool operator==(const InactiveSurface&) const = default;
};

} // namespace isoslider::render
