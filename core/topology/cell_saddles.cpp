#include "core/topology/cell_saddles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/check.h"
#include "core/cell/cell_states.h"
#include "core/grid/scalar_key.h"

namespace isoslider::topology {

/// Isovalues in (below, above] at which the cell has one state.
struct CellHistory::Stretch {
    const cell::CellState* state = nullptr; ///< null: the surface does not pass through
    double below = 0.0, above = 0.0;

    int euler() const { return state == nullptr ? 0 : state->loops - (state->tunnel == cell::Tunnel::None ? 0 : 2); }
    unsigned joinedAbove() const { return state == nullptr ? 0u : state->joinedFaces; }
    unsigned joinedBelow() const {
        return state == nullptr ? 0u : cell::ambiguousFaces(state->signs) & ~unsigned{state->joinedFaces};
    }
    bool hasTunnel(cell::Tunnel which) const { return state != nullptr && state->tunnel == which; }
};

namespace {

// The corners of an ambiguous face on one side.
std::array<std::uint8_t, 2> cornersOfFace(int face, std::uint8_t signs, bool areAbove) {
    const auto& corners = cell::kFaceCorners[static_cast<std::size_t>(face)];
    const bool isFirst = (signs >> corners[0] & 1) == (areAbove ? 1 : 0);
    return isFirst ? std::array<std::uint8_t, 2>{corners[0], corners[2]}
                   : std::array<std::uint8_t, 2>{corners[1], corners[3]};
}

// The greatest double from `low` on, below `at`, at which the state is another than at `at`; `low` if there is none but
// there. Between them it changes once.
template <class StateAt>
double lastOfAnother(std::uint16_t state, double low, double at, const StateAt& stateAt) {
    std::uint64_t other = keyOf(low), same = keyOf(at); // doubles in their order
    if (other + 1 < same && stateAt(sampleOfKey<double>(other + 1)) == state)
        return low;
    while (same - other > 1) {
        const std::uint64_t middle = other + (same - other) / 2;
        (stateAt(sampleOfKey<double>(middle)) == state ? same : other) = middle;
    }
    return sampleOfKey<double>(other);
}

} // namespace

void CellHistory::find(const cell::CornerScalars& scalars) {
    eulerAtCorners_ = {};
    saddleCount_ = joinCount_ = 0;
    std::array<std::uint8_t, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint8_t a, std::uint8_t b) { return scalars[a] < scalars[b]; });
    const auto states = cell::cellStates();
    Stretch before; // the one below
    std::uint8_t signs = 0xff;
    std::array<Stretch, kMost> found;
    for (std::size_t k = 1; k <= 8; ++k) {
        const std::uint8_t crossed = order[k - 1];
        signs = static_cast<std::uint8_t>(signs & ~(1u << crossed));
        const double low = scalars[crossed], high = k < 8 ? scalars[order[k]] : std::numeric_limits<double>::infinity();
        if (k < 8 && !(low < high))
            continue; // equal scalars are crossed together
        // From above downwards: resolveCell() is about the limit from below.
        std::size_t count = 0;
        if (k == 8) {
            found[count++] = {nullptr, low, high};
        } else if (!cell::isAmbiguous(signs)) {
            found[count++] = {&states[signs], low, high};
        } else {
            const auto stateAt = [&](double at) { return cell::resolveCell(signs, scalars, true, at).state; };
            for (double at = high; at > low;) {
                const cell::ResolvedCell resolved = cell::resolveCell(signs, scalars, true, at);
                double next = std::max(low, resolved.interval.below);
                if (!(next < at)) // near a saddle, or where all is rounding
                    next = lastOfAnother(resolved.state, low, at, stateAt);
                const cell::CellState* const state = &states[resolved.state];
                if (count > 0 && found[count - 1].state == state)
                    found[count - 1].below = next;
                else if (count < kMost)
                    found[count++] = {state, next, at};
                at = next;
            }
        }
        std::reverse(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
        eulerAtCorners_[crossed] = static_cast<std::int8_t>(found[0].euler() - before.euler());
        add(before, found[0], low);
        for (std::size_t i = 1; i < count; ++i) {
            CellSaddle saddle{found[i].below, found[i].euler() - found[i - 1].euler(), -1};
            if (const unsigned changed = found[i].joinedAbove() ^ found[i - 1].joinedAbove(); changed != 0)
                saddle.face = static_cast<std::int8_t>(std::countr_zero(changed));
            if (saddleCount_ < kMost)
                saddles_[saddleCount_++] = saddle;
            add(found[i - 1], found[i], found[i].below);
        }
        before = found[count - 1];
    }
}

// Joins that begin between two stretches: going down those of what is above, going up those of what is below.
void CellHistory::add(const Stretch& lower, const Stretch& upper, double isovalue) {
    const auto join = [&](bool isOfAbove, int face, std::array<std::uint8_t, 2> corners) {
        if (joinCount_ < joins_.size())
            joins_[joinCount_++] = {isovalue, isOfAbove, static_cast<std::int8_t>(face), corners};
    };
    for (unsigned faces = lower.joinedAbove() & ~upper.joinedAbove(); faces != 0; faces &= faces - 1)
        join(true, std::countr_zero(faces), cornersOfFace(std::countr_zero(faces), lower.state->signs, true));
    for (unsigned faces = upper.joinedBelow() & ~lower.joinedBelow(); faces != 0; faces &= faces - 1)
        join(false, std::countr_zero(faces), cornersOfFace(std::countr_zero(faces), upper.state->signs, false));
    // A tunnel passes along a diagonal. Where the corner at an end of it is on the other side, its neighbours are
    // joined round it, and the tunnel leads to them.
    const auto ends = [](const cell::CellState& state) {
        const unsigned side = state.tunnel == cell::Tunnel::Above ? 1 : 0;
        const auto end = [&](unsigned corner) {
            return static_cast<std::uint8_t>((state.signs >> corner & 1u) == side ? corner : corner ^ 1u);
        };
        return std::array<std::uint8_t, 2>{end(state.diagonal), end(7u - state.diagonal)};
    };
    if (lower.hasTunnel(cell::Tunnel::Above) &&
        !(upper.hasTunnel(cell::Tunnel::Above) && upper.state->diagonal == lower.state->diagonal))
        join(true, -1, ends(*lower.state));
    if (upper.hasTunnel(cell::Tunnel::Below) &&
        !(lower.hasTunnel(cell::Tunnel::Below) && lower.state->diagonal == upper.state->diagonal))
        join(false, -1, ends(*upper.state));
}

} // namespace isoslider::topology
