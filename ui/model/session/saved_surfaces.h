#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "ui/model/surface/surface_list.h"

namespace isoslider::model {

/// As a session file has them: {"list": [{"name", "isovalue", "colour": "#rrggbb", "opacity", "visible", "pieces"}],
/// "active": 0}. "pieces": what is hidden, see saved_pieces.h; of the active one the view has it.
nlohmann::json surfacesJson(const SurfaceList& list);

/// What can be used of it, under ids from 1; each fault is named in a line of `problems`. Empty if nothing can: then
/// the volume has one surface, as in sessions of before.
SurfaceList surfacesFromJson(const nlohmann::json& json, std::vector<std::string>& problems);

} // namespace isoslider::model
