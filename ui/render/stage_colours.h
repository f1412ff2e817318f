#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "ui/model/surface/stage.h"

namespace isoslider::render {

/// What a background looks like, and what is legible on it; as seen.
struct StageColours {
    glm::vec3 bottom{0.0f}, top{0.0f};
    glm::vec4 box{0.0f}; ///< lines of the bounding box
};
StageColours coloursOf(model::Background background);

/// Where light comes from in view space, and how much of it.
struct StageLights {
    glm::vec3 key{0.0f}; ///< towards it, unit vector
    glm::vec3 shares{0.0f}; ///< of key light, headlight and fill
};
StageLights lightsOf(model::Light light);

} // namespace isoslider::render
