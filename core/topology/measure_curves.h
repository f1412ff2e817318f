#pragma once

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

/// The same at isovalues that ascend, the first and last of which are the least and greatest sample; between them
/// linear.
struct MeasureCurves {
    std::vector<double> isovalues;
    std::vector<SurfaceMeasures> measures; ///< one for each isovalue

    bool isEmpty() const { return isovalues.empty(); }
    /// O(log n). Beyond the ends that of the end.
    SurfaceMeasures at(double isovalue) const;
};

} // namespace isoslider::topology
