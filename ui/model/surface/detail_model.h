#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/extract/merged/merge_bound.h"
#include "ui/model/observers.h"

namespace isoslider::model {

/// How far the surface may differ from the samples' own for the sake of fewer triangles, as the error slider gives it.
class DetailModel {
public:
    using Measure = extract::MergeBound::Measure;

    const extract::MergeError& error() const { return error_; }
    /// Errors that are no finite number, or below 0, change nothing.
    void setError(const extract::MergeError& error);
    /// None, in the same measure: an error is of one volume.
    void clearError();

    /// While the handle is held, a coarser error may be used: fewer triangles to draw.
    bool isCoarserWhileMoving() const { return isCoarserWhileMoving_; }
    void setCoarserWhileMoving(bool isCoarser);
    /// Whether the handle is held.
    void setMoving(bool isMoving);
    /// What surfaces are made with now: error(), or while moving something coarser.
    extract::MergeError usedError() const;

    /// The errors that a slider offers, ascending from 0: in cells, or in percent of the value range.
    static std::span<const double> choices(Measure measure);
    /// The number of the choice that comes nearest to an error of this measure.
    static std::size_t nearestChoice(const extract::MergeError& error);
    /// "none", "0.25 cells", "0.5 %".
    static std::string text(const extract::MergeError& error);

    /// Told when error(), usedError() or isCoarserWhileMoving() have changed.
    [[nodiscard]] Subscription observe(std::function<void()> function) { return changed_.observe(std::move(function)); }

private:
    extract::MergeError error_{Measure::Distance, 0.0};
    bool isCoarserWhileMoving_ = false, isMoving_ = false;
    ObserverList<> changed_;
};

} // namespace isoslider::model
