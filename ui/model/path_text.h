#pragma once

#include <optional>
#include <string>

namespace isoslider::model {

/// Any bytes as ASCII, for files that must be text: what is not, and '%', becomes %xx. Paths need not be UTF-8.
std::string bytesText(const std::string& bytes);
/// Nothing from what bytesText did not write.
std::optional<std::string> bytesFromText(const std::string& text);

} // namespace isoslider::model
