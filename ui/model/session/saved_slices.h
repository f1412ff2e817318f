#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "ui/model/slices/slice_options.h"

namespace isoslider::model {

/// As a session file has the slices.
nlohmann::json slicesJson(const SliceOptions& slices);

/// What can be used of it; each fault is named in a line of `problems`.
SliceOptions slicesFromJson(const nlohmann::json& json, std::vector<std::string>& problems);

} // namespace isoslider::model
