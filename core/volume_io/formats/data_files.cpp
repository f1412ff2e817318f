#include "core/volume_io/formats/data_files.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/folders.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;

Result<std::vector<std::string>> expandPattern(std::string_view value, std::string_view field, const fs::path& header) {
    const auto parts = words(value);
    if (parts.size() != 4)
        return refuseField(field, "a pattern takes first, last and step, found " + inQuotes(value), header);
    const std::string_view pattern = parts[0];
    const auto percent = pattern.find('%');
    const auto conversion = pattern.find('d', percent);
    const std::string_view width = percent == std::string_view::npos || conversion == std::string_view::npos
                                       ? std::string_view("bad")
                                       : pattern.substr(percent + 1, conversion - percent - 1);
    const auto digits = width.empty() ? std::optional<std::int64_t>(0) : parseInteger(width);
    const auto first = parseInteger(parts[1]), last = parseInteger(parts[2]), step = parseInteger(parts[3]);
    if (!digits || *digits < 0 || *digits > 20 || pattern.find('%', percent + 1) != std::string_view::npos)
        return refuseField(field, inQuotes(pattern) + " is not a pattern with one %d", header);
    constexpr std::int64_t kBound = std::int64_t{1} << 40;
    const auto isBounded = [](const auto& number) { return number && *number >= -kBound && *number <= kBound; };
    if (!isBounded(first) || !isBounded(last) || !isBounded(step) || *step == 0 || (*last - *first) / *step < 0 ||
        (*last - *first) / *step >= static_cast<std::int64_t>(kMaxDataFiles))
        return refuseField(field, "the range " + inQuotes(trimmed(value.substr(pattern.size()))) + " is not usable",
                           header);
    std::vector<std::string> names;
    for (std::int64_t i = 0; i <= (*last - *first) / *step; ++i) {
        std::string number = std::to_string(*first + i * *step);
        if (number.size() < static_cast<std::size_t>(*digits))
            number.insert(0, static_cast<std::size_t>(*digits) - number.size(), width[0] == '0' ? '0' : ' ');
        names.push_back(std::string(pattern.substr(0, percent)) + number + std::string(pattern.substr(conversion + 1)));
    }
    return names;
}

Result<std::vector<FilePart>> locateDataFiles(const std::vector<std::string>& names, std::string_view field,
                                              const fs::path& header, bool allowsExternal) {
    if (names.empty())
        return refuseField(field, "the list of files is empty", header);
    if (names.size() > kMaxDataFiles)
        return refuseField(field, "the list names more than 65536 files", header);
    std::vector<FilePart> parts;
    parts.reserve(names.size());
    for (const std::string& name : names) {
        fs::path beside = header.parent_path() / name;
        // A file beside the header, under its own name, needs no links followed: lists are long.
        const bool isBeside =
            name.find('/') == std::string::npos && name != ".." && name != header.filename() && isPlainFile(beside);
        if (isBeside) {
            parts.push_back({std::move(beside), 0});
            continue;
        }
        auto file = resolveDataFile(header, name, field, allowsExternal);
        if (!file.isOk())
            return std::move(file).error();
        if (isSameFile(file.value(), header))
            return refuseField(field, inQuotes(name) + " is the header itself", header);
        parts.push_back({std::move(file).value(), 0});
    }
    return parts;
}

std::vector<fs::path> filesBeside(const fs::path& opened, const std::vector<FilePart>& parts) {
    std::vector<fs::path> files;
    for (const FilePart& part : parts)
        if (part.path != opened)
            files.push_back(part.path);
    return files;
}

std::vector<fs::path> filesInFolder(std::vector<fs::path> slices) {
    constexpr std::size_t kMostBytes = std::size_t{8} << 20;
    std::sort(slices.begin(), slices.end());
    slices.erase(std::unique(slices.begin(), slices.end()), slices.end());
    std::size_t bytes = 0;
    for (const fs::path& slice : slices)
        bytes += slice.native().size() + 8;
    if (bytes > kMostBytes)
        slices.clear();
    return slices;
}

} // namespace isoslider::io
