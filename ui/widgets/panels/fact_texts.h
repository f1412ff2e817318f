#pragma once

#include <string>

#include <QString>

#include "core/extract/surface_frame.h"
#include "core/grid/grid_geometry.h"
#include "core/grid/scalar_type.h"
#include "core/volume_io/sources/volume_source.h"
#include "ui/widgets/common/small_widgets.h"
#include "ui/widgets/common/texts.h"

namespace isoslider::widgets {

/// "256 × 256 × 109"
QString dimsText(const GridDims& dims);
/// "1 × 1 × 2.5"
QString valueTriple(const glm::dvec3& v);
/// "(0, -1, 0.5)"
QString pointText(const glm::dvec3& v);
/// "u16 (unsigned integer, 16 bits)"
QString typeText(ScalarType type);

/// What a grid that is not uniform loses by being resampled; empty if it was not.
std::vector<Fact> resamplingFactsOf(const std::optional<io::ResampleReport>& report);
/// Spacing, origin, size of the box and, where they are turned, axes. `unit` may be empty: not known. `isPatient`: the
/// world's axes are a patient's, and places are stated by the patient's directions.
std::vector<Fact> placeFactsOf(const GridGeometry& geometry, const std::string& unit, bool isPatient);
/// "1,234", or "1,234 about the crop box" where the frame's surface was made there only.
QString countText(const extract::SurfaceFrame& frame, std::uint64_t count);
/// "12.5 mm²": a number in a power of the unit of length, 1 to 3; "12.5 units²" where that is not known.
QString inLengthUnit(const QString& number, const std::string& unit, int power = 1);
/// "12.5 per mm": of a gradient, whose scalars have no unit; "12.5 per unit" where that of length is not known.
QString perLengthUnit(const QString& number, const std::string& unit);

} // namespace isoslider::widgets
