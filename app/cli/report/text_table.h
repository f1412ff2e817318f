#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace isoslider::cli {

/// Rows of text under headings; the first `leftColumns` columns are words, the others numbers.
class TextTable {
public:
    TextTable(std::vector<std::string> headings, std::size_t leftColumns);

    /// REQUIRES: as many as there are headings.
    void add(std::vector<std::string> row);

    std::string asText() const;
    std::string asMarkdown() const;

private:
    std::string line(const std::vector<std::string>& row, const std::vector<std::size_t>& widths,
                     const std::string& before, const std::string& between) const;
    std::vector<std::size_t> widths() const;

    std::vector<std::vector<std::string>> rows_; // the first: headings
    std::size_t leftColumns_;
};

/// "1,234,567".
std::string grouped(std::uint64_t value);
/// A number in digits with its thousands grouped; a sign, a fraction and an exponent stay as they are.
std::string withGroups(std::string number);
/// `value` with so many digits after the point, or "-" where it has not been measured (it is 0 then).
std::string numberOrDash(double value, int digits);

} // namespace isoslider::cli
