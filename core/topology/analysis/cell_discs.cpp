#include "core/topology/analysis/cell_discs.h"

#include "core/cell/cell_states.h"

namespace isoslider::topology {

const std::array<std::int8_t, 256>& discsBySigns() {
    static const std::array<std::int8_t, 256> table = [] {
        std::array<std::int8_t, 256> discs{};
        for (unsigned signs = 1; signs < 255; ++signs) {
            const auto state = cell::stateOf(static_cast<std::uint8_t>(signs), 0);
            discs[signs] = static_cast<std::int8_t>(cell::cellStates()[state].loops);
        }
        return discs;
    }();
    return table;
}

const NeighbourTable& NeighbourTable::get() {
    static const NeighbourTable table;
    return table;
}

NeighbourTable::NeighbourTable() {
    const auto& discs = discsBySigns();
    for (std::uint32_t index = 0; index < low_.size(); ++index)
        for (const bool isHigh : {false, true}) {
            // Neighbour (dx, dy) of the outer plane, or of the point's own; the point itself counts as neither.
            const auto isAbove = [&](int dx, int dy, bool isOuter) {
                const int place = dx + 1 + 3 * (dy + 1);
                if (isOuter)
                    return index >> 8 >> place & 1u;
                return index >> (place < 4 ? place : place - 1) & 1u;
            };
            int quarters = 0;
            for (int cell = 0; cell < 4; ++cell) {
                const int sx = (cell & 1) != 0 ? 1 : -1, sy = (cell >> 1) != 0 ? 1 : -1;
                // The cell's corners: the point is the one where no axis is left.
                const unsigned own = (sx < 0 ? 1u : 0u) | (sy < 0 ? 2u : 0u) | (isHigh ? 0u : 4u);
                unsigned signs = 0;
                for (unsigned away = 1; away < 8; ++away) // bits: axes along which the corner lies away from the point
                    signs |= isAbove((away & 1) != 0 ? sx : 0, (away & 2) != 0 ? sy : 0, (away & 4) != 0)
                             << (own ^ away);
                quarters += 4 * (discs[signs] - discs[signs | 1u << own]);
                const auto side = [&](unsigned away) { return (signs >> (own ^ away) & 1u) != 0 ? 1 : -1; };
                quarters += side(1) + side(2) + side(4);
                for (const auto [a, b] : {std::array{1u, 2u}, {1u, 4u}, {2u, 4u}})
                    quarters -= side(a) + side(b); // two halves where both are on one side
            }
            (isHigh ? high_ : low_)[index] = static_cast<std::int8_t>(quarters);
        }
}

} // namespace isoslider::topology
