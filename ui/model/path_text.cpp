#include "ui/model/path_text.h"

namespace isoslider::model {
namespace {

constexpr char kDigits[] = "0123456789abcdef";

} // namespace

std::string bytesText(const std::string& bytes) {
    std::string text;
    for (const char byte : bytes) {
        const auto code = static_cast<unsigned char>(byte);
        if (code >= 0x20 && code < 0x7f && code != '%')
            text += byte;
        else
            text += {'%', kDigits[code / 16], kDigits[code % 16]};
    }
    return text;
}

std::optional<std::string> bytesFromText(const std::string& text) {
    std::string bytes;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            bytes += text[i];
            continue;
        }
        const std::string digits = text.substr(i + 1, 2);
        if (digits.size() != 2 || digits.find_first_not_of(kDigits) != std::string::npos)
            return std::nullopt;
        bytes += static_cast<char>(std::stoi(digits, nullptr, 16));
        i += 2;
    }
    return bytes;
}

} // namespace isoslider::model
