#pragma once

#include <optional>
#include <string>

#include "ui/model/observers.h"
#include "ui/model/topology/suggested_isovalue.h"

namespace isoslider::model {

/// The isovalue that a volume opens with and the reason for it, as long as the handle has not been moved away from it.
/// One that was not asked for gives way once to a better one. Window thread only.
class FirstIsovalue {
public:
    /// Of a volume that was just opened. Without a reason it was asked for, and stays. `isBest`: it stays as well.
    /// `refusal`: why this is not the one asked for, which has no value.
    void begin(SuggestedIsovalue first, bool isBest, std::string refusal = {});
    /// The handle has been moved, or the volume is gone.
    void end();
    /// It is being used: none takes its place any more. Its reason holds.
    void keep();

    /// None once the handle has been moved.
    std::optional<double> isovalue() const;
    /// Empty where there is none to show.
    std::string reason() const { return first_ ? first_->reason : std::string(); }
    /// Why it is not the one asked for, of a volume from `min` to `max`; empty if it is, or is shown no longer.
    std::string noteOnAsked(double min, double max) const;
    bool canImprove() const { return first_ && canImprove_; }
    /// Takes the place of the first one; the handle follows. Nothing unless canImprove().
    void improve(SuggestedIsovalue better);
    /// The handle has been moved there: anything but this one ends it.
    void noteRequest(double isovalue);

    const Observable<>& changed() const { return changed_; }

private:
    std::optional<SuggestedIsovalue> first_;
    std::string refusal_;
    bool canImprove_ = false;
    ObserverList<> changed_;
};

} // namespace isoslider::model
