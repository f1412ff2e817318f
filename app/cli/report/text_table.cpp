#include "app/cli/report/text_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/check.h"

namespace isoslider::cli {

TextTable::TextTable(std::vector<std::string> headings, std::size_t leftColumns)
    : rows_{std::move(headings)}, leftColumns_(leftColumns) {}

void TextTable::add(std::vector<std::string> row) {
    ISO_CHECK(row.size() == rows_.front().size());
    rows_.push_back(std::move(row));
}

std::vector<std::size_t> TextTable::widths() const {
    std::vector<std::size_t> widths(rows_.front().size());
    for (const auto& row : rows_)
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], row[i].size());
    return widths;
}

std::string TextTable::line(const std::vector<std::string>& row, const std::vector<std::size_t>& widths,
                            const std::string& before, const std::string& between) const {
    std::string out = before;
    for (std::size_t i = 0; i < row.size(); ++i) {
        out += i > 0 ? between : "";
        out += i < leftColumns_ ? fmt::format("{:<{}}", row[i], widths[i]) : fmt::format("{:>{}}", row[i], widths[i]);
    }
    return out;
}

std::string TextTable::asText() const {
    const auto columns = widths();
    std::string out;
    for (const auto& row : rows_)
        out += line(row, columns, "", "  ") + "\n";
    return out;
}

std::string TextTable::asMarkdown() const {
    const auto columns = widths();
    std::string out = line(rows_.front(), columns, "| ", " | ") + " |\n";
    for (std::size_t i = 0; i < columns.size(); ++i)
        out += i < leftColumns_ ? "|---" : "|---:";
    out += "|\n";
    for (std::size_t i = 1; i < rows_.size(); ++i)
        out += line(rows_[i], columns, "| ", " | ") + " |\n";
    return out;
}

std::string withGroups(std::string number) {
    const std::size_t end = std::min(number.find_first_of(".e"), number.size());
    const std::size_t first = number.starts_with('-') ? 1 : 0;
    for (std::size_t at = end; at > first + 3; at -= 3)
        number.insert(at - 3, ",");
    return number;
}

std::string grouped(std::uint64_t value) { return withGroups(std::to_string(value)); }

std::string numberOrDash(double value, int digits) { return value > 0.0 ? fmt::format("{:.{}f}", value, digits) : "-"; }

} // namespace isoslider::cli
