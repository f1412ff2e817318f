#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

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
/// The same of measures that may be large: "290,200" rather than "2.902e+05" up to 10^15. Digits are grouped from
/// 10,000 on.
std::string measureText(double value, int digits);
/// Lengths, areas and volumes as they are stated everywhere: those of a mesh as "35,112.47", and what is known to some
/// tenths of a percent as "≈ 35,110".
std::string measureText(double value);
std::string estimateText(double value);
/// The shortest text that reads as just this number, where that takes at most 12 figures; with 8 figures otherwise.
std::string exactText(double value);
/// `value` with the digits that differences of `resolution` need: 92.3877 at 0.2 is "92.4", 100 at 20 is "100".
std::string resolvedText(double value, double resolution);
/// A number as people write it: with a decimal point or comma, digits grouped by spaces, apostrophes or the other of
/// the two, a minus sign of any kind. One comma alone is a decimal comma: "1,234" is 1.234. Too large ones are
/// infinite. Nothing if it is not a number.
std::optional<double> numberFrom(std::string_view text);
/// A duration: "0.42 ms", "18.3 ms", "1.24 s", "2 min 05 s".
std::string millisecondsText(double milliseconds);

} // namespace isoslider::model
