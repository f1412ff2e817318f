#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/histogram.h"
#include "core/grid/scalar_grid.h"
#include "core/grid/value_spread.h"

namespace isoslider {

/// So many samples lie in [lower, upper); all at one value where both are equal.
struct ValueCell {
    double lower = 0.0;
    double upper = 0.0;
    std::uint64_t count = 0;
};

/// How the finite samples of a volume are spread over their values, finely enough to be drawn at any zoom and on a
/// logarithmic axis, also where a few samples lie orders of magnitude away from all others.
///
/// Invariants: 1. `cells` ascend, do not overlap, have counts above 0, and together hold all counted samples.
///             2. body.counts and `below` and `above` add up to the same.
struct ValueDistribution {
    double min = 0.0; ///< of all finite samples, counted here or not
    double max = 0.0;
    /// Samples of the volume for each one that was counted; 1: all were, and every count is exact.
    double weight = 1.0;
    /// Over the whole range: each value where isEachValue, otherwise widths in proportion to the value, below 1 % of
    /// it.
    std::vector<ValueCell> cells;
    bool isEachValue = false;
    /// Where every sample is a multiple of it, but for a common offset; 1 for whole numbers; 0: none is known.
    double spacing = 0.0;
    /// Equal bins over the range without extreme outliers and fill values. With a spacing, each bin has one value in
    /// its middle.
    Histogram body;
    std::uint64_t below = 0; ///< samples below body.min
    std::uint64_t above = 0;
    ValueSpread spread; ///< of the counted samples; all zero where it is empty

    bool isEmpty() const { return cells.empty(); }
    bool isExact() const { return weight == 1.0; }
    std::uint64_t counted() const;
};

/// Gives all samples that are to be counted, in spans, to the function; again at every call. From any number of
/// threads.
template <class Sample>
using SampleSpans = std::function<Status(const std::function<void(std::span<const Sample>)>&)>;

/// Two to five passes over the samples. Memory: below 1 MB for samples of 8 and 16 bits, up to 4 MB a thread for
/// others. `min` and `max` are those of all finite samples. Errors: those of `spans`, Cancelled.
template <class Sample>
Result<ValueDistribution> distributionOf(const SampleSpans<Sample>& spans, double min, double max,
                                         const JobControl& job = {});
/// Of a volume in memory. Empty without finite samples.
Result<ValueDistribution> distributionOf(const ScalarGrid& grid, double min, double max, const JobControl& job = {});
/// As far as a histogram over the whole range tells, where there are no samples.
ValueDistribution distributionOf(const Histogram& histogram, ScalarType type);

/// The range of values without extreme outliers and fill values: what lies beyond a gap of twice the width of all
/// others and is at most three values or 0.1 % of the samples; and the thousandth at each end that would stretch the
/// range more than tenfold. Ranges of up to 256 whole numbers and of fewer than 32 values are taken whole.
std::pair<double, double> rangeWithoutOutliers(std::span<const ValueCell> cells);

} // namespace isoslider
