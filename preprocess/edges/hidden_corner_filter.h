#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace isoslider::preprocess {

/// Cells that a row of a brick has at most.
inline constexpr int kFilterCells = 8;

/// Bit i: cell i of the row may need a hidden corner (cell::hiddenCornersNeeded); a clear bit states it does not.
/// `rows` are the keys of the four rows of grid points around the cells, each kFilterCells + 1 long: at (y, z) =
/// (0, 0), (1, 0), (0, 1), (1, 1).
///
/// No edge joins two of the corners E = {0, 3, 5, 6}, nor two of O = {1, 2, 4, 7}. For three corners on one side
/// around a fourth at some isovalue, three of E or three of O lie on one side of all others.
template <class Key>
inline unsigned mayNeedHiddenCorners(const Key* const (&rows)[4]) {
    // Signed keys have minimum and maximum in every vector unit, and the same order.
    using Signed = std::make_signed_t<Key>;
    constexpr Key kFlip = Key(1) << (std::numeric_limits<Key>::digits - 1);
    Signed key[4][kFilterCells + 1];
    for (int row = 0; row < 4; ++row)
        for (int i = 0; i <= kFilterCells; ++i)
            key[row][i] = static_cast<Signed>(static_cast<Key>(rows[row][i] ^ kFlip));
    struct Ends {
        Signed least, second, secondGreatest, greatest;
    };
    const auto endsOf = [](Signed a, Signed b, Signed c, Signed d) {
        const Signed low1 = std::min(a, b), high1 = std::max(a, b), low2 = std::min(c, d), high2 = std::max(c, d);
        const Signed inner1 = std::max(low1, low2), inner2 = std::min(high1, high2);
        return Ends{std::min(low1, low2), std::min(inner1, inner2), std::max(inner1, inner2), std::max(high1, high2)};
    };
    Signed found[kFilterCells];
    for (int i = 0; i < kFilterCells; ++i) {
        const Ends even = endsOf(key[0][i], key[1][i + 1], key[2][i + 1], key[3][i]);
        const Ends odd = endsOf(key[0][i + 1], key[1][i], key[2][i], key[3][i + 1]);
        found[i] = static_cast<Signed>((even.second > odd.greatest) | (even.secondGreatest < odd.least) |
                                       (odd.second > even.greatest) | (odd.secondGreatest < even.least));
    }
    unsigned bits = 0;
    for (int i = 0; i < kFilterCells; ++i)
        bits |= static_cast<unsigned>(found[i]) << i;
    return bits;
}

} // namespace isoslider::preprocess
