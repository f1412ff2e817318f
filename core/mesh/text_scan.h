#pragma once

#include <algorithm>
#include <string_view>

namespace isoslider::mesh {

/// Cuts the next line, without its end, from the front of `text`. False at the end.
inline bool nextLine(std::string_view& text, std::string_view& line) {
    if (text.empty())
        return false;
    const auto end = text.find('\n');
    line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.ends_with('\r'))
        line.remove_suffix(1);
    return true;
}

/// Cuts the next word from the front of `text`; empty at the end.
inline std::string_view nextWord(std::string_view& text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    text.remove_prefix(word.size());
    return word;
}

} // namespace isoslider::mesh
