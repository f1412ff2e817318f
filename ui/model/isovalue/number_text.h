#pragma once

#include <cstdint>
#include <string>

namespace isoslider::model {

/// "1,234,567"
std::string groupedText(std::uint64_t value);
std::string groupedText(std::int64_t value);
/// Four significant figures at most: "812", "12.4 k", "3.81 M".
std::string compactText(std::uint64_t value);
/// Binary units, three significant figures: "812 B", "12.4 KiB", "3.81 MiB".
std::string bytesText(std::uint64_t bytes);
/// Shortest text with `digits` significant figures that reads naturally: "1016.53", "1.5e-07".
std::string valueText(double value, int digits = 6);
/// A duration: "0.42 ms", "18.3 ms", "1.24 s", "2 min 05 s".
std::string millisecondsText(double milliseconds);

} // namespace isoslider::model
