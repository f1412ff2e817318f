#include "ui/model/session/saved_surfaces.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "ui/model/path_text.h"
#include "ui/model/session/saved_pieces.h"

namespace isoslider::model {
namespace {

std::string colourText(const SurfaceColour& colour) {
    std::array<char, 8> text{};
    std::snprintf(text.data(), text.size(), "#%02x%02x%02x", colour[0], colour[1], colour[2]);
    return text.data();
}

std::optional<SurfaceColour> colourFrom(const std::string& text) {
    if (text.size() != 7 || text[0] != '#')
        return std::nullopt;
    SurfaceColour colour{};
    for (std::size_t part = 0; part < 3; ++part) {
        const char* const begin = text.data() + 1 + 2 * part;
        const auto read = std::from_chars(begin, begin + 2, colour[part], 16);
        if (read.ec != std::errc() || read.ptr != begin + 2)
            return std::nullopt;
    }
    return colour;
}

/// The isovalue is all that a surface must have.
std::optional<ListedSurface> surfaceFrom(const Json& json, const std::string& place,
                                         std::vector<std::string>& problems) {
    const auto report = [&](const char* what) { problems.push_back(place + what); };
    const auto find = [&](const char* name) -> const Json* {
        const auto found = json.find(name);
        return found == json.end() ? nullptr : &*found;
    };
    const Json* isovalue = json.is_object() ? find("isovalue") : nullptr;
    if (isovalue == nullptr || !isovalue->is_number() || !std::isfinite(isovalue->get<double>())) {
        report(" has no finite isovalue and is ignored");
        return std::nullopt;
    }
    ListedSurface surface;
    surface.isovalue = isovalue->get<double>();
    if (const Json* name = find("name")) {
        const auto bytes = name->is_string() ? bytesFromText(name->get<std::string>()) : std::nullopt;
        if (bytes && bytes->size() <= kMostSurfaceNameBytes)
            surface.name = *bytes;
        else
            report(", name is not a text of at most 200 bytes and is ignored");
    }
    if (const Json* colour = find("colour")) {
        if (const auto read = colour->is_string() ? colourFrom(colour->get<std::string>()) : std::nullopt)
            surface.colour = *read;
        else
            report(", colour is not like #e6d9c1 and is ignored");
    }
    if (const Json* opacity = find("opacity")) {
        const double value = opacity->is_number() ? opacity->get<double>() : -1.0;
        if (value >= kLeastOpacity && value <= 1.0)
            surface.opacity = value;
        else
            report(", opacity is not within 0.05 and 1 and is ignored");
    }
    if (const Json* visible = find("visible")) {
        if (visible->is_boolean())
            surface.isVisible = visible->get<bool>();
        else
            report(", visible is neither true nor false and ignored");
    }
    if (const Json* pieces = find("pieces")) {
        Members members(*pieces, place + ", pieces", problems);
        surface.hiddenPieces = hiddenPiecesFrom(members);
    }
    return surface;
}

} // namespace

Json surfacesJson(const SurfaceList& list) {
    Json all = Json::array();
    std::size_t active = 0;
    for (const ListedSurface& surface : list.surfaces) {
        if (surface.id == list.active)
            active = all.size();
        all.push_back({{"name", bytesText(surface.name)},
                       {"isovalue", surface.isovalue},
                       {"colour", colourText(surface.colour)},
                       {"opacity", surface.opacity},
                       {"visible", surface.isVisible}});
        if (surface.id != list.active && surface.hiddenPieces.hidesAny())
            addHiddenPieces(all.back()["pieces"], surface.hiddenPieces);
    }
    return {{"list", std::move(all)}, {"active", active}};
}

SurfaceList surfacesFromJson(const Json& json, std::vector<std::string>& problems) {
    const auto found = json.is_object() ? json.find("list") : json.end();
    if (!json.is_object() || found == json.end() || !found->is_array() || found->empty() ||
        found->size() > kMostSurfaces) {
        problems.emplace_back("surfaces is not a list of 1 to 12 surfaces and is ignored");
        return {};
    }
    const auto activeAt = json.find("active");
    const std::size_t active =
        activeAt != json.end() && activeAt->is_number_unsigned() ? activeAt->get<std::size_t>() : 0;
    SurfaceList list;
    for (std::size_t i = 0; i < found->size(); ++i) {
        auto surface = surfaceFrom((*found)[i], "surfaces, " + std::to_string(i + 1), problems);
        if (!surface)
            continue;
        surface->id = SurfaceId{static_cast<std::uint32_t>(i + 1)};
        if (i == active || list.surfaces.empty())
            list.active = surface->id;
        list.surfaces.push_back(std::move(*surface));
    }
    return list;
}

} // namespace isoslider::model
