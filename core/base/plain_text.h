#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace isoslider {

/// Text of a file or a library for people to read in one line: control characters, to which a terminal would listen,
/// become blanks.
inline std::string oneLine(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = ' ';
    return out;
}

/// "1 piece", "2 pieces": how many of what, whose plural takes an s.
template <class Count>
std::string counted(Count count, std::string_view what) {
    return std::to_string(count) + ' ' + std::string(what) + (count == 1 ? "" : "s");
}

/// Short and printable, for messages that quote a file.
inline std::string inQuotes(std::string_view text) {
    constexpr std::size_t kMost = 60;
    std::string out = "'";
    for (const char c : text.substr(0, kMost))
        out += c >= 0x20 && c < 0x7f ? c : '?';
    return out + (text.size() > kMost ? "...'" : "'");
}

/// The whole text as one number, none if it is not; the locale plays no part. A leading '+' is accepted.
template <class Number>
std::optional<Number> parseNumber(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
        text.remove_prefix(1);
    Number value{};
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc{} || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

/// Likewise; `out` is left as it is if false.
template <class Number>
bool parseNumber(std::string_view text, Number& out) {
    const auto value = parseNumber<Number>(text);
    out = value.value_or(out);
    return value.has_value();
}

/// With the letters of ASCII small.
inline std::string lowerCase(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

} // namespace isoslider
