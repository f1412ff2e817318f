#include "ui/model/isovalue/isovalue_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ui/model/isovalue/value_steps.h"

namespace isoslider::model {

bool IsovalueModel::isDomain(double min, double max, double isovalue) {
    return std::isfinite(min) && std::isfinite(max) && std::isfinite(isovalue) && min <= max;
}

bool IsovalueModel::setDomain(double min, double max, double initial) {
    if (!isDomain(min, max, initial))
        return false;
    min_ = min;
    max_ = max;
    requested_ = std::clamp(initial, min, max);
    hasDomain_ = true;
    hasDisplayed_ = false;
    lastUpdateMs_ = 0.0;
    reference_.reset();
    stepRule_ = {};
    changed_.notify();
    return true;
}

bool IsovalueModel::changeDomain(double min, double max, double isovalue) {
    if (!hasDomain_ || !isDomain(min, max, isovalue))
        return false;
    const double requested = std::clamp(isovalue, min, max);
    if (min == min_ && max == max_ && requested == requested_)
        return true;
    min_ = min;
    max_ = max;
    requested_ = requested;
    if (reference_)
        reference_ = std::clamp(*reference_, min, max);
    changed_.notify();
    return true;
}

void IsovalueModel::clearDomain() {
    if (!hasDomain_)
        return;
    min_ = max_ = requested_ = displayed_ = lastUpdateMs_ = 0.0;
    hasDomain_ = hasDisplayed_ = false;
    reference_.reset();
    changed_.notify();
}

bool IsovalueModel::request(double isovalue) {
    if (!hasDomain_ || std::isnan(isovalue))
        return false;
    const double clamped = std::clamp(isovalue, min_, max_);
    if (clamped == requested_)
        return false;
    requested_ = clamped;
    requestChanged_.notify(clamped);
    changed_.notify();
    return true;
}

double IsovalueModel::nextStop(double steps) const {
    const auto& stops = *stepRule_.stops;
    const auto count = std::max<std::ptrdiff_t>(1, std::lround(std::min(std::abs(steps), 1e6)));
    const auto last = static_cast<std::ptrdiff_t>(stops.size()) - 1;
    const auto at = steps > 0.0 ? std::upper_bound(stops.begin(), stops.end(), requested_) - stops.begin() + count - 1
                                : std::lower_bound(stops.begin(), stops.end(), requested_) - stops.begin() - count;
    return stops[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))];
}

bool IsovalueModel::step(double rangeFraction) {
    const double steps = rangeFraction / kFineStep;
    if (stepRule_.stops && !stepRule_.stops->empty())
        return request(nextStop(steps));
    if (stepRule_.unit > 0.0) {
        // A finer step leads to multiples of that step.
        const bool isFine = std::abs(steps) < 0.999;
        const double unit = isFine ? stepRule_.unit / kPrecisionFactor : stepRule_.unit;
        return request(steppedBy(requested_, isFine ? steps * kPrecisionFactor : steps, unit));
    }
    // Halves first: max - min of a full f64 range overflows.
    return request(requested_ + 2.0 * (rangeFraction * (max_ / 2.0 - min_ / 2.0)));
}

void IsovalueModel::setDisplayed(double isovalue, double updateMs) {
    if (hasDisplayed_ && displayed_ == isovalue && lastUpdateMs_ == updateMs)
        return;
    displayed_ = isovalue;
    lastUpdateMs_ = updateMs;
    hasDisplayed_ = true;
    changed_.notify();
}

void IsovalueModel::setReference(std::optional<double> isovalue) {
    if (isovalue && (!hasDomain_ || !std::isfinite(*isovalue)))
        return;
    if (isovalue)
        isovalue = std::clamp(*isovalue, min_, max_);
    if (isovalue == reference_)
        return;
    reference_ = isovalue;
    changed_.notify();
}

double IsovalueModel::fraction() const {
    const double halfRange = max_ / 2.0 - min_ / 2.0;
    return halfRange > 0.0 ? (requested_ / 2.0 - min_ / 2.0) / halfRange : 0.0;
}

double IsovalueModel::atFraction(double fraction) const {
    return std::lerp(min_, max_, std::clamp(fraction, 0.0, 1.0));
}

Subscription IsovalueModel::observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

Subscription IsovalueModel::observeRequest(std::function<void(double)> function) {
    return requestChanged_.observe(std::move(function));
}

} // namespace isoslider::model
