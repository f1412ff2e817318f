#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/extract/surface_frame.h"
#include "ui/model/colouring/surface_colours.h"
#include "ui/model/surface/camera.h"
#include "ui/model/surface/view_state.h"
#include "ui/render/clip_guides.h"
#include "ui/render/slice_scene.h"
#include "ui/render/surface_look.h"

namespace isoslider::render {

/// A place that is pointed out: a ring on it that is seen through the surface, and the surface around it highlighted.
struct Spot {
    glm::dvec3 place{0.0}; ///< grid index units of the volume
    float strength = 1.0f; ///< 0 to 1: how much both cover what is below
    float pixelRatio = 1.0f; ///< of the screen

    bool operator==(const Spot&) const = default;
};

/// All that a picture of the scene depends on.
struct SceneView {
    std::shared_ptr<const extract::SurfaceFrame> frame; ///< null for none
    /// What the frame's grid is of, if that is larger: a preview does not reach all the ends. Its box is drawn, its
    /// centre is the origin.
    std::optional<GridGeometry> volume;
    std::optional<Spot> spot;
    SliceScene slices;
    model::Camera camera;
    model::ViewOptions options;
    glm::ivec2 pixels{0};
    CapScenes caps;
    SurfaceLook look; ///< of the frame
    std::vector<InactiveSurface> inactive; ///< in any order: the picture is the same
    model::SurfaceColours colours; ///< of all of them
    float lineWidth = 1.0f; ///< pixels, of the box, the crop box, planes, what lies in them, and triangle edges
    std::optional<glm::vec3> plainBackground{}; ///< as seen; none: that of the options, which lines are made for
};

/// What a surface, or the caps of those of the volume, is coloured by. A field is that of the volume, not of a second
/// one; and where pieces or merged cells have colours that mean something, nothing is coloured by a field beside them.
inline bool isColouredByField(const model::ViewOptions& options, bool isOfVolume = true) {
    return isOfVolume && !options.pieces.isColoured && !options.showsLevels;
}

} // namespace isoslider::render
