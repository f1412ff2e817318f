#include "core/topology/cell_saddles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/cell/cell_states.h"
#include "core/grid/scalar_key.h"

namespace isoslider::topology {

int CellHistory::Stretch::euler() const {
    return state == nullptr ? 0 : state->loops - (state->tunnel == cell::Tunnel::None ? 0 : 2);
}

unsigned CellHistory::Stretch::joinedAbove() const { return state == nullptr ? 0u : state->joinedFaces; }

unsigned CellHistory::Stretch::joinedBelow() const {
    return state == nullptr ? 0u : cell::ambiguousFaces(state->signs) & ~unsigned{state->joinedFaces};
}

bool CellHistory::Stretch::hasTunnel(cell::Tunnel which) const { return state != nullptr && state->tunnel == which; }

namespace {

// The corners of an ambiguous face on one side.
std::array<std::uint8_t, 2> cornersOfFace(int face, std::uint8_t signs, bool areAbove) {
    const auto& corners = cell::kFaceCorners[static_cast<std::size_t>(face)];
    const bool isFirst = (signs >> corners[0] & 1) == (areAbove ? 1 : 0);
    return isFirst ? std::array<std::uint8_t, 2>{corners[0], corners[2]}
                   : std::array<std::uint8_t, 2>{corners[1], corners[3]};
}

// Which tunnel a cell has at isovalues between which its signs and faces do not change. It changes at a body saddle
// only, of which there are two at most. What an isovalue tells lasts up to near the next saddle; so those in the middle
// of what is not known yet are asked, in plain arithmetic mostly. Exact decisions are left for where a tunnel begins.
class TunnelStretches {
public:
    TunnelStretches(const cell::CornerScalars& scalars, std::uint8_t signs, std::uint8_t joinedFaces, unsigned allowed)
        : scalars_(scalars), signs_(signs), joinedFaces_(joinedFaces), allowed_(allowed) {}

    /// Calls `add(state, below)` for all stretches of (low, high], from above downwards.
    template <class Add>
    void find(double low, double high, const Add& add) {
        lookAt(low, high, 0);
        for (std::size_t i = 0; i < count_; ++i) {
            const Known& here = known_[i];
            const double top = i == 0 ? high : known_[i - 1].below;
            if (here.isKnown) {
                add(here.state, here.below);
            } else if (isWide(here.below, top) || i == 0 || i + 1 == count_) {
                known_[i].state = walk(here.below, top, add);
            } else {
                const cell::StateId upper = known_[i - 1].state, lower = known_[i + 1].state;
                if (upper != lower)
                    add(upper, lastBefore(upper, here.below, top));
                add(lower, here.below);
            }
        }
    }

private:
    struct Known {
        cell::StateId state;
        double below;
        bool isKnown; ///< else it changes once at most
    };

    cell::StateId stateOf(const cell::TunnelDecision& inside) const {
        return cell::stateOf(signs_, joinedFaces_, inside.tunnel, inside.diagonal);
    }
    cell::StateId stateAt(double isovalue) const {
        return stateOf(cell::resolveTunnel(scalars_, allowed_, isovalue).decision);
    }
    void note(const Known& known) { known_[count_++] = known; }

    static bool isWide(double low, double high) { return high - low > 1e-12 * (std::abs(low) + std::abs(high)); }

    void lookAt(double low, double high, int depth) {
        constexpr int kMostDepth = 8;
        if (!(low < high))
            return;
        const double middle = low + 0.5 * (high - low);
        if (middle > low && middle < high && depth < kMostDepth) {
            const cell::ResolvedTunnel inside = cell::resolveTunnel(scalars_, allowed_, middle);
            if (inside.interval.contains(middle)) {
                const double below = std::max(low, inside.interval.below),
                             above = std::min(high, inside.interval.above);
                lookAt(above, high, depth + 1);
                note({stateOf(inside.decision), below, true});
                lookAt(low, below, depth + 1);
                return;
            }
        }
        note({0, low, false});
    }

    // From above downwards, by exact decisions where need be; returns the lowest state.
    template <class Add>
    cell::StateId walk(double low, double high, const Add& add) const {
        cell::StateId state = 0;
        for (double at = high; at > low;) {
            const cell::ResolvedTunnel inside = cell::resolveTunnel(scalars_, allowed_, at);
            state = stateOf(inside.decision);
            double below = std::max(low, inside.interval.below);
            if (!(below < at)) // near a saddle, or where all is rounding
                below = stateAt(sampleOfKey<double>(keyOf(low) + 1)) == state ? low : lastBefore(state, low, at);
            add(state, below);
            at = below;
        }
        return state;
    }

    // The greatest double in (low, high) at which the state is not yet `upper`.
    double lastBefore(cell::StateId upper, double low, double high) const {
        std::uint64_t other = keyOf(low), same = keyOf(high); // doubles in their order
        while (same - other > 1) {
            const std::uint64_t middle = other + (same - other) / 2;
            (stateAt(sampleOfKey<double>(middle)) == upper ? same : other) = middle;
        }
        return sampleOfKey<double>(other);
    }

    const cell::CornerScalars& scalars_;
    std::uint8_t signs_, joinedFaces_;
    unsigned allowed_;
    std::array<Known, 600> known_; // 2^9 at most
    std::size_t count_ = 0;
};

} // namespace

// While a face is ambiguous: joined up to an isovalue, which lies between its corners.
struct CellHistory::FaceJoin {
    int face;
    double lastJoined;
};

// Stretches of one sign pattern, in (low, high], from above downwards.
void CellHistory::findStretches(const cell::CornerScalars& scalars, std::uint8_t signs, double low, double high) {
    std::array<FaceJoin, 16> joins; // 6 at most; std::sort warns of less
    std::size_t joinCount = 0;
    unsigned joined = 0;
    for (unsigned faces = cell::ambiguousFaces(signs); faces != 0; faces &= faces - 1) {
        const int face = std::countr_zero(faces);
        const double last = lastJoined_[static_cast<std::size_t>(face)];
        if (last >= high)
            joined |= 1u << face; // all the way
        else if (last > low)
            joins[joinCount++] = {face, last};
    }
    std::sort(joins.begin(), joins.begin() + static_cast<std::ptrdiff_t>(joinCount),
              [](const FaceJoin& a, const FaceJoin& b) { return a.lastJoined > b.lastJoined; });
    for (std::size_t next = 0; high > low;) {
        while (next < joinCount && joins[next].lastJoined >= high)
            joined |= 1u << joins[next++].face;
        const double end = next < joinCount ? joins[next].lastJoined : low;
        const auto joinedFaces = static_cast<std::uint8_t>(joined);
        const unsigned allowed = cell::mayHaveTunnel(signs, joinedFaces);
        if (allowed == 0)
            addStretch(cell::stateOf(signs, joinedFaces), end);
        else
            TunnelStretches(scalars, signs, joinedFaces, allowed)
                .find(end, high, [this](cell::StateId state, double below) { addStretch(state, below); });
        high = end;
    }
}

void CellHistory::addStretch(cell::StateId id, double below) {
    const cell::CellState* const state = &cell::cellStates()[id];
    if (stretchCount_ > 0 && stretches_[stretchCount_ - 1].state == state)
        stretches_[stretchCount_ - 1].below = below;
    else if (stretchCount_ < kMost)
        stretches_[stretchCount_++] = {state, below};
}

void CellHistory::find(const cell::CornerScalars& scalars) {
    eulerAtCorners_ = {};
    saddleCount_ = joinCount_ = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        const auto& c = cell::kFaceCorners[face];
        const double p0 = scalars[c[0]], p1 = scalars[c[1]], p2 = scalars[c[2]], p3 = scalars[c[3]];
        if (std::min(p0, p2) > std::max(p1, p3))
            lastJoined_[face] = cell::lastJoined(p0, p1, p2, p3);
        else if (std::min(p1, p3) > std::max(p0, p2))
            lastJoined_[face] = cell::lastJoined(p1, p2, p3, p0);
    }
    std::array<std::uint8_t, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
    for (std::size_t i = 1; i < 8; ++i) // stable, and quicker than std::stable_sort() of so few
        for (std::size_t k = i; k > 0 && scalars[order[k]] < scalars[order[k - 1]]; --k)
            std::swap(order[k], order[k - 1]);
    const auto states = cell::cellStates();
    Stretch before; // the one below
    std::uint8_t signs = 0xff;
    for (std::size_t k = 1; k <= 8; ++k) {
        const std::uint8_t crossed = order[k - 1];
        signs = static_cast<std::uint8_t>(signs & ~(1u << crossed));
        const double low = scalars[crossed], high = k < 8 ? scalars[order[k]] : std::numeric_limits<double>::infinity();
        if (k < 8 && !(low < high))
            continue; // equal scalars are crossed together
        stretchCount_ = 0;
        if (k == 8)
            stretches_[stretchCount_++] = {nullptr, low};
        else if (!cell::isAmbiguous(signs))
            stretches_[stretchCount_++] = {&states[signs], low};
        else
            findStretches(scalars, signs, low, high);
        std::size_t i = stretchCount_ - 1;
        eulerAtCorners_[crossed] = static_cast<std::int8_t>(stretches_[i].euler() - before.euler());
        add(before, stretches_[i], low);
        for (; i > 0; --i) {
            const Stretch &lower = stretches_[i], &upper = stretches_[i - 1];
            CellSaddle saddle{upper.below, upper.euler() - lower.euler(), -1};
            if (const unsigned changed = upper.joinedAbove() ^ lower.joinedAbove(); changed != 0)
                saddle.face = static_cast<std::int8_t>(std::countr_zero(changed));
            if (saddleCount_ < kMost)
                saddles_[saddleCount_++] = saddle;
            add(lower, upper, upper.below);
        }
        before = stretches_[0];
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
