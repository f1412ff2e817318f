#include "ui/model/isovalue/value_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ui/model/isovalue/number_text.h"
#include "ui/model/isovalue/value_steps.h"

namespace isoslider::model {
namespace {

constexpr double kLeastLog = 1e-300;

/// A power of ten: below it lies a tenth of the samples that are not 0.
double linearPartOf(const ValueDistribution& values) {
    std::vector<std::pair<double, double>> sizes;
    double all = 0.0;
    for (const ValueCell& cell : values.cells) {
        const double middle = cell.lower / 2 + cell.upper / 2;
        if (middle == 0.0 || middle < values.body.min || middle > values.body.max)
            continue;
        sizes.emplace_back(std::abs(middle), static_cast<double>(cell.count));
        all += sizes.back().second;
    }
    if (sizes.empty())
        return 1.0;
    std::sort(sizes.begin(), sizes.end());
    double before = 0.0, chosen = sizes.back().first;
    for (const auto& [size, count] : sizes)
        if ((before += count) >= 0.1 * all) {
            chosen = size;
            break;
        }
    // Six decades are more than anyone can tell apart on a screen.
    chosen = std::max(chosen, 1e-6 * sizes.back().first);
    return std::pow(10.0, std::floor(std::log10(std::max(chosen, kLeastLog))));
}

constexpr std::array<std::string_view, 3> kNames{"linear", "log", "symlog"};

} // namespace

std::string_view scaleName(ScaleKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<ScaleKind> scaleFromName(std::string_view name) {
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (kNames[i] == name)
            return static_cast<ScaleKind>(i);
    return std::nullopt;
}

ValueScale ValueScale::fitting(ScaleKind wanted, const ValueDistribution& values) {
    if (wanted == ScaleKind::Linear || values.isEmpty())
        return ValueScale();
    if (wanted == ScaleKind::Log && values.min > 0.0)
        return ValueScale(ScaleKind::Log);
    return ValueScale(ScaleKind::Symlog, linearPartOf(values));
}

double ValueScale::placeOf(double value) const {
    switch (kind_) {
        case ScaleKind::Linear: break;
        case ScaleKind::Log: return std::log10(std::max(value, kLeastLog));
        case ScaleKind::Symlog: return std::copysign(std::log10(1.0 + std::abs(value) / linearBelow_), value);
    }
    return value;
}

double ValueScale::valueAt(double place) const {
    constexpr double kMost = std::numeric_limits<double>::max();
    switch (kind_) {
        case ScaleKind::Linear: break;
        case ScaleKind::Log: return std::clamp(std::pow(10.0, place), kLeastLog, kMost);
        case ScaleKind::Symlog:
            return std::clamp(std::copysign((std::pow(10.0, std::abs(place)) - 1.0) * linearBelow_, place), -kMost,
                              kMost);
    }
    return place;
}

std::vector<double> ValueScale::tickValues(double lower, double upper, int most) const {
    std::vector<double> values;
    const double low = valueAt(lower), high = valueAt(upper);
    const double decades = upper - lower;
    if (kind_ == ScaleKind::Linear || decades < 1.0) {
        // About even, so even values will do.
        double step = roundStep((high / most - low / most));
        while ((high - low) / step > most)
            step = roundStep(step * 2.6);
        for (double value = steppedBy(low, -1.0, step); value <= high && values.size() < 100;) {
            if (value >= low)
                values.push_back(value);
            const double next = nearestMultiple(value + step, step);
            if (!(next > value))
                break;
            value = next;
        }
        return values;
    }
    const auto every = std::max(1.0, std::ceil(decades / most));
    const bool hasBetween = decades * 3.0 <= most;
    const auto addDecades = [&](double sign) {
        const double least = kind_ == ScaleKind::Log ? std::pow(10.0, std::floor(lower)) : linearBelow_;
        const double first = std::round(std::log10(least));
        for (double power = first; power <= 308.0; power += every)
            for (const double digit : {1.0, 2.0, 5.0}) {
                if (digit > 1.0 && !hasBetween)
                    continue;
                const double size = power < 0.0 ? digit / std::pow(10.0, -power) : digit * std::pow(10.0, power);
                const double value = sign * size;
                if (std::isfinite(value) && value >= low && value <= high)
                    values.push_back(value);
                if (size > std::max(std::abs(low), std::abs(high)))
                    return;
            }
    };
    if (kind_ == ScaleKind::Symlog) {
        addDecades(-1.0);
        if (low <= 0.0 && high >= 0.0)
            values.push_back(0.0);
    }
    addDecades(1.0);
    std::sort(values.begin(), values.end());
    return values;
}

std::vector<ValueScale::Tick> ValueScale::ticks(double lower, double upper, int most) const {
    std::vector<Tick> ticks;
    if (!(upper > lower) || most < 1)
        return ticks;
    for (const double value : tickValues(lower, upper, most))
        ticks.push_back({placeOf(value), valueText(value, 9)});
    return ticks;
}

} // namespace isoslider::model
