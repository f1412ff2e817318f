#include "ui/model/session/saved_view.h"

#include <array>

#include <glm/geometric.hpp>

#include "ui/model/session/saved_pieces.h"
#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace {

struct OptionName {
    const char* name;
    bool ViewOptions::*member;
};
constexpr std::array<OptionName, 10> kOptionNames{{{"changed", &ViewOptions::showsChanged},
                                                   {"edges", &ViewOptions::showsEdges},
                                                   {"levels", &ViewOptions::showsLevels},
                                                   {"box", &ViewOptions::showsBox},
                                                   {"axes", &ViewOptions::showsAxes},
                                                   {"readout", &ViewOptions::showsReadout},
                                                   {"cube", &ViewOptions::showsCube},
                                                   {"scaleBar", &ViewOptions::showsScaleBar},
                                                   {"ticks", &ViewOptions::showsTicks},
                                                   {"colourBar", &ViewOptions::showsColourBar}}};

constexpr std::array<const char*, 3> kCapNames{"none", "colour", "values"}; // by Cap

constexpr std::array<const char*, kClipPlanes> kPlaneNames{"plane", "secondPlane"};

Json toJson(const ClipPlane& plane) {
    return {{"on", plane.isOn},
            {"normal", arrayOf(plane.normal, 3)},
            {"offset", plane.offset},
            {"cap", kCapNames[static_cast<std::size_t>(plane.cap)]}};
}

void takePlane(const Json& json, const char* name, ClipPlane& plane, std::vector<std::string>& problems) {
    Members members(json, std::string("view, clipping, ") + name, problems);
    const glm::dvec3 normal = plane.normal;
    members.flag("on", plane.isOn);
    if (members.numbers("normal", plane.normal, 3) && !(glm::length(plane.normal) > 0.0)) {
        members.reportOf("normal", "has no direction and is ignored");
        plane.normal = normal;
    }
    members.number("offset", plane.offset);
    choose(members, "cap", kCapNames, plane.cap);
}

Json toJson(const Clipping& clipping) {
    Json json{{"cropped", clipping.isCropped}, {"activePlane", clipping.active}};
    for (std::size_t place = 0; place < kClipPlanes; ++place)
        json[kPlaneNames[place]] = toJson(clipping.planes[place]);
    if (clipping.crop) {
        json["low"] = arrayOf(clipping.crop->low, 3);
        json["high"] = arrayOf(clipping.crop->high, 3);
    }
    return json;
}

Json toJson(const Stage& stage) {
    return {{"background", kBackgroundNames[static_cast<std::size_t>(stage.background)]},
            {"light", kLightNames[static_cast<std::size_t>(stage.light)]},
            {"occlusion", stage.hasOcclusion},
            {"stretch", arrayOf(stage.stretch, 3)}};
}

Clipping clippingFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "view, clipping", problems);
    Clipping clipping;
    members.flag("cropped", clipping.isCropped);
    CropBox box;
    const bool hasLow = members.dims("low", box.low, 0), hasHigh = members.dims("high", box.high, 1);
    if (hasLow && hasHigh)
        clipping.crop = box; // brought within the volume once that is open
    for (std::size_t place = 0; place < kClipPlanes; ++place)
        if (const Json* plane = members.find(kPlaneNames[place]))
            takePlane(*plane, kPlaneNames[place], clipping.planes[place], problems);
    members.integer("activePlane", clipping.active, 0, static_cast<int>(kClipPlanes) - 1);
    return clipping;
}

Stage stageFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "view, stage", problems);
    Stage stage;
    choose(members, "background", kBackgroundNames, stage.background);
    choose(members, "light", kLightNames, stage.light);
    members.flag("occlusion", stage.hasOcclusion);
    if (members.numbers("stretch", stage.stretch, 3) && stretchWithin(stage.stretch) != stage.stretch) {
        members.reportOf("stretch", "is not within 0.001 and 1000 and is brought there");
        stage.stretch = stretchWithin(stage.stretch);
    }
    return stage;
}

} // namespace

Json viewJson(const ViewOptions& view) {
    Json json{{"pieces", view.pieces.isColoured},
              {"clipping", toJson(view.clipping)},
              {"stage", toJson(view.stage)},
              {"measured", Json::array()}};
    for (const auto& [name, member] : kOptionNames)
        json[name] = view.*member;
    addHiddenPieces(json, view.pieces);
    for (const glm::dvec3& place : view.measured)
        json["measured"].push_back({place.x, place.y, place.z});
    return json;
}

ViewOptions viewFromJson(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "view", problems);
    ViewOptions view;
    for (const auto& [name, member] : kOptionNames)
        members.flag(name, view.*member);
    members.flag("pieces", view.pieces.isColoured);
    view.pieces.hiddenPieces() = hiddenPiecesFrom(members);
    if (const Json* clipping = members.find("clipping"))
        view.clipping = clippingFrom(*clipping, problems);
    if (const Json* stage = members.find("stage"))
        view.stage = stageFrom(*stage, problems);
    members.places("measured", view.measured);
    return view;
}

} // namespace isoslider::model
