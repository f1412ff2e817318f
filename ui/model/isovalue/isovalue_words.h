#pragma once

#include <string>

namespace isoslider::model {

/// An isovalue of a volume from `min` to `max`: with `digits` significant figures, and more where a large offset leaves
/// too few to tell values of the range apart.
std::string isovalueText(double isovalue, double min, double max, int digits = 7);
/// Why an isovalue that was typed is not the one that was taken; empty if it is.
std::string clampedText(double asked, double min, double max);
/// Why one in standard deviations is not taken: of a volume of one value.
inline constexpr const char* kNoDeviationText = "All samples have one value: there is no standard deviation to go by";
/// Why there is no surface at an isovalue, and what to do. `min` and `max` are those of all samples; `hasCells`: there
/// are two samples at least along each axis.
std::string emptySurfaceText(double isovalue, double min, double max, bool hasCells = true);

} // namespace isoslider::model
