#include "ui/model/session/recent_file.h"

#include <vector>

#include "ui/model/path_text.h"
#include "ui/model/session/saved_session.h"

namespace isoslider::model {
namespace {

constexpr char kSeparator = '\x1f'; // no path that a person types has it

std::string dimsText(const GridDims& dims) {
    return std::to_string(dims[0]) + 'x' + std::to_string(dims[1]) + 'x' + std::to_string(dims[2]);
}

std::string pathText(const std::filesystem::path& path) {
    const auto utf8 = path.u8string();
    return {utf8.begin(), utf8.end()};
}

} // namespace

std::string recentText(const RecentFile& file) {
    std::string text = pathText(file.path);
    if (file.hasChoices())
        text += kSeparator + optionsText(file.options) + kSeparator + bytesText(file.fieldTitle);
    return text;
}

RecentFile recentFromText(const std::string& text) {
    RecentFile file;
    const auto pathEnd = text.find(kSeparator);
    const std::string path = text.substr(0, pathEnd);
    file.path = std::filesystem::path(std::u8string(path.begin(), path.end()));
    if (pathEnd == std::string::npos)
        return file;
    const auto optionsEnd = text.find(kSeparator, pathEnd + 1);
    const auto options = optionsFromText(text.substr(pathEnd + 1, optionsEnd - pathEnd - 1));
    if (!options || optionsEnd == std::string::npos)
        return file;
    file.options = *options;
    file.fieldTitle = bytesFromText(text.substr(optionsEnd + 1)).value_or("");
    return file;
}

RecentFile recentOf(const Dataset& dataset) {
    RecentFile file{dataset.path, dataset.readOptions, {}};
    file.options.allowsExternalData = false; // is asked for again
    if (!file.options.field.empty())
        file.fieldTitle = dataset.fieldTitle;
    return file;
}

std::string choicesText(const RecentFile& file) {
    const auto& options = file.options;
    std::vector<std::string> parts;
    if (!options.field.empty())
        parts.push_back(file.fieldTitle.empty() ? options.field : file.fieldTitle);
    if (options.component)
        parts.push_back(*options.component == io::kMagnitude ? std::string("magnitude")
                                                             : "component " + std::to_string(*options.component));
    if (options.frame)
        parts.push_back("frame " + std::to_string(*options.frame));
    if (options.resampleDims[0] > 0)
        parts.push_back("resampled to " + dimsText(options.resampleDims));
    if (options.raw)
        parts.push_back(dimsText(options.raw->dims) + ' ' + std::string(scalarTypeName(options.raw->type)));
    std::string text;
    for (const auto& part : parts)
        text += (text.empty() ? "" : ", ") + part;
    return text;
}

} // namespace isoslider::model
