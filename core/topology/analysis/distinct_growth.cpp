#include "core/topology/analysis/distinct_growth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace isoslider::topology {
namespace {

// Of some of the cubes: every `step`-th, from `first` on.
double distinctIn(const std::vector<std::vector<double>>& cubes, std::size_t first, std::size_t step) {
    std::vector<double> all;
    for (std::size_t i = first; i < cubes.size(); i += step)
        all.insert(all.end(), cubes[i].begin(), cubes[i].end());
    std::sort(all.begin(), all.end());
    return static_cast<double>(std::unique(all.begin(), all.end()) - all.begin());
}

double meanDistinctIn(const std::vector<std::vector<double>>& cubes, std::size_t step) {
    double sum = 0.0;
    for (std::size_t first = 0; first < step; ++first)
        sum += distinctIn(cubes, first, step);
    return sum / static_cast<double>(step);
}

} // namespace

// Where values repeat twice the volume has less than twice as many: by how much is seen where a quarter, half and all
// of the cubes are compared, and goes on like that.
double distinctInAll(const std::vector<std::vector<double>>& cubes, double factor) {
    const double quarter = meanDistinctIn(cubes, 4), half = meanDistinctIn(cubes, 2), all = meanDistinctIn(cubes, 1);
    if (!(quarter > 0.0))
        return factor * all;
    const double before = std::log2(half / quarter), now = std::log2(all / half);
    const double slowing = before > 0.0 ? std::sqrt(std::clamp(now / before, 0.25, 1.0)) : 1.0;
    double exponent = 0.0, growth = std::clamp(now, 0.0, 1.0), doublings = std::log2(std::max(1.0, factor));
    for (; doublings > 0.0; doublings -= 1.0) {
        growth *= slowing;
        exponent += growth * std::min(doublings, 1.0);
    }
    return all * std::exp2(exponent);
}

} // namespace isoslider::topology
