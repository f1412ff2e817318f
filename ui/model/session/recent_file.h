#pragma once

#include <filesystem>
#include <string>

#include "ui/model/session/dataset.h"

namespace isoslider::model {

/// A file opened lately, and what of it.
struct RecentFile {
    std::filesystem::path path;
    io::ReadOptions options; ///< field, component, frame, size and raw layout; the rest is not remembered
    std::string fieldTitle; ///< what people call the field; empty: its name will do

    bool hasChoices() const { return options != io::ReadOptions(); }
    /// The same choices of the same file.
    bool isSameAs(const RecentFile& other) const { return path == other.path && options == other.options; }
};

/// As the settings keep it: the path, then what was chosen.
std::string recentText(const RecentFile& file);
/// The other way. What is damaged or of a later version reads as no choices.
RecentFile recentFromText(const std::string& text);

/// What of a volume that is open would open it again. The path is empty for samples.
RecentFile recentOf(const Dataset& dataset);

/// "speed, frame 3": what was chosen, for people; empty without choices.
std::string choicesText(const RecentFile& file);

} // namespace isoslider::model
