#pragma once

#include "ui/model/colouring/colouring.h"
#include "ui/model/options_model.h"
#include "ui/model/pieces/piece_tints.h"
#include "ui/model/surface/clipping.h"
#include "ui/model/surface/measurement.h"
#include "ui/model/surface/stage.h"

namespace isoslider::model {

/// What the viewport draws beside the surface.
struct ViewOptions {
    bool showsChanged = false; ///< red highlight on what the last move retriangulated: a diagnostic
    bool showsLevels = false; ///< merged cells by their size
    PieceOptions pieces; ///< of the active surface; what it hides is in the list of surfaces, too
    bool showsBox = true;
    bool showsAxes = true;
    bool showsEdges = false; ///< the triangles' edges
    bool showsReadout = true; ///< isovalue, triangles and milliseconds in a corner
    bool showsCube = true; ///< which way the world's axes point, to click on
    bool showsScaleBar = true;
    bool showsTicks = false; ///< places along three edges of the box, in units of length
    bool showsColourBar = true; ///< where values have colours
    Colouring colouring;
    Clipping clipping;
    Stage stage;
    MeasuredPlaces measured; ///< shown with the lengths between them

    bool operator==(const ViewOptions&) const = default;
};

class ViewState : public OptionsModel<ViewOptions> {};

} // namespace isoslider::model
