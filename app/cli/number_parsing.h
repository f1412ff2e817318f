#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isoslider::cli {

/// Numbers as people type them, the same in every locale. The whole text must be the number: no
/// spaces, no comma, nothing behind. Nothing is returned for anything else, or when it does not fit.

/// A finite number: "5", "-0.25", "1e-3".
std::optional<double> parseFinite(std::string_view text);
std::optional<std::int64_t> parseInteger(std::string_view text);
/// A size in bytes with a binary suffix: "4096", "64K", "512M", "2G", "1T"; also "512MB", "512MiB".
std::optional<std::uint64_t> parseSizeBytes(std::string_view text);

/// The parts between separators; an empty text has one empty part.
std::vector<std::string_view> splitAt(std::string_view text, char separator);

/// "512 MiB": a size for people.
std::string sizeText(std::uint64_t bytes);

} // namespace isoslider::cli
