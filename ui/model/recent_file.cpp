#include "ui/model/recent_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace isoslider::model {
namespace {

constexpr char kSeparator = '\x1f'; // no path or name that a person types has it
constexpr std::string_view kMagnitudeName = "magnitude";

template <class Number>
std::string textOf(Number value) {
    char digits[40];
    return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

template <class Number>
bool parse(std::string_view text, Number& value) {
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    return problem == std::errc{} && end == text.data() + text.size();
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos)
            return parts;
        text.remove_prefix(end + 1);
    }
}

std::string dimsText(const GridDims& dims) {
    return textOf(dims[0]) + 'x' + textOf(dims[1]) + 'x' + textOf(dims[2]);
}

bool parseDims(std::string_view text, GridDims& dims) {
    const auto parts = split(text, 'x');
    for (std::size_t axis = 0; axis < dims.size(); ++axis)
        if (parts.size() != dims.size() || !parse(parts[axis], dims[axis]) || dims[axis] < 1 || dims[axis] > kMaxDim)
            return false;
    return true;
}

std::string rawText(const io::RawLayout& raw) {
    std::string text = dimsText(raw.dims) + ',' + std::string(scalarTypeName(raw.type)) +
                       (raw.isBigEndian ? ",big," : ",little,") + textOf(raw.skipBytes);
    for (int axis = 0; axis < 3; ++axis)
        text += ',' + textOf(raw.spacing[axis]);
    return text;
}

bool parseRaw(std::string_view text, std::optional<io::RawLayout>& out) {
    const auto parts = split(text, ',');
    io::RawLayout raw;
    if (parts.size() != 7 || !parseDims(parts[0], raw.dims) || (parts[2] != "big" && parts[2] != "little") ||
        !parse(parts[3], raw.skipBytes))
        return false;
    const auto type = std::find_if(kAllScalarTypes.begin(), kAllScalarTypes.end(),
                                   [&](ScalarType one) { return scalarTypeName(one) == parts[1]; });
    if (type == kAllScalarTypes.end())
        return false;
    raw.type = *type;
    raw.isBigEndian = parts[2] == "big";
    for (int axis = 0; axis < 3; ++axis) {
        double& spacing = raw.spacing[axis];
        if (!parse(parts[static_cast<std::size_t>(axis) + 4], spacing) || !std::isfinite(spacing) || !(spacing > 0.0))
            return false;
    }
    out = raw;
    return true;
}

bool parseComponent(std::string_view text, std::optional<int>& out) {
    int component = io::kMagnitude;
    if (text != kMagnitudeName && (!parse(text, component) || component < 0))
        return false;
    out = component;
    return true;
}

bool parseFrame(std::string_view text, std::optional<std::int64_t>& out) {
    std::int64_t frame = 0;
    if (!parse(text, frame) || frame < 0)
        return false;
    out = frame;
    return true;
}

bool takeChoice(std::string_view text, RecentFile& file) {
    const auto equals = text.find('=');
    if (equals == std::string_view::npos)
        return false;
    const std::string_view key = text.substr(0, equals), value = text.substr(equals + 1);
    auto& options = file.options;
    if (key == "field")
        options.field = value;
    else if (key == "title")
        file.fieldTitle = value;
    else if (key == "component")
        return parseComponent(value, options.component);
    else if (key == "frame")
        return parseFrame(value, options.frame);
    else if (key == "size")
        return parseDims(value, options.resampleDims);
    else if (key == "raw")
        return parseRaw(value, options.raw);
    else if (key == "trailing")
        return options.allowsTrailing = value == "allowed";
    else
        return false;
    return true;
}

std::string pathText(const std::filesystem::path& path) {
    const auto utf8 = path.u8string();
    return {utf8.begin(), utf8.end()};
}

} // namespace

std::string recentText(const RecentFile& file) {
    std::string text = pathText(file.path);
    const auto add = [&text](std::string_view key, const std::string& value) {
        text += kSeparator + std::string(key) + '=' + value;
    };
    const auto& options = file.options;
    if (!options.field.empty())
        add("field", options.field);
    if (options.component)
        add("component", *options.component == io::kMagnitude ? std::string(kMagnitudeName) : textOf(*options.component));
    if (options.frame)
        add("frame", textOf(*options.frame));
    if (options.resampleDims[0] > 0)
        add("size", dimsText(options.resampleDims));
    if (options.raw)
        add("raw", rawText(*options.raw));
    if (options.allowsTrailing)
        add("trailing", "allowed");
    if (file.hasChoices() && !file.fieldTitle.empty())
        add("title", file.fieldTitle);
    return text;
}

RecentFile recentFromText(const std::string& text) {
    const auto parts = split(text, kSeparator);
    RecentFile file;
    file.path = std::filesystem::path(std::u8string(parts[0].begin(), parts[0].end()));
    for (std::size_t i = 1; i < parts.size(); ++i)
        if (!takeChoice(parts[i], file))
            return {std::move(file.path), {}, {}};
    return file;
}

RecentFile recentOf(const Dataset& dataset) {
    RecentFile file{dataset.path, dataset.readOptions, {}};
    file.options.allowsExternalData = false; // is asked for anew
    const auto& title = dataset.fieldTitle;
    if (!file.options.field.empty() && title.find(kSeparator) == std::string::npos)
        file.fieldTitle = title;
    // A name that the settings cannot keep; then the file is remembered without.
    if (file.options.field.find(kSeparator) != std::string::npos)
        file.options = {};
    return file;
}

std::string choicesText(const RecentFile& file) {
    const auto& options = file.options;
    std::vector<std::string> parts;
    if (!options.field.empty())
        parts.push_back(file.fieldTitle.empty() ? options.field : file.fieldTitle);
    if (options.component)
        parts.push_back(*options.component == io::kMagnitude ? std::string(kMagnitudeName)
                                                             : "component " + textOf(*options.component));
    if (options.frame)
        parts.push_back("frame " + textOf(*options.frame));
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
