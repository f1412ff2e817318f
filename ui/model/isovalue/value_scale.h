#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/value_distribution.h"

namespace isoslider::model {

enum class ScaleKind { Linear, Log, Symlog };
/// "linear", "log", "symlog".
std::string_view scaleName(ScaleKind kind);
std::optional<ScaleKind> scaleFromName(std::string_view name);

/// How values stand along the isovalue axis: evenly, by their logarithm, or by it on both sides of 0 with an even part
/// between. `place` is where on the axis; places are drawn evenly. Monotone both ways.
class ValueScale {
public:
    ValueScale() = default;
    /// `linearBelow` above 0: values closer to 0 stand about evenly on a symmetric logarithmic axis.
    explicit ValueScale(ScaleKind kind, double linearBelow = 1.0) : kind_(kind), linearBelow_(linearBelow) {}
    /// Fit for a volume. Log for values that are not all positive is Symlog.
    static ValueScale fitting(ScaleKind wanted, const ValueDistribution& values);

    ScaleKind kind() const { return kind_; }
    double placeOf(double value) const;
    double valueAt(double place) const;
    bool operator==(const ValueScale&) const = default;

    struct Tick {
        double place;
        std::string label;
    };
    /// Round values between two places, at most about `most`.
    std::vector<Tick> ticks(double lower, double upper, int most) const;

private:
    std::vector<double> tickValues(double lower, double upper, int most) const;

    ScaleKind kind_ = ScaleKind::Linear;
    double linearBelow_ = 1.0;
};

} // namespace isoslider::model
