#include "core/cell/exact_sign.h"

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cstdint>

namespace isoslider::cell {
namespace {

// Lowest and highest set bit of a finite number that is not 0.
struct BitRange {
    int low, high;
};

BitRange bitRange(double number) {
    int exponent = 0;
    const double fraction = std::frexp(std::abs(number), &exponent); // [0.5, 1)
    const auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    return {exponent - 53 + std::countr_zero(mantissa), exponent - 1};
}

// a + b = sum + what rounding has left off, exactly.
double addExactly(double a, double b, double& left) {
    const double sum = a + b, ofB = sum - a;
    left = (a - (sum - ofB)) + (b - ofB);
    return sum;
}

} // namespace

int signOfSum(std::span<const Product> products) {
    // Parts that do not overlap, the least first; each further number runs through all of them.
    std::array<double, 16> parts{};
    std::size_t count = 0;
    const auto add = [&](double number) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {
            double left = 0.0;
            number = addExactly(number, parts[i], left);
            if (left != 0.0)
                parts[kept++] = left;
        }
        if (number != 0.0)
            parts[kept++] = number;
        count = kept;
    };
    for (const Product& each : products) {
        const double product = each.a * each.b;
        add(std::fma(each.a, each.b, -product));
        add(product);
    }
    return count == 0 ? 0 : parts[count - 1] > 0.0 ? 1 : -1;
}

Lattice latticeOf(std::span<const double> numbers) {
    int low = INT_MAX, high = INT_MIN;
    for (const double number : numbers)
        if (number != 0.0) {
            const BitRange bits = bitRange(number);
            low = std::min(low, bits.low);
            high = std::max(high, bits.high);
        }
    return low == INT_MAX ? Lattice{} : Lattice{low, high - low + 1};
}

} // namespace isoslider::cell
