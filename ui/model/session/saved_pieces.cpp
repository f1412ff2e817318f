#include "ui/model/session/saved_pieces.h"

#include <cmath>
#include <cstdint>
#include <optional>

namespace isoslider::model {
namespace {

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

void takeLeast(Members& members, const char* name, double& least) {
    if (members.number(name, least) && !(std::isfinite(least) && least >= 0.0)) {
        members.reportOf(name, "cannot be used; no piece is hidden");
        least = 0.0;
    }
}

} // namespace

void addHiddenPieces(Json& json, const HiddenPieces& hidden) {
    json["leastPieceSize"] = hidden.leastSize;
    json["leastPiecePersistence"] = hidden.leastPersistence;
    json["largestPieces"] = hidden.largest;
    const PiecePlaces& places = hidden.awaited;
    if (!places.hidden.empty())
        json["hiddenPieces"] = Json::array();
    for (const PiecePlace& place : places.hidden)
        json["hiddenPieces"].push_back(toJson(place));
    if (places.only)
        json["onlyPiece"] = toJson(*places.only);
}

HiddenPieces hiddenPiecesFrom(Members& members) {
    HiddenPieces hidden;
    takeLeast(members, "leastPieceSize", hidden.leastSize);
    takeLeast(members, "leastPiecePersistence", hidden.leastPersistence);
    members.integer("largestPieces", hidden.largest, 0, kMostLargestPieces);
    hidden.awaited = placesFrom(members);
    return hidden;
}

} // namespace isoslider::model
