#pragma once

#include <glm/vec3.hpp>

#include "core/extract/live/brick_points.h"
#include "core/extract/sources/sample_rows.h"

namespace isoslider::extract {

/// Makes a brick's points of the samples around it: its 9^3 samples as they are stored, each with its quantised normal,
/// that of gradientAt(). Several points at a time. Outside the box stand samples of the brick, and any normals;
/// the padding repeats the first sample.
/// REQUIRES: no missing sample among those that `rows` leads to.
template <class Sample>
void readPoints(const SampleRows<Sample>& rows, const glm::vec3& inverseSpacing, BrickPoints<Sample>& points);

/// The same point by point, also beside missing samples: in their places stand others of the brick.
template <class Sample>
void readPointsReference(const SampleRows<Sample>& rows, const glm::vec3& inverseSpacing, BrickPoints<Sample>& points);

} // namespace isoslider::extract
