#include "core/topology/analysis/strip_measures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/matrix.hpp>

#include "core/grid/scalar_type.h"
#include "core/topology/analysis/cell_batches.h"

namespace isoslider::topology {
namespace {

// How many isovalues a scalar reaches: a table to begin with, then a look at the next ones.
class IsovalueFinder {
public:
    explicit IsovalueFinder(const std::vector<double>& isovalues) : isovalues_(isovalues) {
        least_ = isovalues.front();
        scale_ = static_cast<double>(kParts) / (isovalues.back() - least_);
        for (std::size_t i = 0, k = 0; i <= kParts; ++i) {
            while (k < isovalues.size() && (isovalues[k] - least_) * scale_ < static_cast<double>(i))
                ++k;
            start_[i] = static_cast<std::uint32_t>(k);
        }
    }
    std::size_t reached(double scalar) const {
        const double part = (scalar - least_) * scale_;
        if (!(part >= 0.0))
            return 0;
        if (!(part < static_cast<double>(kParts)))
            return firstBeyond(start_[kParts], isovalues_.size(), scalar);
        const auto at = static_cast<std::size_t>(part);
        return firstBeyond(start_[at], start_[at + 1], scalar);
    }

private:
    // Between these two, but for rounding. All may lie in one part, where a few lie far away.
    std::size_t firstBeyond(std::size_t from, std::size_t to, double scalar) const {
        const auto begin = isovalues_.begin();
        auto k = static_cast<std::size_t>(std::upper_bound(begin + static_cast<std::ptrdiff_t>(from),
                                                           begin + static_cast<std::ptrdiff_t>(to), scalar) -
                                          begin);
        while (k > 0 && isovalues_[k - 1] > scalar)
            --k;
        while (k < isovalues_.size() && isovalues_[k] <= scalar)
            ++k;
        return k;
    }

    static constexpr std::size_t kParts = 4096;
    const std::vector<double>& isovalues_;
    double least_, scale_;
    std::array<std::uint32_t, kParts + 1> start_{};
};

// Cells spread evenly whatever their number: multiples of three irrational numbers (Roberts' R3 sequence).
std::uint32_t rankOf(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint32_t>(x) * 3518319153u + static_cast<std::uint32_t>(y) * 2882110345u +
           static_cast<std::uint32_t>(z) * 2360945575u;
}

} // namespace

void MeasureSums::add(const MeasureSums& other) {
    sums.resize(other.sums.size());
    cellsAbove.resize(other.cellsAbove.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        sums[i].add(other.sums[i]);
    for (std::size_t i = 0; i < cellsAbove.size(); ++i)
        cellsAbove[i] += other.cellsAbove[i];
}

MeasureCurves MeasureSums::curves(const MeasurePlan& plan, const GridGeometry& geometry) const {
    MeasureCurves curves;
    if (sums.empty())
        return curves;
    const double cell =
        std::abs(glm::determinant(geometry.direction) * geometry.spacing.x * geometry.spacing.y * geometry.spacing.z);
    const CellBatches batches(plan, geometry);
    curves.isovalues = plan.isovalues;
    curves.measures.resize(plan.isovalues.size());
    double whole = 0.0; // cells above the isovalue
    for (std::size_t i = plan.isovalues.size(); i-- > 0;) {
        whole += static_cast<double>(cellsAbove[i + 1]);
        const auto finite = [](double value) { return std::isfinite(value) ? value : 0.0; };
        const BatchSum others = batches.measured(2 * i, sums[2 * i]),
                       usual = batches.measured(2 * i + 1, sums[2 * i + 1]);
        const double weight = CellBatches::weight(plan.shares[i]), area = others.area + usual.area;
        // One sample that is orders of magnitude away has cells so steep that no mean would tell of any other.
        const double gradient = usual.area > 0.0 ? usual.gradient / usual.area
                                : area > 0.0     ? (others.gradient + usual.gradient) / area
                                                 : 0.0;
        curves.measures[i] = {finite(weight * area), finite(cell * (whole + weight * (others.volume + usual.volume))),
                              weight * (others.triangles + usual.triangles), finite(gradient)};
    }
    // Nothing is there of the surface at the least sample, nor beyond the greatest.
    whole += static_cast<double>(cellsAbove[0]);
    curves.isovalues.insert(curves.isovalues.begin(), plan.least);
    curves.measures.insert(curves.measures.begin(), {0.0, cell * whole, 0.0, 0.0});
    curves.isovalues.push_back(curves.isovalues.back() < plan.greatest ? plan.greatest : nextAbove(plan.greatest));
    curves.measures.push_back({});
    return curves;
}

template <class Sample>
MeasureSums measureStrip(const LayerWindow<Sample>& window, const Strip& strip, const MeasurePlan& plan,
                         const GridGeometry& geometry) {
    MeasureSums found;
    if (plan.isovalues.empty())
        return found;
    found.cellsAbove.resize(plan.isovalues.size() + 1);
    const IsovalueFinder finder(plan.isovalues);
    CellBatches batches(plan, geometry);
    const std::uint32_t lastRank = CellBatches::lastRank(*std::max_element(plan.shares.begin(), plan.shares.end()));
    const std::int64_t nx = window.dims[0], row = window.rowStep(), plane = window.planeStep();
    std::vector<Sample> least(static_cast<std::size_t>(nx)), most(least.size());
    std::vector<MeasuredCell> cells; // of a row
    cells.reserve(least.size());
    for (std::int64_t z = window.zBegin; z < window.zEnd; ++z)
        for (std::int64_t y = strip.yBegin; y < strip.yEnd && !window.stop.stop_requested(); ++y) {
            const std::int64_t start = row * y + plane * (z - window.zBegin);
            const Sample* const s = window.layer() + start;
            if (window.isFlat(y, z)) {
                found.cellsAbove[finder.reached(static_cast<double>(*s))] += static_cast<std::uint64_t>(nx - 1);
                continue;
            }
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                const auto pair = [&](std::int64_t at, auto pick) { return pick(s[at + x], s[at + x + 1]); };
                const auto four = [&](auto pick) {
                    return pick(pick(pair(0, pick), pair(row, pick)), pick(pair(plane, pick), pair(plane + row, pick)));
                };
                least[static_cast<std::size_t>(x)] = four([](Sample a, Sample b) { return std::min(a, b); });
                most[static_cast<std::size_t>(x)] = four([](Sample a, Sample b) { return std::max(a, b); });
            }
            cells.clear();
            for (std::int64_t x = 0; x + 1 < nx; ++x) {
                if ((window.stars[static_cast<std::size_t>(start + x)] & 0x80) == 0)
                    continue;
                const auto high = static_cast<double>(most[static_cast<std::size_t>(x)]);
                const auto low = static_cast<double>(least[static_cast<std::size_t>(x)]);
                const std::size_t first = finder.reached(low);
                ++found.cellsAbove[first];
                const std::uint32_t rank = rankOf(x, y, z);
                if (rank > lastRank || first == plan.isovalues.size() || high < plan.isovalues[first])
                    continue;
                MeasuredCell& cell = cells.emplace_back();
                for (std::int64_t c = 0; c < 8; ++c)
                    cell.scalars[static_cast<std::size_t>(c)] =
                        static_cast<double>(s[x + (c & 1) + row * (c >> 1 & 1) + plane * (c >> 2)]);
                cell.rank = rank;
                cell.first = static_cast<std::uint32_t>(first);
                cell.end = static_cast<std::uint32_t>(finder.reached(high));
                cell.isUsual = low >= plan.usual.first && high <= plan.usual.second;
            }
            batches.add(cells);
        }
    found.sums = batches.finish();
    return found;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template MeasureSums measureStrip(const LayerWindow<Sample>&, const Strip&, const MeasurePlan&, \
                                      const GridGeometry&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::topology
