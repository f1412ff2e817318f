#include "ui/model/session/saved_volume.h"

#include <nlohmann/json.hpp>

#include "core/base/folders.h"
#include "ui/model/path_text.h"
#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostOptionsBytes = 1u << 20;

Json toJson(const io::RawLayout& raw) {
    return {{"dims", arrayOf(raw.dims, 3)},
            {"type", std::string(scalarTypeName(raw.type))},
            {"spacing", arrayOf(raw.spacing, 3)},
            {"skipBytes", raw.skipBytes},
            {"bigEndian", raw.isBigEndian}};
}

Json toJson(const io::ReadOptions& options) {
    Json json = Json::object();
    if (options.raw)
        json["raw"] = toJson(*options.raw);
    if (!options.field.empty())
        json["field"] = bytesText(options.field);
    if (options.component)
        json["component"] = *options.component;
    if (options.frame)
        json["frame"] = *options.frame;
    if (options.resampleDims[0] > 0)
        json["size"] = arrayOf(options.resampleDims, 3);
    if (options.allowsExternalData)
        json["allowsExternalData"] = true;
    if (options.allowsTrailing)
        json["allowsTrailing"] = true;
    return json;
}

/// Nothing without dims and type: a headerless file cannot be read by halves.
std::optional<io::RawLayout> rawFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "raw", problems);
    io::RawLayout raw;
    std::string type;
    const bool hasDims = members.dims("dims", raw.dims, 1), hasType = members.text("type", type);
    const auto scalar = hasType ? scalarTypeFromName(type) : std::nullopt;
    if (members.numbers("spacing", raw.spacing, 3) &&
        !(raw.spacing.x > 0.0 && raw.spacing.y > 0.0 && raw.spacing.z > 0.0)) {
        members.reportOf("spacing", "is not positive and ignored");
        raw.spacing = glm::dvec3(1.0);
    }
    members.integer("skipBytes", raw.skipBytes, 0, INT64_MAX);
    members.flag("bigEndian", raw.isBigEndian);
    if (!hasDims || !scalar) {
        members.reportOf("dims or type", "cannot be used");
        return std::nullopt;
    }
    raw.type = *scalar;
    return raw;
}

io::ReadOptions optionsFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "options", problems);
    io::ReadOptions options;
    if (const Json* raw = members.find("raw"))
        options.raw = rawFrom(*raw, problems);
    std::string field;
    if (members.text("field", field)) {
        const auto bytes = bytesFromText(field);
        if (bytes)
            options.field = *bytes;
        else
            members.reportOf("field", "is not valid text and is ignored");
    }
    int component = 0;
    if (members.integer("component", component, io::kMagnitude, INT32_MAX))
        options.component = component;
    std::int64_t frame = 0;
    if (members.integer("frame", frame, 0, INT64_MAX))
        options.frame = frame;
    members.dims("size", options.resampleDims, 2);
    members.flag("allowsExternalData", options.allowsExternalData);
    members.flag("allowsTrailing", options.allowsTrailing);
    return options;
}

fs::path volumeFrom(Members& volume, const fs::path& folder) {
    std::string path, relative;
    volume.text("path", path);
    volume.text("relative", relative);
    const auto absolute = bytesFromText(path), below = bytesFromText(relative);
    if (!absolute || !below)
        volume.reportOf("path", "is not valid text and is ignored");
    // What lies beside the session has moved along with it.
    if (below && !below->empty() && isPresent(folder / *below))
        return (folder / *below).lexically_normal();
    return absolute ? fs::path(*absolute) : fs::path();
}

} // namespace

Json volumeJson(const NamedVolume& volume, const fs::path& folder) {
    Json json = Json::object();
    if (!volume.sampleName.empty())
        json["sample"] = bytesText(volume.sampleName);
    if (!volume.path.empty()) {
        json["path"] = bytesText(volume.path.native());
        const fs::path relative = volume.path.lexically_relative(folder);
        if (!relative.empty() && *relative.begin() != "..")
            json["relative"] = bytesText(relative.native());
    }
    json["options"] = toJson(volume.readOptions);
    return json;
}

NamedVolume volumeFromJson(const Json& json, const fs::path& folder, const std::string& place,
                           std::vector<std::string>& problems) {
    Members members(json, place, problems);
    NamedVolume volume;
    std::string sample;
    if (members.text("sample", sample))
        volume.sampleName = bytesFromText(sample).value_or("");
    fs::path path = volumeFrom(members, folder);
    if (volume.sampleName.empty())
        volume.path = std::move(path);
    if (const Json* options = members.find("options"))
        volume.readOptions = optionsFrom(*options, problems);
    return volume;
}

std::string optionsText(const io::ReadOptions& options) { return toJson(options).dump(); }

std::optional<io::ReadOptions> optionsFromText(const std::string& text) {
    if (text.size() > kMostOptionsBytes)
        return std::nullopt;
    std::vector<std::string> problems;
    const Json json = Json::parse(text, nullptr, false);
    const auto options = optionsFrom(json, problems);
    return problems.empty() ? std::optional(options) : std::nullopt;
}

} // namespace isoslider::model
