#include "ui/model/isovalue/number_text.h"

#include <array>
#include <cmath>
#include <cstdio>

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
