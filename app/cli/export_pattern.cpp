#include "app/cli/export_pattern.h"

#include <fmt/format.h>

namespace isoslider::cli {

std::optional<ExportPattern> ExportPattern::parse(const std::string& text) {
    const auto percent = text.find('%');
    if (percent == std::string::npos || text.find('%', percent + 1) != std::string::npos)
        return std::nullopt;
    ExportPattern pattern;
    pattern.before_ = text.substr(0, percent);
    std::string rest = text.substr(percent + 1);
    if (rest.size() > 2 && rest[0] == '0' && rest[1] >= '1' && rest[1] <= '9') {
        pattern.width_ = rest[1] - '0';
        rest.erase(0, 2);
    }
    if (rest.empty() || rest[0] != 'd')
        return std::nullopt;
    pattern.after_ = rest.substr(1);
    return pattern;
}

std::string ExportPattern::nameOf(std::size_t step) const {
    return fmt::format("{}{:0{}}{}", before_, step, width_, after_);
}

} // namespace isoslider::cli
