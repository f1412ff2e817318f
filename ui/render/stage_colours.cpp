#include "ui/render/stage_colours.h"

#include <glm/geometric.hpp>

namespace isoslider::render {

StageColours coloursOf(model::Background background) {
    constexpr glm::vec4 kPaleLines(0.78f, 0.82f, 0.88f, 0.38f), kDarkLines(0.16f, 0.20f, 0.26f, 0.55f);
    switch (background) {
        case model::Background::Light: return {{0.760f, 0.780f, 0.805f}, {0.925f, 0.935f, 0.945f}, kDarkLines};
        case model::Background::White: return {glm::vec3(1.0f), glm::vec3(1.0f), kDarkLines};
        case model::Background::Black: return {glm::vec3(0.0f), glm::vec3(0.0f), kPaleLines};
        case model::Background::Dark: break;
    }
    return {{0.085f, 0.092f, 0.105f}, {0.225f, 0.240f, 0.265f}, kPaleLines};
}

StageLights lightsOf(model::Light light) {
    switch (light) {
        case model::Light::Headlight: return {{0.0f, 0.0f, 1.0f}, {0.0f, 0.92f, 0.0f}};
        case model::Light::Raking: return {glm::normalize(glm::vec3(-0.95f, 0.25f, 0.22f)), {0.88f, 0.07f, 0.05f}};
        case model::Light::Studio: break;
    }
    return {glm::normalize(glm::vec3(-0.45f, 0.62f, 0.75f)), {0.62f, 0.26f, 0.10f}}; // over the left shoulder
}

} // namespace isoslider::render
