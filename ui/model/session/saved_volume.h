#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "ui/model/session/named_volume.h"

namespace isoslider::model {

/// As a session file has it: {"sample"} or {"path", "relative"}, and "options". `folder`: where the file will lie.
nlohmann::json volumeJson(const NamedVolume& volume, const std::filesystem::path& folder);

/// What can be used of it; each fault is named in a line of `problems`, `place` of those of its members. A volume that
/// is still where the session file lies is found there.
NamedVolume volumeFromJson(const nlohmann::json& json, const std::filesystem::path& folder, const std::string& place,
                           std::vector<std::string>& problems);

} // namespace isoslider::model
