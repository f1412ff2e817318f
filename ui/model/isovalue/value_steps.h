#pragma once

namespace isoslider::model {

/// The largest of 1, 2 or 5 times a power of ten that is at most `value`; 1e-300 for less than that.
double roundStep(double value);
/// The multiple of `step` nearest to `value`, without the digits that binary fractions bring; `value` for step 0.
double nearestMultiple(double value, double step);
/// `steps` multiples of `step` up from `value`, down if negative: from between two multiples, the first step leads to
/// the next one. Fractions of a step move by just as much.
double steppedBy(double value, double steps, double step);

} // namespace isoslider::model
