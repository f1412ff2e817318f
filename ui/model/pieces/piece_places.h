#pragma once

#include "ui/model/pieces/piece_tints.h"

namespace isoslider::extract {
struct SurfaceFrame;
}

namespace isoslider::model {

/// The pieces that are hidden or shown alone, by places in that picture instead of by numbers, which mean nothing in
/// another run. Numbers that the picture does not know are left out, as are those beyond kMostAwaited. Without a
/// picture of pieces what was awaited stays so. O(pieces + hidden).
PieceOptions awaited(PieceOptions options, const extract::SurfaceFrame* frame);

/// The other way about, as soon as the picture has pieces: nothing is awaited any more. A place where the surface is
/// no longer is left out. O(awaited × bricks).
PieceOptions found(PieceOptions options, const extract::SurfacePieces& pieces);

} // namespace isoslider::model
