#include "core/grid/value_distribution.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <unordered_map>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/grid/classification.h"
#include "core/grid/scalar_key.h"

namespace isoslider {
namespace {

using Counts = std::vector<std::uint64_t>;

constexpr std::size_t kGrain = std::size_t{1} << 18;
constexpr int kCellShift = 45; // of 52 bits of a significand 7 remain: 128 cells from a power of two to the next
constexpr double kMostWholeValues = 1 << 17; // counted one by one
constexpr std::size_t kMostDistinct = 4096; // the same of real values
constexpr std::size_t kBodyBins = 8192;
constexpr double kMostSpacedBins = 1 << 17;
constexpr std::size_t kLeastCells = 32;
constexpr double kSmallRange = 255.0;
constexpr double kGapOverRest = 2.0;
constexpr double kFewValues = 3;
constexpr double kFewSamples = 0.001;
constexpr double kStretch = 10.0;

std::uint64_t cellOf(double value) { return keyOf(value) >> kCellShift; }

double lowerEndOf(std::uint64_t cell) { return sampleOfKey<double>(cell << kCellShift); }

/// Each thread has separate counts, one per cell; summed in the end.
class ThreadCounts {
public:
    explicit ThreadCounts(std::size_t size) : counts_(size, 0), parts_([size] { return Counts(size, 0); }) {}
    Counts& local() { return parts_.local(); }
    const Counts& sum() {
        for (const Counts& part : parts_)
            for (std::size_t i = 0; i < part.size(); ++i)
                counts_[i] += part[i];
        parts_.clear();
        return counts_;
    }

private:
    Counts counts_;
    tbb::enumerable_thread_specific<Counts> parts_;
};

/// Counts each value until there are too many different ones.
class DistinctCounter {
public:
    void add(double value) {
        if (isFull_)
            return;
        if (value == last_ && lastCount_ != nullptr) {
            ++*lastCount_;
            return;
        }
        const auto [place, isNew] = counts_.try_emplace(value + 0.0, 0);
        last_ = value;
        lastCount_ = &place->second;
        ++place->second;
        if (isNew && counts_.size() > kMostDistinct)
            giveUp();
    }
    void merge(const DistinctCounter& other) {
        isFull_ = isFull_ || other.isFull_;
        for (const auto& [value, count] : other.counts_)
            counts_[value] += count;
        if (isFull_ || counts_.size() > kMostDistinct)
            giveUp();
    }
    /// Empty if there are too many.
    std::vector<ValueCell> cells() const {
        std::vector<ValueCell> cells;
        for (const auto& [value, count] : counts_)
            cells.push_back({value, value, count});
        std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.lower < b.lower; });
        return cells;
    }

private:
    void giveUp() {
        isFull_ = true;
        counts_.clear();
        lastCount_ = nullptr;
    }
    std::unordered_map<double, std::uint64_t> counts_;
    double last_ = 0.0;
    std::uint64_t* lastCount_ = nullptr;
    bool isFull_ = false;
};

template <class Sample>
Result<std::vector<ValueCell>> countWholeValues(const SampleSpans<Sample>& spans, double min, double max) {
    const auto first = static_cast<std::int64_t>(min);
    ThreadCounts counts(static_cast<std::size_t>(max - min) + 1);
    ISO_TRY(spans([&](std::span<const Sample> samples) {
        Counts& local = counts.local();
        for (const Sample sample : samples)
            ++local[static_cast<std::size_t>(static_cast<std::int64_t>(sample) - first)];
    }));
    std::vector<ValueCell> cells;
    const Counts& sum = counts.sum();
    for (std::size_t i = 0; i < sum.size(); ++i)
        if (sum[i] > 0)
            cells.push_back({min + static_cast<double>(i), min + static_cast<double>(i), sum[i]});
    return cells;
}

/// Each value if they are few, cells of about 1 % otherwise.
template <class Sample>
Status countCells(const SampleSpans<Sample>& spans, ValueDistribution& out) {
    const std::uint64_t first = cellOf(out.min);
    ThreadCounts counts(static_cast<std::size_t>(cellOf(out.max) - first) + 1);
    tbb::enumerable_thread_specific<DistinctCounter> distinct;
    tbb::enumerable_thread_specific<SpreadSum> sums;
    ISO_TRY(spans([&](std::span<const Sample> samples) {
        Counts& local = counts.local();
        DistinctCounter& values = distinct.local();
        sums.local().add(samples);
        for (const Sample sample : samples) {
            if (isMissing(sample))
                continue;
            ++local[static_cast<std::size_t>(cellOf(static_cast<double>(sample)) - first)];
            values.add(static_cast<double>(sample));
        }
    }));
    out.spread = SpreadSum::spreadOfAll(sums);
    DistinctCounter all;
    for (const DistinctCounter& part : distinct)
        all.merge(part);
    out.cells = all.cells();
    out.isEachValue = !out.cells.empty();
    if (out.isEachValue)
        return {};
    const Counts& sum = counts.sum();
    for (std::size_t i = 0; i < sum.size(); ++i)
        if (sum[i] > 0)
            out.cells.push_back({std::max(out.min, lowerEndOf(first + i)), lowerEndOf(first + i + 1), sum[i]});
    if (!out.cells.empty())
        out.cells.back().upper = std::min(out.cells.back().upper, std::nextafter(out.max, HUGE_VAL));
    return {};
}

/// As if all samples of a cell were in its middle.
ValueSpread spreadOfCells(std::span<const ValueCell> cells) {
    SpreadSum sum;
    for (const ValueCell& cell : cells)
        sum.add(cell.lower / 2.0 + cell.upper / 2.0, cell.count);
    return sum.spread();
}

/// What all values are multiples of, but for the first as offset; 0 if nothing.
double spacingOf(std::span<const ValueCell> values) {
    double spacing = HUGE_VAL, largest = 0.0;
    bool areWhole = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
        areWhole = areWhole && values[i].lower == std::round(values[i].lower);
        largest = std::max(largest, std::abs(values[i].lower));
        if (i > 0)
            spacing = std::min(spacing, values[i].lower - values[i - 1].lower);
    }
    if (areWhole)
        return 1.0;
    if (values.size() < 3 || !(spacing > 1e-5 * largest)) // of rounded values the least gap says little
        return 0.0;
    for (const ValueCell& value : values) {
        const double steps = (value.lower - values.front().lower) / spacing;
        if (std::abs(steps - std::round(steps)) > 0.02)
            return 0.0;
    }
    const double steps = std::round((values.back().lower - values.front().lower) / spacing);
    return (values.back().lower - values.front().lower) / steps;
}

class Bins {
public:
    Bins(double lower, double upper, std::size_t count)
        : lower_(lower), upper_(upper), count_(count), half_(upper / 2 - lower / 2) {}
    /// Nothing for values outside; the upper end belongs to the last bin.
    std::optional<std::size_t> binOf(double value) const {
        if (value < lower_ || value > upper_)
            return std::nullopt;
        if (!(half_ > 0.0))
            return 0;
        const double share = (value / 2 - lower_ / 2) / half_;
        return std::min(static_cast<std::size_t>(share * static_cast<double>(count_)), count_ - 1);
    }

private:
    double lower_, upper_;
    std::size_t count_;
    double half_;
};

void addToBody(const Bins& bins, double value, std::uint64_t count, ValueDistribution& out) {
    if (const auto bin = bins.binOf(value))
        out.body.counts[*bin] += count;
    else
        (value < out.body.min ? out.below : out.above) += count;
}

void beginBody(double lower, double upper, std::size_t bins, ValueDistribution& out) {
    out.body.min = lower;
    out.body.max = upper;
    out.body.counts.assign(bins, 0);
    out.below = out.above = 0;
}

void fillBodyFromValues(ValueDistribution& out) {
    const auto [lower, upper] = rangeWithoutOutliers(out.cells);
    std::vector<ValueCell> within;
    std::copy_if(out.cells.begin(), out.cells.end(), std::back_inserter(within),
                 [lower = lower, upper = upper](const auto& c) { return c.lower >= lower && c.lower <= upper; });
    out.spacing = spacingOf(within); // a fill value need not be a multiple
    if (!std::isfinite(upper - lower)) // of more than a number can hold, steps cannot be counted
        out.spacing = 0.0;
    double bins = out.spacing > 0.0 ? std::round((upper - lower) / out.spacing) + 1.0 : 0.0;
    if (bins > 0.0) {
        // More whole numbers than can be drawn share bins.
        const double shared = std::ceil(bins / kMostSpacedBins);
        const double begin = lower - out.spacing / 2.0;
        bins = std::ceil(bins / shared);
        beginBody(begin, begin + bins * shared * out.spacing, static_cast<std::size_t>(bins), out);
    } else {
        beginBody(lower, upper, kBodyBins, out);
    }
    const Bins places(out.body.min, out.body.max, out.body.counts.size());
    for (const ValueCell& cell : out.cells)
        addToBody(places, cell.lower, cell.count, out);
}

template <class Sample>
Status fillBody(const SampleSpans<Sample>& spans, double lower, double upper, ValueDistribution& out) {
    beginBody(lower, upper, kBodyBins, out);
    const Bins bins(lower, upper, kBodyBins);
    ThreadCounts counts(kBodyBins + 2);
    ISO_TRY(spans([&](std::span<const Sample> samples) {
        Counts& local = counts.local();
        for (const Sample sample : samples) {
            if (isMissing(sample))
                continue;
            const auto value = static_cast<double>(sample);
            const auto bin = bins.binOf(value);
            ++local[bin ? *bin : value < lower ? kBodyBins : kBodyBins + 1];
        }
    }));
    const Counts& sum = counts.sum();
    std::copy_n(sum.begin(), kBodyBins, out.body.counts.begin());
    out.below = sum[kBodyBins];
    out.above = sum[kBodyBins + 1];
    return {};
}

/// Cells are as wide as their values are large: where all are close together, their ends are found in the bins.
template <class Sample>
Status fillBodyClosely(const SampleSpans<Sample>& spans, ValueDistribution& out, const JobControl& job) {
    auto [lower, upper] = rangeWithoutOutliers(out.cells);
    lower = std::max(lower, out.min);
    upper = std::min(upper, out.max);
    // What was not counted may lie a little further out.
    const double width = upper - lower;
    if (out.max - upper < width / 2.0)
        upper = out.max;
    if (lower - out.min < width / 2.0)
        lower = out.min;
    for (int round = 0;; ++round) {
        ISO_TRY(fillBody(spans, lower, upper, out));
        if (job.isStopRequested())
            return cancelledError();
        const auto& counts = out.body.counts;
        const auto isFilled = [](std::uint64_t count) { return count > 0; };
        const auto first = std::find_if(counts.begin(), counts.end(), isFilled) - counts.begin();
        const auto end = counts.rend() - std::find_if(counts.rbegin(), counts.rend(), isFilled);
        if (first >= end || end - first > static_cast<std::ptrdiff_t>(kBodyBins / 4) || round == 3)
            return {};
        const double bin = (upper - lower) / static_cast<double>(kBodyBins);
        upper = std::min(upper, lower + bin * static_cast<double>(end));
        lower += bin * static_cast<double>(first);
    }
}

/// The value below which `share` of the samples lie, about.
double quantile(std::span<const ValueCell> cells, std::size_t leftOut, double share) {
    std::uint64_t all = 0, before = 0;
    for (std::size_t i = 0; i < cells.size(); ++i)
        all += i == leftOut ? 0 : cells[i].count;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        before += i == leftOut ? 0 : cells[i].count;
        if (static_cast<double>(before) >= share * static_cast<double>(all))
            return share < 0.5 ? cells[i].lower : cells[i].upper;
    }
    return cells.back().upper;
}

/// Cells that are no single values hold thousands of them.
bool hasManyValues(std::span<const ValueCell> cells) {
    return cells.size() >= kLeastCells ||
           std::any_of(cells.begin(), cells.end(), [](const ValueCell& c) { return c.lower < c.upper; });
}

/// Cuts off what lies beyond the widest gap, if it may be; false if nothing was.
bool cutAtGap(std::span<const ValueCell>& cells) {
    std::size_t at = 0;
    double widest = 0.0;
    for (std::size_t i = 0; i + 1 < cells.size(); ++i)
        if (const double gap = cells[i + 1].lower - cells[i].upper; gap > widest) {
            widest = gap;
            at = i + 1;
        }
    const auto countOf = [](std::span<const ValueCell> part) {
        double count = 0.0;
        for (const ValueCell& cell : part)
            count += static_cast<double>(cell.count);
        return count;
    };
    const auto low = cells.first(at), high = cells.subspan(at);
    const double all = countOf(cells);
    const auto mayGo = [&](std::span<const ValueCell> part, std::span<const ValueCell> rest) {
        return hasManyValues(rest) && countOf(rest) > kFewSamples * all &&
               widest > kGapOverRest * (rest.back().upper - rest.front().lower) &&
               (static_cast<double>(part.size()) <= kFewValues || countOf(part) <= kFewSamples * all);
    };
    if (at == 0)
        return false;
    if (mayGo(low, high))
        cells = high;
    else if (mayGo(high, low))
        cells = low;
    else
        return false;
    return true;
}

} // namespace

std::uint64_t ValueDistribution::counted() const {
    std::uint64_t all = 0;
    for (const ValueCell& cell : cells)
        all += cell.count;
    return all;
}

std::pair<double, double> rangeWithoutOutliers(std::span<const ValueCell> cells) {
    if (cells.empty())
        return {0.0, 0.0};
    const auto isWhole = [](const ValueCell& c) { return c.lower == c.upper && c.lower == std::round(c.lower); };
    const bool isSmall = cells.back().upper - cells.front().lower <= kSmallRange;
    if (!hasManyValues(cells) || (isSmall && std::all_of(cells.begin(), cells.end(), isWhole)))
        return {cells.front().lower, cells.back().upper};
    while (cutAtGap(cells)) {}
    double lower = cells.front().lower, upper = cells.back().upper;
    // The most frequent value, air or a background, would hide how all others are spread.
    const auto most = std::max_element(cells.begin(), cells.end(), [](auto& a, auto& b) { return a.count < b.count; });
    const auto leftOut = static_cast<std::size_t>(most - cells.begin());
    const double low = quantile(cells, leftOut, kFewSamples), high = quantile(cells, leftOut, 1.0 - kFewSamples);
    const double width = high - low;
    if (width > 0.0 && upper / kStretch - lower / kStretch > width) {
        const double mostFrequent = most->lower;
        lower = std::max(lower, std::min(mostFrequent, low - width));
        upper = std::min(upper, std::max(most->upper, high + width));
    }
    return {lower, upper};
}

template <class Sample>
Result<ValueDistribution> distributionOf(const SampleSpans<Sample>& spans, double min, double max,
                                         const JobControl& job) {
    ValueDistribution out;
    out.min = min;
    out.max = max;
    bool isCounted = false;
    if constexpr (std::is_integral_v<Sample>) {
        if (max - min < kMostWholeValues) {
            auto cells = countWholeValues(spans, min, max);
            if (!cells.isOk())
                return cells.error();
            out.cells = std::move(cells).value();
            out.isEachValue = isCounted = true;
            out.spread = spreadOfCells(out.cells);
        }
    }
    if (!isCounted)
        ISO_TRY(countCells(spans, out));
    if (job.isStopRequested())
        return cancelledError();
    job.report(0.5, "Counting values");
    if (out.isEachValue && !out.cells.empty()) {
        fillBodyFromValues(out);
    } else if (!out.cells.empty()) {
        if constexpr (std::is_integral_v<Sample>)
            out.spacing = 1.0;
        ISO_TRY(fillBodyClosely(spans, out, job));
    }
    job.report(1.0, "Counting values");
    return out;
}

Result<ValueDistribution> distributionOf(const ScalarGrid& grid, double min, double max, const JobControl& job) {
    return grid.visit([&](auto values) {
        using Sample = std::remove_cv_t<typename decltype(values)::element_type>;
        const SampleSpans<Sample> spans = [&](const std::function<void(std::span<const Sample>)>& take) -> Status {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kGrain), [&](const auto& part) {
                if (!job.isStopRequested())
                    take(values.subspan(part.begin(), part.size()));
            });
            return job.isStopRequested() ? Status(cancelledError()) : Status();
        };
        return distributionOf<Sample>(spans, min, max, job);
    });
}

ValueDistribution distributionOf(const Histogram& histogram, ScalarType type) {
    ValueDistribution out;
    out.min = histogram.min;
    out.max = histogram.max;
    out.body = histogram;
    const std::size_t bins = histogram.counts.size();
    for (std::size_t bin = 0; bin < bins; ++bin) {
        if (histogram.counts[bin] == 0)
            continue;
        const auto end = [&](std::size_t b) {
            return std::lerp(out.min, out.max, static_cast<double>(b) / static_cast<double>(bins));
        };
        out.cells.push_back({end(bin), end(bin + 1), histogram.counts[bin]});
    }
    out.spacing = isFloatType(type) ? 0.0 : 1.0;
    out.spread = spreadOfCells(out.cells);
    out.spread.isExact = false; // within half a bin
    return out;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template Result<ValueDistribution> distributionOf(const SampleSpans<Sample>&, double, double, const JobControl&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider
