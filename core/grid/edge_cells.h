#pragma once

#include <array>
#include <cstddef>

namespace isoslider {

/// True when one of the four cells around the edge that starts at (x, y, z) along `axis` is valid, as
/// `isCellValid(x, y, z)` states. Only such an edge is ever active: a vertex that no triangle could use does not
/// exist.
template <class Coordinate, class IsCellWhole>
inline bool hasValidCell(Coordinate x, Coordinate y, Coordinate z, int axis, const IsCellWhole& isCellValid) {
    for (int k = 0; k < 4; ++k) {
        std::array<Coordinate, 3> cell{x, y, z};
        cell[static_cast<std::size_t>((axis + 1) % 3)] -= k & 1;
        cell[static_cast<std::size_t>((axis + 2) % 3)] -= k >> 1;
        if (isCellValid(cell[0], cell[1], cell[2]))
            return true;
    }
    return false;
}

} // namespace isoslider
