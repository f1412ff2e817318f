#include "ui/model/session/saved_view.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <glm/geometric.hpp>

#include "ui/model/session/session_members.h"

namespace isoslider::model {
namespace {

struct OptionName {
    const char* name;
    bool ViewOptions::*member;
};
constexpr std::array<OptionName, 9> kOptionNames{{{"changed", &ViewOptions::showsChanged},
                                                  {"edges", &ViewOptions::showsEdges},
                                                  {"levels", &ViewOptions::showsLevels},
                                                  {"box", &ViewOptions::showsBox},
                                                  {"axes", &ViewOptions::showsAxes},
                                                  {"readout", &ViewOptions::showsReadout},
                                                  {"cube", &ViewOptions::showsCube},
                                                  {"scaleBar", &ViewOptions::showsScaleBar},
                                                  {"colourBar", &ViewOptions::showsColourBar}}};

constexpr std::array<const char*, 3> kCapNames{"none", "colour", "values"}; // by Cap

Json toJson(const Clipping& clipping) {
    const ClipPlane& plane = clipping.plane;
    Json json{{"cropped", clipping.isCropped},
              {"plane",
               {{"on", plane.isOn},
                {"normal", arrayOf(plane.normal, 3)},
                {"offset", plane.offset},
                {"cap", kCapNames[static_cast<std::size_t>(plane.cap)]}}}};
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

Json toJson(const PiecePlace& place) {
    Json json = arrayOf(place.edgeStart, 3);
    json.push_back(place.edgeAxis);
    return json;
}

std::optional<PiecePlace> placeFrom(const Json& json) {
    PiecePlace place;
    if (!json.is_array() || json.size() != 4)
        return std::nullopt;
    for (std::size_t k = 0; k < 4; ++k) {
        if (!Members::isWithin(json[k], 0, k < 3 ? kMaxDim - 1 : 2))
            return std::nullopt;
        (k < 3 ? place.edgeStart[k] : place.edgeAxis) = json[k].get<std::int32_t>();
    }
    return place;
}

PiecePlaces placesFrom(Members& members) {
    PiecePlaces places;
    if (const Json* hidden = members.find("hiddenPieces")) {
        bool isGood = hidden->is_array() && hidden->size() <= kMostAwaited;
        for (std::size_t k = 0; isGood && k < hidden->size(); ++k) {
            const auto place = placeFrom((*hidden)[k]);
            isGood = place.has_value();
            places.hidden.push_back(place.value_or(PiecePlace()));
        }
        if (!isGood) {
            members.reportOf("hiddenPieces", "is not a list of edges of the grid; no piece is hidden");
            places.hidden.clear();
        }
    }
    if (const Json* only = members.find("onlyPiece")) {
        places.only = placeFrom(*only);
        if (!places.only)
            members.reportOf("onlyPiece", "is not an edge of the grid and is ignored");
    }
    return places;
}

Clipping clippingFrom(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "view, clipping", problems);
    Clipping clipping;
    members.flag("cropped", clipping.isCropped);
    CropBox box;
    const bool hasLow = members.dims("low", box.low, 0), hasHigh = members.dims("high", box.high, 1);
    if (hasLow && hasHigh)
        clipping.crop = box; // brought within the volume once that is open
    if (const Json* planeJson = members.find("plane")) {
        Members plane(*planeJson, "view, clipping, plane", problems);
        plane.flag("on", clipping.plane.isOn);
        if (plane.numbers("normal", clipping.plane.normal, 3) && !(glm::length(clipping.plane.normal) > 0.0)) {
            plane.reportOf("normal", "has no direction and is ignored");
            clipping.plane.normal = ClipPlane().normal;
        }
        plane.number("offset", clipping.plane.offset);
        choose(plane, "cap", kCapNames, clipping.plane.cap);
    }
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
    Json json{{"pieces", view.pieces.isColoured},     {"leastPieceSize", view.pieces.leastSize},
              {"largestPieces", view.pieces.largest}, {"clipping", toJson(view.clipping)},
              {"stage", toJson(view.stage)},          {"measured", Json::array()}};
    for (const auto& [name, member] : kOptionNames)
        json[name] = view.*member;
    const PiecePlaces& places = view.pieces.awaited;
    if (!places.hidden.empty())
        json["hiddenPieces"] = Json::array();
    for (const PiecePlace& place : places.hidden)
        json["hiddenPieces"].push_back(toJson(place));
    if (places.only)
        json["onlyPiece"] = toJson(*places.only);
    for (const glm::dvec3& place : view.measured)
        json["measured"].push_back({place.x, place.y, place.z});
    return json;
}

ViewOptions viewFromJson(const Json& json, std::vector<std::string>& problems) {
    Members members(json, "view", problems);
    ViewOptions view;
    for (const auto& [name, member] : kOptionNames)
        members.flag(name, view.*member);
    PieceOptions& pieces = view.pieces;
    members.flag("pieces", pieces.isColoured);
    if (members.number("leastPieceSize", pieces.leastSize) &&
        !(std::isfinite(pieces.leastSize) && pieces.leastSize >= 0.0)) {
        members.reportOf("leastPieceSize", "cannot be used; no piece is hidden");
        pieces.leastSize = 0.0;
    }
    int largest = 0;
    if (members.integer("largestPieces", largest, 0, kMostLargestPieces))
        pieces.largest = static_cast<std::uint32_t>(largest);
    pieces.awaited = placesFrom(members);
    if (const Json* clipping = members.find("clipping"))
        view.clipping = clippingFrom(*clipping, problems);
    if (const Json* stage = members.find("stage"))
        view.stage = stageFrom(*stage, problems);
    members.places("measured", view.measured);
    return view;
}

} // namespace isoslider::model
