#include "ui/model/surface/detail_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ui/model/isovalue/number_text.h"

namespace isoslider::model {
namespace {

constexpr std::array kCells{0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.35, 0.5, 0.7, 1.0};
constexpr std::array kPercent{0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 1.5, 2.0};

// At least, while the handle moves.
constexpr double kMovingCells = 0.5, kMovingPercent = 1.0;

} // namespace

void DetailModel::setError(const extract::MergeError& error) {
    if (!std::isfinite(error.amount) || error.amount < 0.0 || error == error_)
        return;
    error_ = error;
    changed_.notify();
}

void DetailModel::clearError() { setError({error_.measure, 0.0}); }

void DetailModel::setCoarserWhileMoving(bool isCoarser) {
    if (isCoarser == isCoarserWhileMoving_)
        return;
    isCoarserWhileMoving_ = isCoarser;
    changed_.notify();
}

void DetailModel::setMoving(bool isMoving) {
    const extract::MergeError before = usedError();
    isMoving_ = isMoving;
    if (usedError() != before)
        changed_.notify();
}

extract::MergeError DetailModel::usedError() const {
    if (!isMoving_ || !isCoarserWhileMoving_)
        return error_;
    return {error_.measure,
            std::max(2.0 * error_.amount, error_.measure == Measure::Distance ? kMovingCells : kMovingPercent)};
}

std::span<const double> DetailModel::choices(Measure measure) {
    return measure == Measure::Distance ? std::span<const double>(kCells) : std::span<const double>(kPercent);
}

std::size_t DetailModel::nearestChoice(const extract::MergeError& error) {
    const auto all = choices(error.measure);
    const auto nearest = std::min_element(all.begin(), all.end(), [&](double a, double b) {
        return std::abs(a - error.amount) < std::abs(b - error.amount);
    });
    return static_cast<std::size_t>(nearest - all.begin());
}

std::string DetailModel::text(const extract::MergeError& error) {
    if (!(error.amount > 0.0))
        return "none";
    const char* const unit = error.measure == Measure::Scalar ? " %" : error.amount == 1.0 ? " cell" : " cells";
    return valueText(error.amount, 3) + unit;
}

} // namespace isoslider::model
