#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace isoslider::topology {

/// What the surface measures at one isovalue, in units of the volume's spacing.
struct SurfaceMeasures {
    double area = 0.0;
    double volume = 0.0; ///< of what is above the isovalue
    double triangles = 0.0;
    /// Mean gradient magnitude on the surface, without cells at extreme outliers or fill values: scalars per length.
    double gradient = 0.0;
};

/// The next double, between which and `value` there is no isovalue.
inline double nextAbove(double value) { return std::nextafter(value, std::numeric_limits<double>::infinity()); }

/// The same at isovalues that ascend, from the least sample, at which there is no surface yet, to the greatest or just
/// beyond; between them linear. The surface jumps just above a value that many samples have.
struct MeasureCurves {
    std::vector<double> isovalues;
    std::vector<SurfaceMeasures> measures; ///< one for each isovalue

    bool isEmpty() const { return isovalues.empty(); }
    /// Whether the surface jumps from isovalue i to the next one, with none in between.
    bool jumpsAfter(std::size_t i) const { return isovalues[i + 1] == nextAbove(isovalues[i]); }
    /// O(log n). Beyond the ends that of the end.
    SurfaceMeasures at(double isovalue) const;
};

} // namespace isoslider::topology
