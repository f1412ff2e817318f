#include "core/grid/volume_statistics.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "core/grid/classification.h"
#include "core/grid/distinct_keys.h"

namespace isoslider {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 20;

template <class T>
struct Range {
    T min = std::numeric_limits<T>::max();
    T max = std::numeric_limits<T>::lowest();
    std::uint64_t missing = 0;

    void add(T value) {
        if (isMissing(value)) {
            ++missing;
            return;
        }
        min = std::min(min, value);
        max = std::max(max, value);
    }
    void merge(const Range& other) {
        min = std::min(min, other.min);
        max = std::max(max, other.max);
        missing += other.missing;
    }
};

template <class T>
Range<T> findRange(std::span<const T> values) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, values.size(), kGrain), Range<T>{},
        [&](const auto& part, Range<T> range) {
            for (std::size_t i = part.begin(); i != part.end(); ++i)
                range.add(values[i]);
            return range;
        },
        [](Range<T> a, const Range<T>& b) {
            a.merge(b);
            return a;
        });
}

/// Counts every value of an 8- or 16-bit type: distinct values and histogram come from this alone.
template <class T>
std::vector<std::uint64_t> countEach(std::span<const T> values) {
    using Counts = std::vector<std::uint64_t>;
    constexpr std::size_t kValues = std::size_t{1} << (8 * sizeof(T));
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, values.size(), kGrain), Counts(kValues, 0),
        [&](const auto& part, Counts counts) {
            for (std::size_t i = part.begin(); i != part.end(); ++i)
                ++counts[static_cast<std::make_unsigned_t<T>>(values[i])];
            return counts;
        },
        [](Counts a, const Counts& b) {
            for (std::size_t i = 0; i < a.size(); ++i)
                a[i] += b[i];
            return a;
        });
}

template <class T>
std::uint64_t countDistinct(std::span<const T> values) {
    constexpr std::size_t kSpan = 4096;
    DistinctKeys<T> distinct(values.size_bytes());
    do {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kSpan),
                          [&](const auto& part) { distinct.add(values.subspan(part.begin(), part.size())); });
    } while (!distinct.endPass());
    return distinct.count();
}

/// Bins of equal width over [min, max]; the top end belongs to the last bin.
class Binning {
public:
    // Halved: max - min of doubles may overflow.
    Binning(double min, double max, std::size_t bins) : min_(min), half_(max / 2 - min / 2), bins_(bins) {}
    std::size_t operator()(double value) const {
        if (!(half_ > 0.0))
            return 0;
        const double fraction = (value / 2 - min_ / 2) / half_;
        return std::min(static_cast<std::size_t>(fraction * static_cast<double>(bins_)), bins_ - 1);
    }

private:
    double min_;
    double half_;
    std::size_t bins_;
};

template <class T>
std::vector<std::uint64_t> fillBins(std::span<const T> values, const Binning& binning, std::size_t bins) {
    using Counts = std::vector<std::uint64_t>;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, values.size(), kGrain), Counts(bins, 0),
        [&](const auto& part, Counts counts) {
            for (std::size_t i = part.begin(); i != part.end(); ++i)
                if (!isMissing(values[i]))
                    ++counts[binning(static_cast<double>(values[i]))];
            return counts;
        },
        [](Counts a, const Counts& b) {
            for (std::size_t i = 0; i < a.size(); ++i)
                a[i] += b[i];
            return a;
        });
}

template <class T>
void fillFromCounts(std::span<const T> values, VolumeStatistics& out, const Binning& binning) {
    const auto counts = countEach(values);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == 0)
            continue;
        ++out.distinctValues;
        const auto value = static_cast<double>(static_cast<T>(static_cast<std::make_unsigned_t<T>>(i)));
        out.histogram.counts[binning(value)] += counts[i];
    }
}

template <class T>
Result<VolumeStatistics> statisticsOf(std::span<const T> values, bool countsDistinct, std::size_t bins,
                                      const JobControl& job) {
    const Range<T> range = findRange(values);
    if (range.missing == values.size())
        return makeError(ErrorCode::InvalidArgument, "has no finite sample");
    if (job.isStopRequested())
        return cancelledError();
    job.report(0.2, "statistics");
    VolumeStatistics out;
    out.min = static_cast<double>(range.min) + 0.0; // never -0
    out.max = static_cast<double>(range.max) + 0.0;
    out.nanCount = range.missing;
    out.histogram.min = out.min;
    out.histogram.max = out.max;
    const Binning binning(out.min, out.max, bins);
    if constexpr (sizeof(T) <= 2) {
        out.histogram.counts.assign(bins, 0);
        fillFromCounts(values, out, binning);
        if (!countsDistinct)
            out.distinctValues = 0;
    } else {
        out.histogram.counts = fillBins(values, binning, bins);
        if (job.isStopRequested())
            return cancelledError();
        job.report(0.4, "statistics");
        if (countsDistinct)
            out.distinctValues = countDistinct(values);
    }
    job.report(1.0, "statistics");
    return out;
}

} // namespace

Result<VolumeStatistics> computeStatistics(const ScalarGrid& grid, bool countsDistinct, int histogramBins,
                                           const JobControl& job) {
    if (histogramBins < 1)
        return makeError(ErrorCode::InvalidArgument, "a histogram needs at least one bin");
    if (grid.bytes().empty())
        return makeError(ErrorCode::InvalidArgument, "has no finite sample");
    return grid.visit([&](auto values) {
        return statisticsOf(values, countsDistinct, static_cast<std::size_t>(histogramBins), job);
    });
}

} // namespace isoslider
