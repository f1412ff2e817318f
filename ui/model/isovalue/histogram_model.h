#pragma once

#include <cstddef>
#include <vector>

#include "core/grid/histogram.h"
#include "core/grid/scalar_type.h"
#include "core/grid/value_distribution.h"

namespace isoslider::model {

/// Lower end of a bin, in data units. `bin` may be the number of bins: the upper end of all.
double binLowerEnd(const Histogram& histogram, std::size_t bin);

/// An isovalue that shows something on first sight: the threshold that parts the samples best in
/// two classes (Otsu 1979), on damped counts so that a huge background peak does not hide a small
/// object. Always finite and within [min, max]; the middle of the range when there are no counts.
double suggestIsovalue(const Histogram& histogram);

/// As above, of a volume without its extreme outliers and fill values; a round number.
double firstIsovalue(const ValueDistribution& values);

/// The most bins that a volume's histogram can be drawn with: bins narrower than the step between
/// whole numbers would show gaps that the data do not have.
std::size_t drawableBins(const Histogram& histogram, ScalarType type);

/// The histogram as an outline to draw: bins merged so that at most `maxBins` remain.
struct HistogramOutline {
    std::vector<double> values; ///< lower end of each bin
    std::vector<double> counts;
};
HistogramOutline outlineOf(const Histogram& histogram, std::size_t maxBins);

} // namespace isoslider::model
