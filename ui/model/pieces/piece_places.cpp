#include "ui/model/pieces/piece_places.h"

#include <algorithm>
#include <utility>

namespace isoslider::model {

HiddenPieces awaited(HiddenPieces hiding, const extract::SurfacePieces* known) {
    if (known != nullptr) {
        const auto pieces = known->pieces();
        const auto contains = [](const auto& ids, extract::PieceId id) {
            return std::find(ids.begin(), ids.end(), id) != ids.end();
        };
        PiecePlaces& places = hiding.awaited;
        for (const extract::Piece& piece : pieces) {
            const PiecePlace place{piece.edgeStart, piece.edgeAxis};
            if (places.hidden.size() < kMostAwaited && contains(hiding.hidden, piece.id))
                places.hidden.push_back(place);
            if (hiding.only == piece.id)
                places.only = place;
        }
    }
    hiding.hidden.clear();
    hiding.only.reset();
    return hiding;
}

HiddenPieces found(HiddenPieces hiding, const extract::SurfacePieces& pieces) {
    const PiecePlaces places = std::exchange(hiding.awaited, {});
    const auto idAt = [&](const PiecePlace& place) -> std::optional<extract::PieceId> {
        const auto piece = pieces.pieceAt(place.edgeStart, place.edgeAxis);
        return piece ? std::optional(pieces.pieces()[*piece].id) : std::nullopt;
    };
    for (const PiecePlace& place : places.hidden)
        if (const auto id = idAt(place);
            id && std::find(hiding.hidden.begin(), hiding.hidden.end(), *id) == hiding.hidden.end())
            hiding.hidden.push_back(*id);
    if (places.only)
        hiding.only = idAt(*places.only);
    return hiding;
}

} // namespace isoslider::model
