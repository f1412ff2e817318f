#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "ui/model/surface/view_state.h"

namespace isoslider::model {

/// As a session file has what is drawn beside the surface. Pieces: those that are awaited() there.
nlohmann::json viewJson(const ViewOptions& view);

/// What can be used of it; each fault is named in a line of `problems`.
ViewOptions viewFromJson(const nlohmann::json& json, std::vector<std::string>& problems);

} // namespace isoslider::model
