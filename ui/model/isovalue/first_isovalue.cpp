#include "ui/model/isovalue/first_isovalue.h"

#include <utility>

#include "ui/model/isovalue/isovalue_words.h"

namespace isoslider::model {

void FirstIsovalue::begin(SuggestedIsovalue first, bool isBest, std::string refusal) {
    canImprove_ = !isBest && !first.reason.empty();
    refusal_ = std::move(refusal);
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

std::string FirstIsovalue::noteOnAsked(double min, double max) const {
    if (!first_)
        return {};
    return refusal_.empty() ? clampedText(first_->isovalue, min, max) : refusal_;
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
