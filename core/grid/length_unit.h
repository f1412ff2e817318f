#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isoslider {

/// Most characters of a unit's symbol.
inline constexpr std::size_t kMaxLengthUnit = 16;
/// Most bytes of one: UTF-8.
inline constexpr std::size_t kMaxLengthUnitBytes = 4 * kMaxLengthUnit;

/// True of what may be shown as a unit of length: UTF-8, no more than kMaxLengthUnit characters, each of which can be
/// printed, no blanks. Also true of the empty text: no unit is known.
bool isLengthUnit(std::string_view text);

/// The symbol of a unit that files spell in many ways: "millimetres" and "MM" are "mm", "micron" and "um" are "µm".
/// Empty if `text` is none of those.
std::string knownLengthUnit(std::string_view text);

/// The symbol, or else the text itself where it may be shown. Empty for pixels and the like: a file reports it
/// where it does not know.
std::string lengthUnitOf(std::string_view text);

/// The symbol of a unit that is so many metres long; empty if there is none.
std::string lengthUnitOfMetres(double metres);

} // namespace isoslider
