#include "core/base/build_leftovers.h"

#include <array>
#include <string_view>

namespace isoslider {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kIndexSuffix = ".isx";
// The longer ones first: ".resume.partial" is one name, not a file ".partial" of an index "X.isx.resume".
constexpr std::array<std::string_view, 7> kSuffixes{
    ".topology.partial", ".levels.partial", ".resume.partial", ".sort.partial", ".partial", ".resume", ".levels"};

} // namespace

std::optional<fs::path> indexOfLeftover(const fs::path& file) {
    const std::string name = file.filename().string();
    for (const std::string_view suffix : kSuffixes) {
        if (!name.ends_with(suffix))
            continue;
        const std::string index = name.substr(0, name.size() - suffix.size());
        if (index.ends_with(kIndexSuffix))
            return file.parent_path() / index;
        return std::nullopt;
    }
    return std::nullopt;
}

Status checkIsNoLeftover(const fs::path& file) {
    const auto index = indexOfLeftover(file);
    if (!index)
        return {};
    return makeError(ErrorCode::InvalidArgument,
                     "is a part of the index '" + index->filename().string() +
                         "', not a volume; open that index or its volume",
                     file);
}

} // namespace isoslider
