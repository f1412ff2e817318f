#pragma once

#include <array>
#include <cmath>

#include "core/cell/trilinear_cell.h"

namespace isoslider::cell {

// Decisions that plain double arithmetic settles: nearly all of them. Each asks for far more than rounding may take,
// and says nothing where that is not there. undecided_cells does the same with a cell to a lane.

inline constexpr double kFaceCertain = 1e-15; ///< of a face, over the products behind it
inline constexpr double kSaddleError = 4e-15; ///< of a saddle's isovalue, over the numbers behind it
inline constexpr double kLeadingCertain = 1e-14; ///< of a leading coefficient, over its products
inline constexpr double kCertain = 1e-9; ///< of what rules a tunnel out, over the products behind it
inline constexpr double kRateError = 1e-14; ///< of a rate of change, over its terms
inline constexpr double kIntervalError = 4e-16; ///< of an interval's end, over the numbers that it is a sum of
inline constexpr double kLessOfLine = 0.999, kLessOfParabola = 0.99; ///< of the distances found, so much is used
inline constexpr double kFarthest = 1e150;
inline constexpr double kLeastSquare = 1e-290; ///< a sum of squares below it may have lost terms
inline constexpr double kLeastSize = 1e-280, kMostSize = 1e300;
inline constexpr double kMostInteger = 0x1p24;

/// Underflow would leave nothing of products of another size; overflow and NaN make the comparison false.
inline bool isPlainSize(double size) { return size > kLeastSize && size < kMostSize; }

/// Of up to 25 bits, as samples of 8 and 16 bits are: products of two of them, or of their differences, and sums of two
/// such products fit into a double.
inline bool isSmallInteger(double x) { return std::abs(x) <= kMostInteger && x == std::nearbyint(x); }

/// Narrows to one side of a critical isovalue that is off by at most the margin; empty when that is too near, or NaN.
void narrowTo(StateInterval& interval, double isovalue, double critical, double margin);

inline constexpr int kUnknown = 2; ///< in place of a sign

/// The leading coefficients of the three quadratics of trilinear_cell.h, the sum of their products' magnitudes, and the
/// product of their signs; kUnknown where that is not certain. A difference of two scalars is off by at most a unit in
/// its last place, a product of two by three.
struct PlainLeading {
    std::array<double, 3> value{};
    std::array<double, 3> size{};
    int product = 1;
};
PlainLeading plainLeading(const CornerScalars& scalars);

/// Whether a quadratic certainly has a root outside the cell: at a face it has not the sign of its leading coefficient,
/// or its vertex lies beyond the faces (condition 1 of trilinear_cell.h). The reason is linear in the isovalue; the
/// interval is narrowed to where it lasts. REQUIRES: leading.product is not kUnknown.
bool hasRootOutside(const CornerScalars& scalars, const PlainLeading& leading, double isovalue,
                    StateInterval& interval);

/// Whether D is certainly negative (condition 2): then there is no hexagon, up to the body saddles on both sides; the
/// interval is narrowed to a little less. REQUIRES: as above.
bool hasNoHexagon(const CornerScalars& scalars, const PlainLeading& leading, double isovalue, StateInterval& interval);

} // namespace isoslider::cell
