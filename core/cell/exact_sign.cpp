#include "core/cell/exact_sign.h"

#include <algorithm>
#include <bit>
#include <climits>

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

} // namespace

int lowestExponent(std::span<const double> numbers) {
    int low = INT_MAX;
    for (const double number : numbers)
        if (number != 0.0)
            low = std::min(low, bitRange(number).low);
    return low == INT_MAX ? 0 : low;
}

std::optional<std::array<std::int64_t, 9>> onCommonLattice(std::span<const double> numbers, int bits) {
    const int low = lowestExponent(numbers);
    for (const double number : numbers)
        if (number != 0.0 && bitRange(number).high - low >= bits)
            return std::nullopt;
    std::array<std::int64_t, 9> lattice{};
    for (std::size_t i = 0; i < numbers.size(); ++i)
        lattice[i] = static_cast<std::int64_t>(std::ldexp(numbers[i], -low));
    return lattice;
}

} // namespace isoslider::cell
