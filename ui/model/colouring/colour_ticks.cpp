#include "ui/model/colouring/colour_ticks.h"

#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr double kRounding = 1e-9; // of a step: an end that is a round number has its tick
constexpr double kMostSteps = 1e12; // from 0 to an end: beyond, a step has too few digits

} // namespace

std::vector<ColourTick> colourTicks(double low, double high, int most) {
    std::vector<ColourTick> ticks;
    const double span = high - low;
    if (!(span > 0.0) || !std::isfinite(span))
        return ticks;
    const double power = std::floor(std::log10(span / most));
    for (int next = 0; next < 6; ++next) { // 1, 2, 5, 10, 20, 50
        const double step = std::pow(10.0, power + (next < 3 ? 0.0 : 1.0)) * (next % 3 == 0   ? 1.0
                                                                              : next % 3 == 1 ? 2.0
                                                                                              : 5.0);
        const double first = std::ceil(low / step - kRounding), last = std::floor(high / step + kRounding);
        if (!(step > 0.0) || std::abs(first) > kMostSteps || std::abs(last) > kMostSteps)
            return ticks;
        if (last - first + 1.0 > most)
            continue;
        for (double n = first; n <= last; n += 1.0) {
            const double value = n == 0.0 ? 0.0 : n * step; // no minus before it
            ticks.push_back({value, resolvedText(value, step)});
        }
        return ticks;
    }
    return ticks;
}

} // namespace isoslider::model
