#include "ui/model/isovalue/first_isovalue.h"

#include <utility>

namespace isoslider::model {

void FirstIsovalue::begin(SuggestedIsovalue first, bool isBest) {
    canImprove_ = !isBest && !first.reason.empty();
    first_ = std::move(first);
    changed_.notify();
}

void FirstIsovalue::end() {
    canImprove_ = false;
    if (!first_)
        return;
    first_.reset();
    changed_.notify();
}

void FirstIsovalue::keep() { canImprove_ = false; }

std::optional<double> FirstIsovalue::isovalue() const {
    return first_ ? std::optional(first_->isovalue) : std::nullopt;
}

void FirstIsovalue::improve(SuggestedIsovalue better) {
    if (!canImprove())
        return;
    first_ = std::move(better);
    canImprove_ = false;
    changed_.notify();
}

void FirstIsovalue::noteRequest(double isovalue) {
    if (first_ && first_->isovalue != isovalue)
        end();
}

} // namespace isoslider::model
