#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "ui/model/colouring/colouring.h"

namespace isoslider::model {

/// As a session file has it: {"by": "gradient", "map": "viridis", "reversed": false, "range": [0, 1], "field": {"path",
/// "relative", "options"}}; the last two where there are. `folder`: where the file lies.
nlohmann::json colouringJson(const Colouring& colouring, const std::filesystem::path& folder);

/// What can be used of it; each fault is named in a line of `problems`.
Colouring colouringFromJson(const nlohmann::json& json, const std::filesystem::path& folder,
                            std::vector<std::string>& problems);

} // namespace isoslider::model
