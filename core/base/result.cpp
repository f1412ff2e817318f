#include "core/base/result.h"

#include <cstdio>

namespace isoslider {

std::string_view errorCodeName(ErrorCode code) {
    switch (code) {
        case ErrorCode::NotFound: return "NotFound";
        case ErrorCode::Corruption: return "Corruption";
        case ErrorCode::UnsupportedVersion: return "UnsupportedVersion";
        case ErrorCode::InvalidArgument: return "InvalidArgument";
        case ErrorCode::IoError: return "IoError";
        case ErrorCode::OutOfSpace: return "OutOfSpace";
        case ErrorCode::Cancelled: return "Cancelled";
    }
    return "Unknown";
}

namespace {

// A message is one line whatever a path or a library put into it.
void appendEscaped(std::string& out, std::string_view text) {
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f) {
            char buffer[8];
            std::snprintf(buffer, sizeof buffer, "\\x%02x", byte);
            out += buffer;
        } else {
            out += c;
        }
    }
}

} // namespace

std::string Error::line() const {
    std::string out;
    if (!path.empty()) {
        appendEscaped(out, path);
        out += ": ";
    }
    appendEscaped(out, message);
    if (offset)
        out += " (at byte " + std::to_string(*offset) + ")";
    return out;
}

Error makeError(ErrorCode code, std::string message, std::string path, std::optional<std::uint64_t> offset) {
    return Error{code, std::move(message), std::move(path), offset};
}

} // namespace isoslider
