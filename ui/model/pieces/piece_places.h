#pragma once

#include "ui/model/pieces/piece_tints.h"

namespace isoslider::model {

/// The pieces that are hidden or shown alone, by places in a picture with these instead of by numbers, which mean
/// nothing in another run. Numbers that are not among them are left out, as are those beyond kMostAwaited. Without
/// pieces (null) what was awaited stays so. O(pieces + hidden).
HiddenPieces awaited(HiddenPieces hiding, const extract::SurfacePieces* pieces);

/// The other way about, as soon as the picture has pieces: nothing is awaited any more. A place where the surface is
/// no longer is left out. O(awaited × bricks).
HiddenPieces found(HiddenPieces hiding, const extract::SurfacePieces& pieces);

} // namespace isoslider::model
