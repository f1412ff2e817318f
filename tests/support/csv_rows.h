#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace isoslider::test {

/// Calls visit(columns) for each line of a file of values with commas between, the line of names left out; columns are
/// read with >>.
template <class Visit>
void forEachCsvRow(const std::filesystem::path& path, const Visit& visit) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line); // names
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream columns(line);
        visit(columns);
    }
}

} // namespace isoslider::test
