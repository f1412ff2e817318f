#pragma once

#include <optional>

namespace isoslider::model {

/// A length to compare others with.
struct ScaleBar {
    double length = 1.0; ///< 1, 2 or 5 times a power of ten
    double pixels = 1.0; ///< that it takes on the screen
};

/// The longest that takes at most `mostPixels`: at least two fifths of them. None where lengths have no meaning: a
/// number is not finite or not positive, or too large or small for any volume.
std::optional<ScaleBar> scaleBarOf(double lengthPerPixel, double mostPixels);

} // namespace isoslider::model
