// ActiveSurface, step 2: the states of each brick's cells.

#include <algorithm>
#include <bit>
#include <chrono>

#include "core/base/check.h"
#include "core/extract/active_surface_detail.h"
#include "core/extract/cell_words.h"

namespace isoslider::extract {
namespace {

constexpr int kFewCells = 12;       // up to which cells are solved one by one

// For signs that are ambiguous: edges that have, at one end or the other, every corner that the decision
// looks at. Those are the corners of ambiguous faces, and where a tunnel may be, all.
struct DecidingEdges {
    std::uint8_t count = 0;
    std::array<std::uint8_t, 8> edges{};
};

unsigned decidingCorners(std::uint8_t signs) {
    unsigned corners = 0;
    for (unsigned faces = cell::ambiguousFaces(signs), joined = faces;; joined = (joined - 1) & faces) {
        if (cell::mayHaveTunnel(signs, static_cast<std::uint8_t>(joined)) != 0)
            return 0xffu & ~(cell::hiddenCorner(signs) >= 0 ? 1u << cell::hiddenCorner(signs) : 0u);
        if (joined == 0)
            break;
    }
    for (unsigned faces = cell::ambiguousFaces(signs); faces != 0; faces &= faces - 1)
        for (const std::uint8_t corner : cell::kFaceCorners[static_cast<std::size_t>(std::countr_zero(faces))])
            corners |= 1u << corner;
    return corners;
}

std::array<DecidingEdges, 256> makeDecidingEdges() {
    std::array<DecidingEdges, 256> all{};
    for (unsigned signs = 0; signs < 256; ++signs) {
        if (!cell::isAmbiguous(static_cast<std::uint8_t>(signs)))
            continue;
        unsigned missing = decidingCorners(static_cast<std::uint8_t>(signs));
        while (missing != 0) { // the edge that adds most, again and again
            int best = 0, bestEdge = -1;
            for (unsigned mask = cell::activeEdges(static_cast<std::uint8_t>(signs)); mask != 0; mask &= mask - 1) {
                const int e = std::countr_zero(mask);
                const cell::CellEdge& edge = cell::kCellEdges[static_cast<std::size_t>(e)];
                const int added = std::popcount(missing & (1u << edge.lowerCorner | 1u << edge.upperCorner));
                if (added > best) {
                    best = added;
                    bestEdge = e;
                }
            }
            ISO_CHECK(bestEdge >= 0);
            const cell::CellEdge& edge = cell::kCellEdges[static_cast<std::size_t>(bestEdge)];
            missing &= ~(1u << edge.lowerCorner | 1u << edge.upperCorner);
            all[signs].edges[all[signs].count++] = static_cast<std::uint8_t>(bestEdge);
        }
    }
    return all;
}

const std::array<DecidingEdges, 256>& decidingEdges() {
    static const auto edges = makeDecidingEdges();
    return edges;
}

} // namespace

const std::array<bool, 256>& ambiguousSigns() {
    static const auto table = [] {
        std::array<bool, 256> ambiguous;
        for (std::size_t s = 0; s < 256; ++s)
            ambiguous[s] = cell::isAmbiguous(static_cast<std::uint8_t>(s));
        return ambiguous;
    }();
    return table;
}

template <class Live>
bool ActiveSurface<Live>::isLowerEndBelow(const Brick& brick, LocalEdge edge) const {
    const std::size_t at = brick.vertexOf(edge);
    return scalars1_[at] < scalars2_[at];
}

// Signs of one cell on its own, 0 when it is inactive; -1 when its active edges belong to no signs.
template <class Live>
int ActiveSurface<Live>::solveSigns(const Neighbourhood& around, LocalPoint cell) const {
    const auto& places = edgePlaces()[cell];
    unsigned mask = 0;
    for (std::size_t e = 0; e < 12; ++e) {
        const Brick* owner = around.bricks[places[e] >> kEdgeBits];
        mask |= static_cast<unsigned>(owner && owner->isActiveEdge(places[e] & kEdgeMask)) << e;
    }
    const std::uint8_t signs = cell::signsFromActiveEdges()[mask];
    if (signs == 0)
        return mask == 0 ? 0 : -1;
    const auto e = static_cast<std::size_t>(std::countr_zero(mask));
    const bool isBelow = isLowerEndBelow(*around.bricks[places[e] >> kEdgeBits], places[e] & kEdgeMask);
    const bool isBelowInSigns = !(signs >> cell::kCellEdges[e].lowerCorner & 1);
    return isBelow == isBelowInSigns ? signs : ~signs & 0xff;
}

// Signs of the cells to be rewritten, as their new states. All follow from the active edges up to
// inversion; one edge's scalars decide that. Beside missing values signs do not carry over from cell to
// cell, so there each cell is solved on its own. False when the active edges of a cell belong to no signs,
// which only a damaged index can bring about; nothing is changed then.
template <class Live>
bool ActiveSurface<Live>::findSigns(Brick& brick, const Neighbourhood& around, Scratch& scratch) const {
    bool isConsistent = true;
    const auto solveCell = [&](LocalPoint cell) -> std::uint8_t {
        const int signs = solveSigns(around, cell);
        isConsistent = isConsistent && signs >= 0;
        return static_cast<std::uint8_t>(std::max(signs, 0));
    };
    const std::array<bool, 256>& isAmbiguous = ambiguousSigns();
    scratch.hasAmbiguous = false;
    BrickBits active{};
    if (brick.hasMissing || countBits(scratch.rewritten) <= kFewCells) {
        forEachBit(scratch.rewritten, [&](LocalPoint cell) {
            const std::uint8_t signs = solveCell(cell);
            scratch.newState[cell] = signs;
            scratch.hasAmbiguous |= isAmbiguous[signs];
            active[cell >> 6] |= std::uint64_t{signs != 0} << (cell & 63);
        });
    } else {
        EdgeBitsAround edges{};
        for (std::size_t k = 0; k < 8; ++k)
            edges[k] = around.bricks[k] ? &around.bricks[k]->active : nullptr;
        const BrickBits impossible = impossibleCells(edges);
        for (int z = 0; z < kBrickSide; ++z)
            isConsistent = isConsistent && (impossible[z] & brick.usableCells[z]) == 0;
        if (!isConsistent)
            return false;
        const CornerWords corners = cornersFromEdges(edges);
        active = mixedCells(corners);
        int firstPlane = -1;
        for (int z = kBrickSide - 1; z >= 0; --z) {
            active[z] &= scratch.rewritten[z];
            firstPlane = active[z] ? z : firstPlane;
        }
        if (firstPlane >= 0) {
            const LocalPoint anchor = static_cast<LocalPoint>(64 * firstPlane + std::countr_zero(active[firstPlane]));
            const bool inverted = signsOfCell(corners, anchor, false) != solveCell(anchor);
            forEachBit(active, [&](LocalPoint cell) {
                const std::uint8_t signs = signsOfCell(corners, cell, inverted);
                scratch.newState[cell] = signs;
                scratch.hasAmbiguous |= isAmbiguous[signs];
            });
        }
    }
    if (!isConsistent)
        return false;
    for (int z = 0; z < kBrickSide; ++z) {
        for (std::uint64_t word = scratch.rewritten[z] & ~active[z]; word != 0; word &= word - 1)
            scratch.newState[64 * z + std::countr_zero(word)] = 0;
        brick.activeCells[z] = (brick.activeCells[z] & ~scratch.rewritten[z]) | active[z];
    }
    return true;
}

template <class Live>
bool ActiveSurface<Live>::findStates(Brick& brick, const Neighbourhood& around, double isovalue, Scratch& scratch) {
    if (!findSigns(brick, around, scratch))
        return false;
    if (!brick.slow && !scratch.hasAmbiguous)
        return true;
    const auto start = std::chrono::steady_clock::now();
    const bool isResolved = resolveAmbiguous(brick, around, isovalue, scratch);
    if (isResolved)
        assignInnerVertices(brick, scratch);
    scratch.resolving += std::chrono::steady_clock::now() - start;
    return isResolved;
}

// Scalars at the corners that the cell's decision looks at; others are left at 0.
template <class Live>
cell::CornerScalars ActiveSurface<Live>::scalarsOf(const Neighbourhood& around, LocalPoint cell, std::uint8_t signs) const {
    cell::CornerScalars scalars{};
    const DecidingEdges& deciding = decidingEdges()[signs];
    for (std::size_t i = 0; i < deciding.count; ++i) {
        const std::size_t e = deciding.edges[i];
        const EdgePlace place = edgePlaces()[cell][e];
        const std::size_t vertex = around.bricks[place >> kEdgeBits]->vertexOf(place & kEdgeMask);
        scalars[cell::kCellEdges[e].lowerCorner] = static_cast<double>(scalars1_[vertex]);
        scalars[cell::kCellEdges[e].upperCorner] = static_cast<double>(scalars2_[vertex]);
    }
    return scalars;
}

// Takes out of the brick's list the rewritten cells that must be decided again, and those that are no longer
// ambiguous. A cell whose signs are as before and whose interval holds keeps its state without a look at its
// scalars.
template <class Live>
void ActiveSurface<Live>::keepDecided(Brick& brick, double isovalue, Scratch& scratch) const {
    const auto states = cell::cellStates();
    std::vector<AmbiguousCell>& list = brick.slow->ambiguous;
    for (std::size_t i = 0; i < list.size();) {
        const LocalPoint cell = list[i].cell;
        const bool isRewritten = scratch.rewritten[cell >> 6] >> (cell & 63) & 1;
        if (!isRewritten) {
            ++i;
            continue;
        }
        const cell::CellState& state = states[brick.slow->state[cell]];
        if (scratch.newState[cell] == state.signs && list[i].interval.contains(isovalue)) {
            scratch.newState[cell] = stateOf(brick, cell);
            ++i;
        } else {
            if (state.innerVertices > 0)
                scratch.leavingInner.push_back(cell);
            list[i] = list.back();
            list.pop_back();
        }
    }
}

// Decides one ambiguous cell and adds it to the brick's list. False when its hidden corner cannot be read.
template <class Live>
bool ActiveSurface<Live>::decide(Brick& brick, const Neighbourhood& around, LocalPoint cell, double isovalue,
                                 Scratch& scratch) {
    const auto signs = static_cast<std::uint8_t>(scratch.newState[cell]);
    cell::CornerScalars scalars = scalarsOf(around, cell, signs);
    const int hidden = cell::hiddenCorner(signs);
    bool isRead = true, knowsHidden = false;
    if (hidden >= 0) {
        auto found = hidden_.hiddenScalar(brick.index, cell, hidden);
        isRead = found.isOk();
        if (!isRead) {
            scratch.error = std::move(found).error();
        } else if (found.value()) {
            knowsHidden = true;
            scalars[static_cast<std::size_t>(hidden)] = *found.value();
        }
    }
    const cell::ResolvedCell resolved = cell::resolveCell(signs, scalars, knowsHidden, isovalue);
    scratch.newState[cell] = resolved.state;
    if (cell::cellStates()[resolved.state].innerVertices > 0)
        scratch.arrivingInner.push_back({cell, 0, hidden >= 0 ? scalars[static_cast<std::size_t>(hidden)] : 0.0});
    brick.slow->ambiguous.push_back({resolved.interval, cell});
    ++scratch.resolved;
    return isRead;
}

// Decides the ambiguous among the rewritten cells and brings the brick's list of them up to date.
template <class Live>
bool ActiveSurface<Live>::resolveAmbiguous(Brick& brick, const Neighbourhood& around, double isovalue,
                                           Scratch& scratch) {
    if (!brick.slow)
        slowCells_.create(brick);
    const std::vector<AmbiguousCell>& list = brick.slow->ambiguous;
    const auto before = static_cast<std::int64_t>(list.size());
    scratch.leavingInner.clear();
    scratch.arrivingInner.clear();
    keepDecided(brick, isovalue, scratch);
    const std::array<bool, 256>& isAmbiguous = ambiguousSigns();
    bool hasAll = true;
    for (int z = 0; z < kBrickSide; ++z)
        for (std::uint64_t word = scratch.rewritten[z] & brick.activeCells[z]; word != 0; word &= word - 1) {
            const auto cell = static_cast<LocalPoint>(64 * z + std::countr_zero(word));
            const cell::StateId state = scratch.newState[cell]; // above the plain ones: decided before
            if (state < kPlainStates && isAmbiguous[state] && !decide(brick, around, cell, isovalue, scratch))
                hasAll = false;
        }
    brick.slow->findInterval();
    scratch.ambiguousDifference += static_cast<std::int64_t>(list.size()) - before;
    return hasAll;
}

// Gives cells that arrive with inner vertices room for those: what cells that leave have left, else the
// end of the brick's run. When that is full, all get new places in a larger one and are rewritten.
template <class Live>
void ActiveSurface<Live>::assignInnerVertices(Brick& brick, Scratch& scratch) {
    if (scratch.leavingInner.empty() && scratch.arrivingInner.empty())
        return;
    const auto states = cell::cellStates();
    SlowCells& slow = *brick.slow;
    for (const LocalPoint cell : scratch.leavingInner) {
        const std::uint16_t first = slow.innerOf(cell).first;
        const std::uint32_t count = states[brick.slow->state[cell]].innerVertices;
        if (count == 6)
            slow.tunnelHoles.push_back(first);
        else
            for (std::uint32_t k = 0; k < count; ++k)
                slow.singleHoles.push_back(static_cast<std::uint16_t>(first + k));
        slow.removeInner(cell);
    }
    const auto place = [&](InnerCell& inner, std::uint32_t count) {
        std::vector<std::uint16_t>& holes = count == 6 ? slow.tunnelHoles : slow.singleHoles;
        if ((count == 6 || count == 1) && !holes.empty()) {
            inner.first = holes.back();
            holes.pop_back();
        } else {
            inner.first = static_cast<std::uint16_t>(slow.innerEnd);
            slow.innerEnd += count;
        }
    };
    for (InnerCell& inner : scratch.arrivingInner) {
        place(inner, states[scratch.newState[inner.cell]].innerVertices);
        slow.addInner(inner);
    }
    if (slow.innerEnd > slow.innerCapacity) {
        releaseInnerRun(slow);
        for (InnerCell& inner : slow.inner) {
            const bool isRewritten = scratch.rewritten[inner.cell >> 6] >> (inner.cell & 63) & 1;
            if (!isRewritten) {
                scratch.rewritten[inner.cell >> 6] |= std::uint64_t{1} << (inner.cell & 63);
                scratch.newState[inner.cell] = brick.slow->state[inner.cell];
            }
            place(inner, states[scratch.newState[inner.cell]].innerVertices);
        }
        slow.innerCapacity = vertexRuns_.roundUp(slow.innerEnd + slow.innerEnd / 4);
        slow.innerBegin = vertexRuns_.allocate(slow.innerCapacity);
    } else if (slow.inner.empty()) {
        releaseInnerRun(slow);
    }
}

template <class Live>
void ActiveSurface<Live>::releaseInnerRun(SlowCells& slow) {
    if (slow.innerBegin != kNoRun)
        vertexRuns_.free(slow.innerBegin, slow.innerCapacity);
    slow.forgetInnerRun();
}

#define ISO_INSTANTIATE(Live) \
    template bool ActiveSurface<Live>::isLowerEndBelow(const Brick&, LocalEdge) const;                                         \
    template int ActiveSurface<Live>::solveSigns(const Neighbourhood&, LocalPoint) const;                                      \
    template bool ActiveSurface<Live>::findSigns(Brick&, const Neighbourhood&, Scratch&) const;                                \
    template bool ActiveSurface<Live>::findStates(Brick&, const Neighbourhood&, double, Scratch&);                             \
    template void ActiveSurface<Live>::keepDecided(Brick&, double, Scratch&) const;                                            \
    template bool ActiveSurface<Live>::decide(Brick&, const Neighbourhood&, LocalPoint, double, Scratch&);                     \
    template bool ActiveSurface<Live>::resolveAmbiguous(Brick&, const Neighbourhood&, double, Scratch&);                       \
    template cell::CornerScalars ActiveSurface<Live>::scalarsOf(const Neighbourhood&, LocalPoint, std::uint8_t) const;         \
    template void ActiveSurface<Live>::assignInnerVertices(Brick&, Scratch&);                                                  \
    template void ActiveSurface<Live>::releaseInnerRun(SlowCells&);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
