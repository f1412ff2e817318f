#pragma once

#include "ui/model/pieces/piece_tints.h"
#include "ui/model/session/session_members.h"

namespace isoslider::model {

/// Adds what a surface hides to an object of a session: {"leastPieceSize": 0, "leastPiecePersistence": 0,
/// "largestPieces": 0, "hiddenPieces": [[x, y, z, axis]], "onlyPiece": [x, y, z, axis]}, the last two where there are
/// such. Pieces by place only, see awaited().
void addHiddenPieces(Json& json, const HiddenPieces& hidden);

/// What can be used of it.
HiddenPieces hiddenPiecesFrom(Members& members);

} // namespace isoslider::model
