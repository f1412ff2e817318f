#pragma once

#include <memory>

#include "ui/model/colouring/colour_field.h"
#include "ui/model/colouring/colouring.h"

namespace isoslider::model {

/// All that colours of surfaces depend on.
struct SurfaceColours {
    ColourBy by = ColourBy::One;
    std::shared_ptr<const ColourField> field; ///< not null where it is by Gradient or Field
    ColourRange range;
    ColourMap map = ColourMap::Viridis;
    bool isReversed = false;

    bool operator==(const SurfaceColours&) const = default;
};

} // namespace isoslider::model
