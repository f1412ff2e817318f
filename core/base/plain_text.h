#pragma once

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

/// With the letters of ASCII small.
inline std::string lowerCase(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

} // namespace isoslider
