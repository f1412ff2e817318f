#pragma once

namespace isoslider::index {

/// Differences near 0, of either sign, as small numbers: 0, -1, 1, -2 become 0, 1, 2, 3. `Bits` is unsigned and holds a
/// difference modulo its range.
template <class Bits>
Bits zigzag(Bits difference) {
    constexpr int kTop = 8 * sizeof(Bits) - 1;
    return static_cast<Bits>(static_cast<Bits>(difference << 1) ^ static_cast<Bits>(Bits(0) - (difference >> kTop)));
}

template <class Bits>
Bits unzigzag(Bits code) {
    return static_cast<Bits>((code >> 1) ^ static_cast<Bits>(Bits(0) - (code & 1)));
}

} // namespace isoslider::index
