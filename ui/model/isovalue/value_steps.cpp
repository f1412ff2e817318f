#include "ui/model/isovalue/value_steps.h"

#include <cmath>
#include <initializer_list>

namespace isoslider::model {

double roundStep(double value) {
    constexpr double kLeast = 1e-300;
    if (!(value > kLeast))
        return kLeast;
    const double power = std::floor(std::log10(value) + 1e-9);
    // Of 1e-5, which is no binary fraction, 1 / 1e5 is the nearest; 1e-5 * 2 need not be that of 2e-5.
    const auto times = [power](double digit) {
        return power < 0 && power > -300 ? digit / std::pow(10.0, -power) : digit * std::pow(10.0, power);
    };
    for (const double digit : {5.0, 2.0})
        if (times(digit) <= value * (1.0 + 1e-9))
            return times(digit);
    return times(1.0);
}

double nearestMultiple(double value, double step) {
    if (!(step > 0.0) || !std::isfinite(value))
        return value;
    const double count = std::round(value / step);
    if (!std::isfinite(count) || std::abs(count) > 1e15)
        return value;
    // Steps below 1 are one over a whole number, or a few of it: dividing gives the number that its digits name.
    const double inverse = 1.0 / step;
    const double whole = std::round(inverse);
    if (step < 1.0 && std::abs(inverse - whole) <= 1e-9 * whole && whole < 1e15)
        return count / whole + 0.0;
    return count * step + 0.0;
}

double steppedBy(double value, double steps, double step) {
    if (!(step > 0.0) || steps == 0.0)
        return value;
    constexpr double kNear = 1e-6; // of a step: rounding, not a distance
    const double whole = std::trunc(steps);
    if (whole == 0.0)
        return value + steps * step;
    const double at = value / step;
    if (!std::isfinite(at) || std::abs(at) > 1e15)
        return value + steps * step;
    const double count = steps > 0.0 ? std::floor(at + whole + kNear) : std::ceil(at + whole - kNear);
    return nearestMultiple(count * step, step);
}

} // namespace isoslider::model
