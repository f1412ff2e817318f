#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ui/model/observers.h"

namespace isoslider::model {

/// Fractions of the value range that one key press or wheel notch moves by.
inline constexpr double kFineStep = 0.001;
inline constexpr double kPageStep = 0.01;
inline constexpr double kLargePageStep = 0.1;
/// What holding Shift divides a step or a drag by.
inline constexpr double kPrecisionFactor = 10.0;

/// What one step is. `unit` 0: kFineStep of the range. With `stops`, ascending, steps lead from one to the next.
struct StepRule {
    double unit = 0.0;
    std::shared_ptr<const std::vector<double>> stops;
};

/// The isovalue the user asks for, the one on screen, and the values both may take, in data units.
/// Requested and displayed are apart on purpose: lag is shown, never hidden.
///
/// Invariants: 1. once hasDomain(), min() <= requested() <= max(), both finite.
///             2. setting an equal value notifies nobody.
class IsovalueModel {
public:
    bool hasDomain() const { return hasDomain_; }
    double min() const { return min_; }
    double max() const { return max_; }
    double requested() const { return requested_; }
    /// Isovalue of the surface on screen. Meaningful when hasDisplayed().
    double displayed() const { return displayed_; }
    bool hasDisplayed() const { return hasDisplayed_; }
    double lastUpdateMs() const { return lastUpdateMs_; }
    /// True while the surface on screen is not the one asked for.
    bool isLagging() const { return hasDisplayed_ && displayed_ != requested_; }

    /// A new value range with its first isovalue; forgets what was displayed. Notifies once.
    /// Returns false, changing nothing, unless min <= max and all three are finite.
    bool setDomain(double min, double max, double initial);
    /// As above, for the range of the same volume, known better now: what is displayed stays displayed.
    bool changeDomain(double min, double max, double isovalue);
    void clearDomain();

    /// Clamps to the range. Returns false for NaN, without a range, or when nothing changes.
    bool request(double isovalue);
    /// Moves by steps of kFineStep each, as the rule has them: to multiples of its unit, whose digits are few.
    bool step(double rangeFraction);
    /// Holds until the next one, or another range. Notifies nobody.
    void setStepRule(StepRule rule) { stepRule_ = std::move(rule); }
    const StepRule& stepRule() const { return stepRule_; }

    void setDisplayed(double isovalue, double updateMs);

    /// The isovalue that others are compared with, within the range. None at first, and of another volume.
    std::optional<double> reference() const { return reference_; }
    /// Clamps to the range; ignored without a range, and if it is not finite.
    void setReference(std::optional<double> isovalue);

    /// 0 at min, 1 at max; 0 for an empty range.
    double fraction() const;
    double atFraction(double fraction) const;

    [[nodiscard]] Subscription observe(std::function<void()> function);
    /// Only changes of requested().
    [[nodiscard]] Subscription observeRequest(std::function<void(double)> function);

private:
    double nextStop(double steps) const;
    static bool isDomain(double min, double max, double isovalue);

    double min_ = 0.0;
    double max_ = 0.0;
    double requested_ = 0.0;
    double displayed_ = 0.0;
    double lastUpdateMs_ = 0.0;
    std::optional<double> reference_;
    StepRule stepRule_;
    bool hasDomain_ = false;
    bool hasDisplayed_ = false;
    ObserverList<> changed_;
    ObserverList<double> requestChanged_;
};

} // namespace isoslider::model
