#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace isoslider::cell {

/// A number in double arithmetic with a bound on its absolute error. Overflow and NaN make the error
/// infinite or NaN, and then nothing is certain. The bound covers its own rounding by a factor.
struct Bounded {
    double value = 0.0;
    double error = 0.0;

    static constexpr double kUnit = 1.2e-16; // a little above 2^-53
    static constexpr double kTiny = 1e-300; // what underflow may lose
    static Bounded rounded(double value, double error) {
        return {value, 1.0000001 * (error + kUnit * std::abs(value)) + kTiny};
    }
    /// The difference of two exact numbers.
    static Bounded difference(double a, double b) { return rounded(a - b, 0.0); }

    friend Bounded operator+(const Bounded& a, const Bounded& b) {
        return rounded(a.value + b.value, a.error + b.error);
    }
    friend Bounded operator-(const Bounded& a, const Bounded& b) {
        return rounded(a.value - b.value, a.error + b.error);
    }
    friend Bounded operator-(const Bounded& a) { return {-a.value, a.error}; }
    friend Bounded operator*(const Bounded& a, const Bounded& b) {
        return rounded(a.value * b.value,
                       std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error);
    }
    /// Infinite error when the divisor may be zero.
    friend Bounded operator/(const Bounded& a, const Bounded& b) {
        const double least = std::abs(b.value) - b.error;
        if (!(least > 0.0))
            return {0.0, std::numeric_limits<double>::infinity()};
        const double quotient = a.value / b.value;
        return rounded(quotient, (a.error + std::abs(quotient) * b.error) / least);
    }
    /// Of what may be at least zero; a negative part is taken as zero.
    friend Bounded squareRoot(const Bounded& a) {
        const double high = std::sqrt(std::max(0.0, a.value + a.error)),
                     low = std::sqrt(std::max(0.0, a.value - a.error));
        return rounded(0.5 * (high + low), 0.5 * (high - low));
    }
    bool isCertainlyPositive() const { return value > error; }
    bool isCertainlyNegative() const { return value < -error; }
};

/// Doubles as integers on one lattice: each is an integer of at most `bits` bits times 2^lowest. 0 bits when all are 0.
struct Lattice {
    int lowest = 0;
    int bits = 0;
};
/// REQUIRES: all finite.
Lattice latticeOf(std::span<const double> numbers);

struct Product {
    double a = 0.0, b = 0.0;
};
/// Whether signOfSum() is exact for products of such numbers: nothing overflows, and nothing is lost below.
inline bool isPlainFactor(double number) {
    const double size = std::abs(number);
    return size == 0.0 || (size > 0x1p-240 && size < 0x1p240);
}
/// The exact sign of a sum of products, at most 8. REQUIRES: isPlainFactor() of all factors. Without branches on the
/// numbers' exponents, and so quicker than integers on a lattice (Shewchuk 1997, expansions).
int signOfSum(std::span<const Product> products);

} // namespace isoslider::cell
