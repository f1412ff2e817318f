#include "core/volume_io/formats/tiff/tiff_folder.h"

#include <algorithm>
#include <string_view>

#include "core/base/folders.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxFiles = 65536;

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// "slice9" before "slice10"; numbers by their size, all else by its bytes.
bool isBefore(const std::string& a, const std::string& b) {
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (!isDigit(a[i]) || !isDigit(b[j])) {
            if (a[i] != b[j])
                return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
            ++i;
            ++j;
            continue;
        }
        const auto number = [](const std::string& text, std::size_t& at) {
            while (at < text.size() && text[at] == '0')
                ++at;
            const std::size_t begin = at;
            while (at < text.size() && isDigit(text[at]))
                ++at;
            return std::string_view(text).substr(begin, at - begin);
        };
        const std::string_view n = number(a, i), m = number(b, j);
        if (n.size() != m.size())
            return n.size() < m.size();
        if (n != m)
            return n < m;
    }
    return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

bool hasTiffName(const fs::path& path) {
    const std::string name = lowerCase(path.filename().string());
    return name.ends_with(".tif") || name.ends_with(".tiff");
}

} // namespace

Result<std::vector<fs::path>> tiffFilesOf(const fs::path& folder) {
    auto listed = listFiles(folder);
    if (!listed.isOk())
        return std::move(listed).error();
    std::vector<fs::path> files = std::move(listed).value();
    std::erase_if(files, [](const fs::path& file) { return !hasTiffName(file); });
    if (files.size() > kMaxFiles)
        return makeError(ErrorCode::InvalidArgument, "holds more than " + std::to_string(kMaxFiles) + " files", folder);
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
        return isBefore(a.filename().string(), b.filename().string());
    });
    return files;
}

std::int64_t numberInName(const fs::path& path) {
    const std::string name = path.stem().string();
    std::size_t end = name.size();
    while (end > 0 && !isDigit(name[end - 1]))
        --end;
    std::size_t begin = end;
    while (begin > 0 && isDigit(name[begin - 1]))
        --begin;
    return end - begin > 15 ? -1 : parseInteger(std::string_view(name).substr(begin, end - begin)).value_or(-1);
}

bool isTiff(const fs::path& path, std::span<const std::byte> start) {
    if (isFolder(path)) {
        const auto files = tiffFilesOf(path);
        return files.isOk() && !files.value().empty();
    }
    constexpr std::string_view kMagics[] = {{"II*\0", 4}, {"MM\0*", 4}, {"II+\0", 4}, {"MM\0+", 4}};
    const std::string_view text(reinterpret_cast<const char*>(start.data()), std::min<std::size_t>(4, start.size()));
    return std::ranges::find(kMagics, text) != std::end(kMagics);
}

} // namespace isoslider::io
