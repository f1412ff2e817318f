#pragma once

#include <string>

#include <fmt/format.h>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "app/cli/output.h"
#include "core/grid/grid_geometry.h"

namespace isoslider::cli {

inline Json vectorJson(const glm::dvec3& vector) { return Json::array({vector.x, vector.y, vector.z}); }

/// "1 0.5 2": the shortest digits that give the same numbers back.
inline std::string vectorText(const glm::dvec3& vector) {
    return fmt::format("{} {} {}", vector.x, vector.y, vector.z);
}

/// "256x256x64"
inline std::string dimsText(const GridDims& dims) { return fmt::format("{}x{}x{}", dims[0], dims[1], dims[2]); }

} // namespace isoslider::cli
