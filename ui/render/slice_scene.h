#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "ui/model/slices/slice_model.h"

namespace isoslider::render {

/// One slice as it stands in the scene. Grid index units of the volume.
struct SliceInScene {
    std::shared_ptr<const model::SliceShades> shades;
    std::shared_ptr<const model::SliceContour> contour; ///< null: none is drawn
    glm::vec3 colour{1.0f}; ///< of its border; as seen

    bool operator==(const SliceInScene&) const = default;
};

/// What slices add to the scene.
struct SliceScene {
    std::vector<SliceInScene> slices;
    std::optional<glm::dvec3> crosshair; ///< where lines along the three axes meet
    std::array<glm::vec3, 3> axisColours{}; ///< as seen

    bool isEmpty() const { return slices.empty() && !crosshair; }
    bool operator==(const SliceScene&) const = default;
};

} // namespace isoslider::render
