#include "ui/model/isovalue/isovalue_model.h"

#include <algorithm>
#include <cmath>

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
    changed_.notify();
    return true;
}

void IsovalueModel::clearDomain() {
    if (!hasDomain_)
        return;
    min_ = max_ = requested_ = displayed_ = lastUpdateMs_ = 0.0;
    hasDomain_ = hasDisplayed_ = false;
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

bool IsovalueModel::step(double rangeFraction) {
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
