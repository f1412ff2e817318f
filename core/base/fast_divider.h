#pragma once

#include <cstdint>
#include <limits>

namespace isoslider {

/// Divides by a number that stays the same with a multiplication, which takes a fraction of the time: by the inverse,
/// rounded up to 64 bits, which is exact for all 32-bit numbers (Lemire, Kaser, Kurz, "Faster remainder by direct
/// computation", 2019). A divisor of 0 counts as 1.
class FastDivider {
public:
    explicit constexpr FastDivider(std::uint32_t divisor = 1)
        : inverse_(divisor > 1 ? std::numeric_limits<std::uint64_t>::max() / divisor + 1 : 0) {}

    constexpr std::uint32_t quotient(std::uint32_t number) const {
        return inverse_ == 0 ? number : static_cast<std::uint32_t>(Wide{inverse_} * number >> 64);
    }

private:
    using Wide = unsigned __int128; // NOLINT: an extension that GCC and Clang share

    std::uint64_t inverse_; ///< 0: of 1, whose inverse has 65 bits
};

} // namespace isoslider
