// Edge blocks: which points of a brick are above, from its edges.

#include "core/extract/sources/edge_scratch.h"

namespace isoslider::extract {

// Ends of active edges that are above, and on a leaf edge all points up to there.
template <class Sample>
void EdgeBlockSource<Sample>::seedFromVertices(const Stored* samples, const BrickDraft<Live>& draft, BitString& above) {
    for (std::uint32_t k = 0; k < draft.edgeVertices; ++k) {
        const VertexCode code = draft.codes[k];
        const ClosedEdge edge = edgeOf(code);
        const auto axis = static_cast<std::size_t>(axisOf(edge));
        const int stride = kPointStride[axis], side = 1 << levelOf(code);
        const int along = coordsOf(startOf(edge))[axis] & (side - 1); // from the leaf edge's lower end
        const auto [lower, upper] = endsOf(code);
        const bool isLowerAbove = samples[lower] > samples[upper];
        for (int i = isLowerAbove ? 0 : along + 1; i <= (isLowerAbove ? along : side); ++i)
            above.set(ClosedPoint(startOf(edge).number() + (i - along) * stride));
    }
}

// The same where no cells are merged: an edge that stays active keeps the signs of its ends.
template <class Sample>
void EdgeBlockSource<Sample>::seedFromChanges(BrickSlot slot, const std::array<BitString, 3>& edgesBefore,
                                              const BitString& aboveBefore, const Scratch& scratch,
                                              BitString& above) const {
    const std::array<BitString, 3>& edges = edges_[slot.index()];
    std::array<BitString, 3> stay;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            stay[a].words[w] = edges[a].words[w] & edgesBefore[a].words[w];
    endsOfEdges(stay, above);
    for (std::size_t w = 0; w < kBitWords; ++w)
        above.words[w] &= aboveBefore.words[w];
    for (const Activated& change : activatedIn(slot, scratch)) {
        const bool isUpperAbove = change.scalar2 > change.scalar1;
        above.set(startOf(change.edge) + (isUpperAbove ? kPointStride[axisOf(change.edge)] : 0));
    }
}

// Signs of the corners of all active cells. Those at the ends of active edges follow from the edges' scalars; every
// other corner of an active cell is at most two inactive edges of the cell away from one of these and has its sign.
// The same holds of a leaf and its edges; inside it, nothing is known.
template <class Sample>
void EdgeBlockSource<Sample>::findSigns(BrickSlot slot, const std::array<BitString, 3>& edgesBefore,
                                        const LiveSurface<Live>& surface, Scratch& scratch) const {
    const std::array<BitString, 3>& edges = edges_[slot.index()];
    const BrickMasks& masks = surface.masks(slot);
    BrickDraft<Live>& draft = scratch.draft;
    BitString above;
    const bool isNew = surface.brick(slot).edgeVertices == 0;
    if (isNew || merges_)
        seedFromVertices(pointsOf(slot, surface, scratch).samples, draft, above);
    else
        seedFromChanges(slot, edgesBefore, surface.brick(slot).above, scratch, above);
    // Cells of active edges: the edge's point and those one step back across it.
    BitString cells;
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t x = edges[0].words[w] | shiftedDown<9>(edges[0], i) | shiftedDown<81>(edges[0], i) |
                                shiftedDown<90>(edges[0], i);
        const std::uint64_t y = edges[1].words[w] | shiftedDown<1>(edges[1], i) | shiftedDown<81>(edges[1], i) |
                                shiftedDown<82>(edges[1], i);
        const std::uint64_t z = edges[2].words[w] | shiftedDown<1>(edges[2], i) | shiftedDown<9>(edges[2], i) |
                                shiftedDown<10>(edges[2], i);
        cells.words[w] = (x | y | z) & masks.cells.words[w];
    }
    draft.active.cells = cells;
    std::array<BitString, 3> still = masks.edges; // inactive edges, of which that is known
    int rounds = 2;
    if (leaves_[slot.index()].hasMerged()) {
        rounds = kClosedPoints; // as long as they bring any
        findLeafEdges(slot, scratch, still);
    }
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            still[a].words[w] &= masks.edges[a].words[w] & ~edges[a].words[w];
    for (int round = 0; round < rounds; ++round) {
        const auto spread = [&](const BitString& from) {
            BitString to = from;
            BitString up0, up1, up2;
            for (std::size_t w = 0; w < kBitWords; ++w) {
                up0.words[w] = from.words[w] & still[0].words[w];
                up1.words[w] = from.words[w] & still[1].words[w];
                up2.words[w] = from.words[w] & still[2].words[w];
            }
            for (int i = 0; i < kBitWords; ++i) {
                const auto w = static_cast<std::size_t>(i);
                to.words[w] |= shiftedUp<1>(up0, i) | shiftedUp<9>(up1, i) | shiftedUp<81>(up2, i);
                to.words[w] |= (shiftedDown<1>(from, i) & still[0].words[w]) |
                               (shiftedDown<9>(from, i) & still[1].words[w]) |
                               (shiftedDown<81>(from, i) & still[2].words[w]);
            }
            return to;
        };
        const BitString further = spread(above);
        if (further == above)
            break;
        above = further;
    }
    draft.above = above;
}

// Whether no active cell is without a sign at each corner, and no edge of one but as the signs state: false when the
// edges are those of no scalars, which only a damaged index has.
template <class Sample>
bool EdgeBlockSource<Sample>::areSignsWhole(BrickSlot slot, const Scratch& scratch) const {
    const std::array<BitString, 3>& edges = edges_[slot.index()];
    const BitString &above = scratch.draft.above, &cells = scratch.draft.active.cells;
    for (int i = 0; i < kBitWords; ++i) {
        const auto w = static_cast<std::size_t>(i);
        const std::uint64_t x =
            cells.words[w] | shiftedUp<9>(cells, i) | shiftedUp<81>(cells, i) | shiftedUp<90>(cells, i);
        const std::uint64_t y =
            cells.words[w] | shiftedUp<1>(cells, i) | shiftedUp<81>(cells, i) | shiftedUp<82>(cells, i);
        const std::uint64_t z =
            cells.words[w] | shiftedUp<1>(cells, i) | shiftedUp<9>(cells, i) | shiftedUp<10>(cells, i);
        const std::uint64_t wrong = (((above.words[w] ^ shiftedDown<1>(above, i)) ^ edges[0].words[w]) & x) |
                                    (((above.words[w] ^ shiftedDown<9>(above, i)) ^ edges[1].words[w]) & y) |
                                    (((above.words[w] ^ shiftedDown<81>(above, i)) ^ edges[2].words[w]) & z);
        if (wrong != 0)
            return false;
    }
    return true;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template void EdgeBlockSource<Sample>::findSigns(BrickSlot, const std::array<BitString, 3>&, \
                                                     const LiveSurface<Live>&, Scratch&) const; \
    template bool EdgeBlockSource<Sample>::areSignsWhole(BrickSlot, const Scratch&) const;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
