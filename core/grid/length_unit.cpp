#include "core/grid/length_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/base/plain_text.h"

namespace isoslider {
namespace {

struct Spelling {
    std::string_view text; ///< in lower case
    std::string_view symbol;
};

// U+00B5 and U+03BC both look like the prefix; writers of TIFF also escape the first, or use its Latin-1 byte.
constexpr Spelling kSpellings[] = {
    {"m", "m"},           {"meter", "m"},       {"metre", "m"},      {"km", "km"},          {"kilometer", "km"},
    {"kilometre", "km"},  {"dm", "dm"},         {"decimeter", "dm"}, {"decimetre", "dm"},   {"cm", "cm"},
    {"centimeter", "cm"}, {"centimetre", "cm"}, {"mm", "mm"},        {"millimeter", "mm"},  {"millimetre", "mm"},
    {"um", "µm"},         {"µm", "µm"},         {"\xce\xbcm", "µm"}, {"\xb5m", "µm"},       {"\\u00b5m", "µm"},
    {"&#181;m", "µm"},    {"&#xb5;m", "µm"},    {"micron", "µm"},    {"micrometer", "µm"},  {"micrometre", "µm"},
    {"nm", "nm"},         {"nanometer", "nm"},  {"nanometre", "nm"}, {"pm", "pm"},          {"picometer", "pm"},
    {"picometre", "pm"},  {"å", "Å"},           {"Å", "Å"},          {"\xe2\x84\xab", "Å"}, {"&#8491;", "Å"},
    {"&#197;", "Å"},      {"\\u00c5", "Å"},     {"angstrom", "Å"},   {"ångström", "Å"},     {"Ångström", "Å"},
    {"bohr", "bohr"},     {"inch", "in"},       {"inches", "in"},    {"in", "in"},          {"foot", "ft"},
    {"feet", "ft"},       {"ft", "ft"},
};

constexpr std::string_view kNoUnits[] = {"pixel", "pixels", "voxel", "voxels", "none", "unknown", "???", "?"};

struct InMetres {
    double metres;
    std::string_view symbol;
};
constexpr InMetres kInMetres[] = {{1e3, "km"},  {1.0, "m"},   {1e-1, "dm"}, {1e-2, "cm"}, {1e-3, "mm"},
                                  {1e-6, "µm"}, {1e-9, "nm"}, {1e-10, "Å"}, {1e-12, "pm"}};

/// The character that `text` begins with and its bytes; none where that is not UTF-8.
std::optional<std::pair<std::uint32_t, std::size_t>> firstCharacter(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
    const std::size_t bytes = byte(0) < 0x80   ? 1
                              : byte(0) < 0xc2 ? 0
                              : byte(0) < 0xe0 ? 2
                              : byte(0) < 0xf0 ? 3
                              : byte(0) < 0xf5 ? 4
                                               : 0;
    if (bytes == 0 || bytes > text.size())
        return std::nullopt;
    constexpr std::array<std::uint32_t, 5> kFirstBits{0, 0x7f, 0x1f, 0x0f, 0x07}, kLeast{0, 0, 0x80, 0x800, 0x10000};
    std::uint32_t character = byte(0) & kFirstBits[bytes];
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0) != 0x80)
            return std::nullopt;
        character = character << 6 | (byte(i) & 0x3f);
    }
    if (character < kLeast[bytes] || character > 0x10ffff || (character >= 0xd800 && character < 0xe000))
        return std::nullopt;
    return std::pair(character, bytes);
}

// Not one are controls, blanks of any kind, marks of direction and private or missing characters.
bool isPrinted(std::uint32_t character) {
    return character > 0x20 && !(character >= 0x7f && character <= 0xa0) && character != 0xad &&
           !(character >= 0x2000 && character <= 0x200f) && !(character >= 0x2028 && character <= 0x202f) &&
           !(character >= 0x205f && character <= 0x206f) && character != 0x3000 &&
           !(character >= 0xe000 && character <= 0xf8ff) && !(character >= 0xfe00 && character <= 0xfe0f) &&
           character < 0xfeff;
}

} // namespace

bool isLengthUnit(std::string_view text) {
    for (std::size_t count = 0; !text.empty(); ++count) {
        const auto first = firstCharacter(text);
        if (count == kMaxLengthUnit || !first || !isPrinted(first->first))
            return false;
        text.remove_prefix(first->second);
    }
    return true;
}

std::string knownLengthUnit(std::string_view text) {
    const std::string lower = lowerCase(text);
    // A plural is a longer word's: "ms" are no metres.
    const bool isPlural = lower.size() > 4 && lower.back() == 's';
    for (const Spelling& spelling : kSpellings)
        if (lower == spelling.text ||
            (isPlural && std::string_view(lower).substr(0, lower.size() - 1) == spelling.text))
            return std::string(spelling.symbol);
    return {};
}

std::string lengthUnitOf(std::string_view text) {
    if (std::string known = knownLengthUnit(text); !known.empty())
        return known;
    const bool isNone = std::find(std::begin(kNoUnits), std::end(kNoUnits), lowerCase(text)) != std::end(kNoUnits);
    return isNone || !isLengthUnit(text) ? std::string() : std::string(text);
}

std::string lengthUnitOfMetres(double metres) {
    for (const InMetres& unit : kInMetres)
        if (std::abs(metres - unit.metres) <= 1e-6 * unit.metres)
            return std::string(unit.symbol);
    return {};
}

} // namespace isoslider
