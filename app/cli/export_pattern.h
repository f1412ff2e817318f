#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace isoslider::cli {

/// A file name with a number in it: exactly one %d or %0Nd (N from 1 to 9), no other %.
/// Taken apart here; the text never reaches printf.
class ExportPattern {
public:
    static std::optional<ExportPattern> parse(const std::string& text);

    /// The file name of one step, its number padded with zeros.
    std::string nameOf(std::size_t step) const;

private:
    std::string before_;
    std::string after_;
    int width_ = 0;
};

} // namespace isoslider::cli
