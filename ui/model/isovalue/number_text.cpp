#include "ui/model/isovalue/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>

namespace isoslider::model {
namespace {

template <class... Args>
std::string printed(const char* format, Args... args) {
    std::array<char, 64> buffer{};
    std::snprintf(buffer.data(), buffer.size(), format, args...);
    return buffer.data();
}

std::string threeFigures(double value) {
    if (value >= 99.95)
        return printed("%.0f", value);
    return printed(value >= 9.995 ? "%.1f" : "%.2f", value);
}

/// Divides by `base` until below it, and names the unit reached.
template <std::size_t N>
std::string scaledText(double value, double base, const std::array<const char*, N>& units) {
    std::size_t unit = 0;
    while (value >= base * 0.9995 && unit + 1 < N) {
        value /= base;
        ++unit;
    }
    return threeFigures(value) + " " + units[unit];
}

void replaceAll(std::string& text, std::string_view what, std::string_view by) {
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
        text.replace(at, what.size(), by);
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Whether each `mark` stands between digits, with three of them behind it.
bool isGrouping(const std::string& text, char mark, std::size_t end) {
    for (auto at = text.find(mark); at != std::string::npos && at < end; at = text.find(mark, at + 1)) {
        std::size_t digits = 0;
        while (at + 1 + digits < end && isDigit(text[at + 1 + digits]))
            ++digits;
        if (at == 0 || !isDigit(text[at - 1]) || digits != 3)
            return false;
    }
    return true;
}

/// Leaves a point as the only mark; false if the marks make no number.
bool unifyMarks(std::string& text) {
    const auto points = std::count(text.begin(), text.end(), '.'), commas = std::count(text.begin(), text.end(), ',');
    char decimal = '.';
    if (points > 0 && commas > 0)
        decimal = text.rfind('.') > text.rfind(',') ? '.' : ',';
    else if (commas == 1 || points > 1)
        decimal = ','; // several points can but group
    const char group = decimal == '.' ? ',' : '.';
    const auto end = std::min(text.find(decimal), text.size());
    if (std::count(text.begin(), text.end(), decimal) > 1 || !isGrouping(text, group, end) ||
        text.find(group, end) != std::string::npos)
        return false;
    std::erase(text, group);
    replaceAll(text, std::string_view(&decimal, 1), ".");
    return true;
}

constexpr int kMeasureFigures = 7; // of a mesh: what its 32-bit floats hold
constexpr int kEstimateFigures = 4;

/// "12345.67" as "12,345.67"; numbers below 10,000, and those with an exponent, stay as they are.
std::string grouped(std::string text) {
    constexpr std::size_t kLeast = 5, kGroup = 3; // digits
    const std::size_t first = text.starts_with('-') ? 1 : 0;
    const std::size_t point = std::min(text.find_first_not_of("0123456789", first), text.size());
    if (point < first + kLeast || text.find('e') != std::string::npos)
        return text;
    for (std::size_t at = point; at > first + kGroup;) {
        at -= kGroup;
        text.insert(at, 1, ',');
    }
    return text;
}

} // namespace

std::string groupedText(std::uint64_t value) {
    std::string text = std::to_string(value);
    for (std::ptrdiff_t place = static_cast<std::ptrdiff_t>(text.size()) - 3; place > 0; place -= 3)
        text.insert(static_cast<std::size_t>(place), 1, ',');
    return text;
}

std::string groupedText(std::int64_t value) {
    if (value >= 0)
        return groupedText(static_cast<std::uint64_t>(value));
    return groupedText(std::uint64_t{0} - static_cast<std::uint64_t>(value)).insert(0, 1, '-');
}

std::string compactText(std::uint64_t value) {
    if (value < 10'000)
        return std::to_string(value);
    static constexpr std::array<const char*, 5> kUnits{"", "k", "M", "G", "T"};
    return scaledText(static_cast<double>(value), 1000.0, kUnits);
}

std::string bytesText(std::uint64_t bytes) {
    if (bytes < 1024)
        return std::to_string(bytes) + " B";
    static constexpr std::array<const char*, 6> kUnits{"B", "KiB", "MiB", "GiB", "TiB", "PiB"};
    return scaledText(static_cast<double>(bytes), 1024.0, kUnits);
}

std::string valueText(double value, int digits) {
    if (value == 0.0)
        return "0";
    return printed("%.*g", digits, value);
}

std::string measureText(double value, int digits) {
    const double size = std::abs(value);
    if (!(size >= std::pow(10.0, digits) - 0.5 && size < 1e15)) // from there on, valueText has an exponent
        return grouped(valueText(value, digits));
    const double unit = std::pow(10.0, std::floor(std::log10(size)) - digits + 1);
    return groupedText(static_cast<std::int64_t>(std::round(value / unit) * unit));
}

std::string measureText(double value) { return measureText(value, kMeasureFigures); }

std::string estimateText(double value) { return "\xE2\x89\x88 " + measureText(value, kEstimateFigures); } // ≈

std::string exactText(double value) {
    if (value == 0.0)
        return "0";
    std::string text = printed("%.12g", value);
    double read = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), read);
    if (read != value)
        return printed("%.8g", value);
    for (int digits = 1; digits < 12; ++digits) {
        const std::string shorter = printed("%.*g", digits, value);
        std::from_chars(shorter.data(), shorter.data() + shorter.size(), read);
        // Not "1e+02" for 100.
        if (read == value && (shorter.find('e') == std::string::npos) == (text.find('e') == std::string::npos))
            return shorter;
    }
    return text;
}

std::string resolvedText(double value, double resolution) {
    if (value == 0.0 || std::abs(value) < resolution / 2.0)
        return "0";
    if (!(resolution > 0.0) || !std::isfinite(resolution))
        return valueText(value, 7);
    const double decimals = -std::floor(std::log10(resolution) + 1e-9);
    const double figures = std::floor(std::log10(std::abs(value))) + 1.0 + decimals;
    if (std::abs(value) >= 1e7 || std::abs(value) < 1e-4)
        return printed("%.*g", static_cast<int>(std::min(std::max(figures, 1.0), 15.0)), value);
    return printed("%.*f", static_cast<int>(std::min(std::max(decimals, 0.0), 15.0)), value);
}

std::optional<double> numberFrom(std::string_view given) {
    std::string text(given);
    for (const std::string_view minus : {"\xE2\x88\x92", "\xE2\x80\x93"}) // U+2212, U+2013
        replaceAll(text, minus, "-");
    // Spaces of all widths that group digits, and apostrophes.
    for (const std::string_view space : {"\xC2\xA0", "\xE2\x80\xAF", "\xE2\x80\x89", "'", "\xE2\x80\x99"})
        replaceAll(text, space, " ");
    constexpr std::string_view kBlanks = " \t\r\n";
    text.erase(0, std::min(text.find_first_not_of(kBlanks), text.size()));
    text.erase(text.find_last_not_of(kBlanks) + 1);
    const auto lastMark = std::min(text.find_last_of(".,"), text.size());
    if (!isGrouping(text, ' ', lastMark) || text.find(' ', lastMark) != std::string::npos)
        return std::nullopt;
    std::erase(text, ' ');
    if (!unifyMarks(text))
        return std::nullopt;
    if (text.starts_with("+-"))
        return std::nullopt;
    if (text.starts_with('+'))
        text.erase(0, 1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end != text.data() + text.size() || error == std::errc::invalid_argument || std::isnan(value))
        return std::nullopt;
    if (error == std::errc::result_out_of_range) { // too large, or too near to 0
        const bool isSmall = text.find("e-") != std::string::npos || text.find("E-") != std::string::npos;
        const double size = isSmall ? 0.0 : std::numeric_limits<double>::infinity();
        return text.starts_with('-') ? -size : size;
    }
    return value;
}

std::string millisecondsText(double milliseconds) {
    if (milliseconds < 1.0)
        return printed("%.2f ms", milliseconds);
    if (milliseconds < 999.5)
        return threeFigures(milliseconds) + " ms";
    if (milliseconds < 99'950.0)
        return threeFigures(milliseconds / 1000.0) + " s";
    const auto seconds = static_cast<long long>(std::llround(milliseconds / 1000.0));
    return printed("%lld min %02lld s", seconds / 60, seconds % 60);
}

} // namespace isoslider::model
