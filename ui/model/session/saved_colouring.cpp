#include "ui/model/session/saved_colouring.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/folders.h"
#include "ui/model/path_text.h"
#include "ui/model/session/saved_session.h"
#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace fs = std::filesystem;
namespace {

constexpr std::array<const char*, 7> kKeyNames{"one", "gradient", "x", "y", "z", "middle", "field"}; // by ColourBy
constexpr std::size_t kMostPathBytes = 4096;

Json fieldJson(const FieldFile& field, const fs::path& folder) {
    Json json{{"path", bytesText(field.path.native())}, {"options", Json::parse(optionsText(field.options))}};
    const fs::path relative = field.path.lexically_relative(folder);
    if (!relative.empty() && *relative.begin() != "..")
        json["relative"] = bytesText(relative.native());
    return json;
}

std::optional<std::string> pathBytes(const Json& json, const char* name) {
    const auto found = json.find(name);
    if (found == json.end() || !found->is_string() || found->get_ref<const std::string&>().size() > kMostPathBytes)
        return std::nullopt;
    return bytesFromText(found->get<std::string>());
}

std::optional<FieldFile> fieldFrom(const Json& json, const fs::path& folder) {
    if (!json.is_object())
        return std::nullopt;
    FieldFile field;
    const auto path = pathBytes(json, "path"), below = pathBytes(json, "relative");
    if (below && !below->empty() && isPresent(folder / *below)) // it has moved along with the session
        field.path = (folder / *below).lexically_normal();
    else if (path && !path->empty())
        field.path = fs::path(*path);
    else
        return std::nullopt;
    if (const auto options = json.find("options"); options != json.end()) {
        const auto read = optionsFromText(options->dump());
        if (!read)
            return std::nullopt;
        field.options = *read;
    }
    return field;
}

std::optional<ColourRange> rangeFrom(const Json& json) {
    if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number())
        return std::nullopt;
    const ColourRange range{json[0].get<double>(), json[1].get<double>()};
    return isUsable(range) ? std::optional(range) : std::nullopt;
}

} // namespace

Json colouringJson(const Colouring& colouring, const fs::path& folder) {
    Json json{{"by", kKeyNames[static_cast<std::size_t>(colouring.by)]},
              {"map", colourMapName(colouring.map)},
              {"reversed", colouring.isReversed}};
    if (colouring.range)
        json["range"] = {colouring.range->low, colouring.range->high};
    if (colouring.field)
        json["field"] = fieldJson(*colouring.field, folder);
    return json;
}

Colouring colouringFromJson(const Json& json, const fs::path& folder, std::vector<std::string>& problems) {
    Members members(json, "colouring", problems);
    Colouring colouring;
    std::string text;
    if (members.text("by", text)) {
        const auto found = std::find(kKeyNames.begin(), kKeyNames.end(), text);
        if (found != kKeyNames.end())
            colouring.by = kColourKeys[static_cast<std::size_t>(found - kKeyNames.begin())];
        else
            members.reportOf("by", "is not known and ignored");
    }
    if (members.text("map", text)) {
        const auto found = std::find_if(kColourMaps.begin(), kColourMaps.end(),
                                        [&](ColourMap map) { return text == colourMapName(map); });
        if (found != kColourMaps.end())
            colouring.map = *found;
        else
            members.reportOf("map", "is not known and ignored");
    }
    members.flag("reversed", colouring.isReversed);
    if (const Json* range = members.find("range")) {
        colouring.range = rangeFrom(*range);
        if (!colouring.range)
            members.reportOf("range", "is not two numbers that ascend and is ignored");
    }
    if (const Json* field = members.find("field")) {
        colouring.field = fieldFrom(*field, folder);
        if (!colouring.field)
            members.reportOf("field", "cannot be used and is ignored");
    }
    if (colouring.by == ColourBy::Field && !colouring.field)
        colouring.by = ColourBy::One;
    return colouring;
}

} // namespace isoslider::model
