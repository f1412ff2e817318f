#pragma once

#include <string>

namespace isoslider::model {

/// Why an isovalue that was typed is not the one that was taken; empty if it is.
std::string clampedText(double asked, double min, double max);
/// Why there is no surface at an isovalue, and what to do. `min` and `max` are those of all samples; `hasCells`: there
/// are two samples at least along each axis.
std::string emptySurfaceText(double isovalue, double min, double max, bool hasCells = true);

} // namespace isoslider::model
