#include "core/topology/measuring.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>

#include <tbb/parallel_sort.h>

#include "core/grid/classification.h"
#include "core/grid/value_distribution.h"
#include "core/topology/topology_analysis.h"

namespace isoslider::topology {
namespace {

// Isovalues of each kind; cells of one surface that are looked at. The area of such a sample is off by a few tenths of
// a percent.
constexpr std::size_t kIsovalues = 128;
constexpr std::size_t kIsovaluesBeyond = 24; // from the usual values to either end
constexpr double kMostCells = 130'000.0;
// Values that so many samples have are measured on both sides.
constexpr double kManySamples = 0.01;
constexpr std::size_t kMostJumps = 16;
// What the plan itself looks at.
constexpr std::int64_t kSlabs = 16;
constexpr double kLooked = 200'000.0;

// Ranges near the ends of what doubles hold leave nothing to reckon with.
bool isMeasurable(double least, double greatest) {
    const double range = greatest - least;
    return range > 1e-290 && range < 1e290 && std::max(std::abs(least), std::abs(greatest)) < 1e290;
}

/// Some cells of a volume.
struct LookedCells {
    std::vector<double> samples; ///< one of each
    std::vector<double> least, greatest; ///< of each, in no common order
    double weight = 1.0; ///< cells of the volume for each of them

    /// Of the volume, about.
    double active(double isovalue) const {
        const auto below = [isovalue](const std::vector<double>& values) {
            return std::lower_bound(values.begin(), values.end(), isovalue) - values.begin();
        };
        return weight * static_cast<double>(below(least) - below(greatest));
    }
};

template <class Sample>
void look(std::span<const Sample> planes, const GridDims& dims, std::int64_t stepX, std::int64_t stepY,
          LookedCells& found) {
    const std::int64_t plane = dims[0] * dims[1];
    for (std::int64_t y = 0; y + 1 < dims[1]; y += stepY)
        for (std::int64_t x = 0; x + 1 < dims[0]; x += stepX) {
            const std::int64_t first = x + dims[0] * y;
            Sample low = planes[static_cast<std::size_t>(first)], high = low;
            bool isWhole = true;
            for (std::int64_t c = 0; c < 8; ++c) {
                const Sample sample =
                    planes[static_cast<std::size_t>(first + (c & 1) + dims[0] * (c >> 1 & 1) + plane * (c >> 2))];
                isWhole = isWhole && !isMissing(sample);
                low = std::min(low, sample);
                high = std::max(high, sample);
            }
            if (!isWhole)
                continue;
            found.samples.push_back(static_cast<double>(planes[static_cast<std::size_t>(first)]));
            found.least.push_back(static_cast<double>(low));
            found.greatest.push_back(static_cast<double>(high));
        }
}

Result<LookedCells> lookAt(const PlaneSource& source, const JobControl& job) {
    const GridDims& dims = source.geometry.dims;
    LookedCells found;
    const std::int64_t slabs = std::min(kSlabs, dims[2] - 1);
    const double cells =
        static_cast<double>(slabs) * static_cast<double>(dims[0] - 1) * static_cast<double>(dims[1] - 1);
    const double skipped = std::max(1.0, cells / kLooked);
    const auto stepX = static_cast<std::int64_t>(std::sqrt(skipped));
    const std::int64_t stepY = std::llround(skipped / static_cast<double>(stepX));
    const auto countOf = [](std::int64_t points, std::int64_t step) { return (points - 2 + step) / step; };
    const auto most = static_cast<std::size_t>(slabs * countOf(dims[0], stepX) * countOf(dims[1], stepY));
    for (auto* values : {&found.samples, &found.least, &found.greatest})
        values->reserve(most);
    std::vector<std::byte> bytes(2 * static_cast<std::size_t>(dims[0] * dims[1]) * scalarTypeSizeBytes(source.type));
    for (std::int64_t slab = 0; slab < slabs; ++slab) {
        if (job.isStopRequested())
            return cancelledError();
        const std::int64_t z = (2 * slab + 1) * (dims[2] - 1) / (2 * slabs);
        ISO_TRY(source.read(z, z + 2, bytes));
        visitScalarType(source.type, [&](auto sample) {
            using Sample = decltype(sample);
            look(std::span(reinterpret_cast<const Sample*>(bytes.data()), bytes.size() / sizeof(Sample)), dims, stepX,
                 stepY, found);
        });
    }
    for (auto* values : {&found.samples, &found.least, &found.greatest})
        tbb::parallel_sort(values->begin(), values->end());
    const double all =
        static_cast<double>(dims[0] - 1) * static_cast<double>(dims[1] - 1) * static_cast<double>(dims[2] - 1);
    found.weight = std::max(1.0, all / std::max(1.0, static_cast<double>(most)));
    return found;
}

/// Each value of the samples, which ascend, and how many of them have it.
std::vector<ValueCell> runsOf(const std::vector<double>& samples) {
    std::vector<ValueCell> runs;
    for (const double sample : samples) {
        if (runs.empty() || runs.back().lower != sample)
            runs.push_back({sample, sample, 0});
        ++runs.back().count;
    }
    return runs;
}

/// Without what is rare and far away; the whole where little is left out.
std::pair<double, double> usualValues(std::span<const ValueCell> runs, double least, double greatest) {
    constexpr double kLittle = 0.05;
    auto usual = rangeWithoutOutliers(runs);
    const double little = kLittle * (usual.second - usual.first);
    if (!(usual.first - least > little))
        usual.first = least;
    if (!(greatest - usual.second > little))
        usual.second = greatest;
    return usual;
}

/// Those that at least so many samples have: those that most have.
std::vector<double> frequentValues(std::span<const ValueCell> runs, double many) {
    std::vector<ValueCell> found;
    std::copy_if(runs.begin(), runs.end(), std::back_inserter(found),
                 [many](const ValueCell& run) { return static_cast<double>(run.count) >= many; });
    std::sort(found.begin(), found.end(), [](const ValueCell& a, const ValueCell& b) {
        return a.count != b.count ? a.count > b.count : a.lower < b.lower;
    });
    std::vector<double> values;
    for (std::size_t i = 0; i < std::min(kMostJumps, found.size()); ++i)
        values.push_back(found[i].lower);
    return values;
}

} // namespace

Result<MeasurePlan> planMeasures(const PlaneSource& source, double least, double greatest, const JobControl& job) {
    MeasurePlan plan;
    const GridDims& dims = source.geometry.dims;
    if (std::min({dims[0], dims[1], dims[2]}) < 2 || !(least < greatest))
        return plan;
    const auto looked = lookAt(source, job);
    if (!looked.isOk())
        return looked.error();
    const std::vector<double>& samples = looked.value().samples;
    const std::vector<ValueCell> runs = runsOf(samples);
    plan.usual = samples.empty() ? std::pair(least, greatest) : usualValues(runs, least, greatest);
    if (!isMeasurable(plan.usual.first, plan.usual.second)) // most samples have one value: the others are what there is
        plan.usual = {least, greatest};
    const auto [low, high] = plan.usual;
    if (!isMeasurable(low, high))
        return MeasurePlan();
    const auto addEvenly = [&](double from, double to, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
            plan.isovalues.push_back(from * (1.0 - part) + to * part);
        }
    };
    addEvenly(low, high, kIsovalues);
    if (least < low && isMeasurable(least, high))
        addEvenly(least, low, kIsovaluesBeyond);
    if (high < greatest && isMeasurable(low, greatest))
        addEvenly(high, greatest, kIsovaluesBeyond);
    for (std::size_t i = 0; i < kIsovalues && !samples.empty(); ++i)
        plan.isovalues.push_back(samples[(2 * i + 1) * samples.size() / (2 * kIsovalues)]);
    for (const double value : frequentValues(runs, kManySamples * static_cast<double>(samples.size())))
        plan.isovalues.insert(plan.isovalues.end(), {value, nextAbove(value)});
    if (isMeasurable(least, high))
        plan.isovalues.push_back(nextAbove(least));
    if (isMeasurable(low, greatest))
        plan.isovalues.push_back(greatest);
    plan.least = least;
    plan.greatest = greatest;
    std::sort(plan.isovalues.begin(), plan.isovalues.end());
    plan.isovalues.erase(std::unique(plan.isovalues.begin(), plan.isovalues.end()), plan.isovalues.end());
    std::erase_if(plan.isovalues, [&](double v) { return !(v > least && v <= greatest); });
    for (const double isovalue : plan.isovalues)
        plan.shares.push_back(std::min(1.0, kMostCells / std::max(1.0, looked.value().active(isovalue))));
    return plan;
}

MeasurePlan planMeasures(const ScalarGrid& grid) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    grid.visit([&](auto samples) {
        for (const auto sample : samples)
            if (!isMissing(sample)) {
                least = std::min(least, static_cast<double>(sample));
                greatest = std::max(greatest, static_cast<double>(sample));
            }
    });
    auto plan = planMeasures(planesOf(grid), least, greatest);
    return plan.isOk() ? std::move(plan).value() : MeasurePlan(); // memory is read without errors
}

} // namespace isoslider::topology
