#include "core/topology/measuring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/grid/classification.h"

namespace isoslider::topology {
namespace {

// Isovalues of each kind; cells of one surface that are looked at. The area of such a sample is off by some tenths of a
// percent.
constexpr std::size_t kIsovalues = 128;
constexpr double kMostCells = 80'000.0;

// Ranges near the ends of what doubles hold leave nothing to reckon with.
bool isMeasurable(const Histogram& histogram) {
    const double range = histogram.max - histogram.min;
    return range > 1e-290 && range < 1e290 && std::max(std::abs(histogram.min), std::abs(histogram.max)) < 1e290;
}

} // namespace

MeasurePlan planMeasures(const Histogram& histogram, std::span<const std::uint64_t> activeCells) {
    MeasurePlan plan;
    const std::size_t bins = histogram.counts.size();
    if (bins == 0 || !isMeasurable(histogram))
        return plan;
    const auto endOfBin = [&](double bin) {
        const double part = bin / static_cast<double>(bins);
        return histogram.min * (1.0 - part) + histogram.max * part;
    };
    double all = 0.0;
    for (const std::uint64_t count : histogram.counts)
        all += static_cast<double>(count);
    double before = 0.0;
    std::size_t bin = 0;
    for (std::size_t i = 0; i < kIsovalues; ++i) {
        const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(kIsovalues);
        plan.isovalues.push_back(histogram.min * (1.0 - part) + histogram.max * part);
        while (bin + 1 < bins && before + static_cast<double>(histogram.counts[bin]) < part * all)
            before += static_cast<double>(histogram.counts[bin++]);
        const double count = std::max(1.0, static_cast<double>(histogram.counts[bin]));
        plan.isovalues.push_back(
            endOfBin(static_cast<double>(bin) + std::clamp((part * all - before) / count, 0.0, 1.0)));
    }
    std::sort(plan.isovalues.begin(), plan.isovalues.end());
    plan.isovalues.erase(std::unique(plan.isovalues.begin(), plan.isovalues.end()), plan.isovalues.end());
    std::erase_if(plan.isovalues, [&](double v) { return !(v > histogram.min && v < histogram.max); });
    for (const double isovalue : plan.isovalues) {
        double cells = 0.0;
        if (!activeCells.empty()) {
            const double at = (isovalue / 2 - histogram.min / 2) / (histogram.max / 2 - histogram.min / 2) *
                              static_cast<double>(activeCells.size());
            const auto lower = std::min(activeCells.size() - 1, static_cast<std::size_t>(std::max(0.0, at)));
            const std::size_t upper = std::min(activeCells.size() - 1, lower + 1);
            cells = static_cast<double>(std::max(activeCells[lower], activeCells[upper]));
        }
        plan.shares.push_back(cells > kMostCells ? kMostCells / cells : 1.0);
    }
    return plan;
}

MeasurePlan planMeasures(const ScalarGrid& grid) {
    return grid.visit([&](auto samples) {
        const GridDims& dims = grid.dims();
        Histogram histogram;
        histogram.min = std::numeric_limits<double>::infinity();
        histogram.max = -histogram.min;
        for (const auto sample : samples)
            if (!isMissing(sample)) {
                histogram.min = std::min(histogram.min, static_cast<double>(sample));
                histogram.max = std::max(histogram.max, static_cast<double>(sample));
            }
        constexpr std::size_t kBins = 512;
        constexpr double kLooked = 200'000.0;
        histogram.counts.assign(kBins, 0);
        std::vector<std::uint64_t> active(kBins, 0);
        if (std::min({dims[0], dims[1], dims[2]}) < 2 || !isMeasurable(histogram))
            return MeasurePlan();
        const auto step =
            std::max<std::int64_t>(1, std::llround(std::cbrt(static_cast<double>(samples.size()) / kLooked)));
        const auto weight = static_cast<std::uint64_t>(step * step * step);
        const auto binOf = [&](double value) {
            const double part = (value / 2 - histogram.min / 2) / (histogram.max / 2 - histogram.min / 2);
            return std::min(kBins - 1, static_cast<std::size_t>(part * static_cast<double>(kBins)));
        };
        for (std::int64_t z = 0; z + 1 < dims[2]; z += step)
            for (std::int64_t y = 0; y + 1 < dims[1]; y += step)
                for (std::int64_t x = 0; x + 1 < dims[0]; x += step) {
                    double low = std::numeric_limits<double>::infinity(), high = -low;
                    bool isWhole = true;
                    for (std::int64_t c = 0; c < 8; ++c) {
                        const auto sample = samples[static_cast<std::size_t>(
                            x + (c & 1) + dims[0] * (y + (c >> 1 & 1) + dims[1] * (z + (c >> 2))))];
                        isWhole = isWhole && !isMissing(sample);
                        low = std::min(low, static_cast<double>(sample));
                        high = std::max(high, static_cast<double>(sample));
                    }
                    if (!isWhole)
                        continue;
                    ++histogram.counts[binOf(low)];
                    for (std::size_t bin = binOf(low) + 1; bin <= binOf(high); ++bin)
                        active[bin] += weight;
                }
        return planMeasures(histogram, active);
    });
}

} // namespace isoslider::topology
