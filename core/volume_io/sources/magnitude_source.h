#pragma once

#include <memory>
#include <vector>

#include "core/volume_io/sources/volume_source.h"

namespace isoslider::io {

/// Most components of vectors whose length is taken component by component: each keeps its file open.
inline constexpr std::size_t kMaxMagnitudeParts = 64;

/// The length of vectors whose components are volumes of one grid and type. Type: f32, or f64 of values
/// beyond 16 bits or f32. REQUIRES: at least one, at most kMaxMagnitudeParts.
std::unique_ptr<VolumeSource> makeMagnitudeSource(std::vector<std::unique_ptr<VolumeSource>> components);

} // namespace isoslider::io
