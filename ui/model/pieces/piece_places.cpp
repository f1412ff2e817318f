#include "ui/model/pieces/piece_places.h"

#include <algorithm>
#include <utility>

#include "core/extract/surface_frame.h"

namespace isoslider::model {

PieceOptions awaited(PieceOptions options, const extract::SurfaceFrame* frame) {
    if (frame != nullptr && frame->pieces) {
        const auto pieces = frame->pieces->pieces();
        const auto contains = [](const auto& ids, extract::PieceId id) {
            return std::find(ids.begin(), ids.end(), id) != ids.end();
        };
        PiecePlaces& places = options.awaited;
        for (const extract::Piece& piece : pieces) {
            const PiecePlace place{piece.edgeStart, piece.edgeAxis};
            if (places.hidden.size() < kMostAwaited && contains(options.hidden, piece.id))
                places.hidden.push_back(place);
            if (options.only == piece.id)
                places.only = place;
        }
    }
    options.hidden.clear();
    options.only.reset();
    options.selected.reset();
    return options;
}

PieceOptions found(PieceOptions options, const extract::SurfacePieces& pieces) {
    const PiecePlaces places = std::exchange(options.awaited, {});
    const auto idAt = [&](const PiecePlace& place) -> std::optional<extract::PieceId> {
        const auto piece = pieces.pieceAt(place.edgeStart, place.edgeAxis);
        return piece ? std::optional(pieces.pieces()[*piece].id) : std::nullopt;
    };
    for (const PiecePlace& place : places.hidden)
        if (const auto id = idAt(place);
            id && std::find(options.hidden.begin(), options.hidden.end(), *id) == options.hidden.end())
            options.hidden.push_back(*id);
    if (places.only)
        options.only = idAt(*places.only);
    return options;
}

} // namespace isoslider::model
