#include "app/cli/number_parsing.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/plain_text.h"

namespace isoslider::cli {
namespace {

char upperCase(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Power of two behind a size suffix: "" 0, "K", "KB" and "KiB" 10, and so on.
std::optional<int> suffixShift(std::string_view suffix) {
    if (suffix.empty() || suffix == "B")
        return 0;
    const auto place = std::string_view("KMGT").find(upperCase(suffix[0]));
    const auto rest = suffix.substr(1);
    if (place == std::string_view::npos || !(rest.empty() || rest == "B" || rest == "iB"))
        return std::nullopt;
    return 10 * (static_cast<int>(place) + 1);
}

} // namespace

std::optional<double> parseFinite(std::string_view text) {
    const auto value = parseNumber<double>(text);
    if (!value || !std::isfinite(*value))
        return std::nullopt;
    return value;
}

std::optional<std::int64_t> parseInteger(std::string_view text) { return parseNumber<std::int64_t>(text); }

std::optional<std::uint64_t> parseSizeBytes(std::string_view text) {
    const auto digits = std::min(text.find_first_not_of("0123456789"), text.size());
    const auto count = parseNumber<std::uint64_t>(text.substr(0, digits));
    const auto shift = suffixShift(text.substr(digits));
    if (!count || !shift || *count > (std::numeric_limits<std::uint64_t>::max() >> *shift))
        return std::nullopt;
    return *count << *shift;
}

std::vector<std::string_view> splitAt(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    std::size_t begin = 0;
    for (;;) {
        const auto end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end - begin));
        if (end == std::string_view::npos)
            return parts;
        begin = end + 1;
    }
}

std::string sizeText(std::uint64_t bytes) {
    constexpr std::array<const char*, 5> kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
    auto amount = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (amount >= 1024.0 && unit + 1 < kUnits.size()) {
        amount /= 1024.0;
        ++unit;
    }
    const bool isWhole = amount == std::floor(amount);
    return isWhole ? fmt::format("{:.0f} {}", amount, kUnits[unit]) : fmt::format("{:.1f} {}", amount, kUnits[unit]);
}

} // namespace isoslider::cli
