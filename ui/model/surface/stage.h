#pragma once

#include <array>
#include <optional>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "core/grid/grid_geometry.h"
#include "ui/model/surface/axis_names.h"

namespace isoslider::model {

enum class Background { Dark, Light, White, Black };
enum class Light {
    Studio, ///< from above left, with a fill
    Headlight, ///< from the viewer: no side is preferred
    Raking ///< low from the side: shows relief
};

/// What a surface stands in. Lengths are drawn `stretch` times as long along the volume's axes; what is measured,
/// written and exported stays as the file has it.
struct Stage {
    Background background = Background::Dark;
    Light light = Light::Studio;
    bool hasOcclusion = false; ///< hollows are darkened
    glm::dvec3 stretch{1.0}; ///< along the axes of the grid; from 1 / kMostStretch to kMostStretch

    bool operator==(const Stage&) const = default;
};

inline constexpr double kMostStretch = 1000.0;

/// By Background and Light: as settings and sessions name them.
inline constexpr std::array<const char*, 4> kBackgroundNames{"dark", "light", "white", "black"};
inline constexpr std::array<const char*, 3> kLightNames{"studio", "headlight", "raking"};

inline bool isLight(Background background) {
    return background == Background::Light || background == Background::White;
}
bool isStretched(const glm::dvec3& stretch);
/// Within the bounds; 1 in place of what is no number.
glm::dvec3 stretchWithin(const glm::dvec3& stretch);
/// From world space to the space that is shown, about the volume's centre.
glm::dmat3 stretchMatrix(const glm::dvec3& stretch, const GridGeometry& volume);
/// With spacings as they are drawn.
GridGeometry stretched(GridGeometry geometry, const glm::dvec3& stretch);
/// Where the box is a needle or a plate because its axes have different units, as degrees and metres: a stretch by
/// round factors (1, 2, 5, 10, ...) that makes it a box to look at. None where spacings are alike within 5, or the
/// box's sides within 10, times; but also where spacings differ 20 times and one side is twice as long as the others.
std::optional<glm::dvec3> suggestedStretch(const GridGeometry& volume);
/// Such as "X × 20, Z × 0.5", in the order of the axes of the grid; empty where nothing is stretched.
std::string stretchText(const glm::dvec3& stretch, const AxisNames& names = {});

} // namespace isoslider::model
