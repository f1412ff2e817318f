// Edge blocks with merged cells: which cells are leaves, and what that makes of a brick.

#include <bit>

#include "core/extract/sources/edge_scratch.h"

namespace isoslider::extract {
namespace {

// Cells of the brick in the box that are not merged: those with a missing corner too, beside which a leaf has the edges
// of the grid.
BitString unmergedCells(const LeavesAround& around) {
    BitString cells;
    for (int z = 0; z < kCellSide; ++z)
        for (int y = 0; y < kCellSide; ++y)
            for (int x = 0; x < kCellSide; ++x)
                if (const ClosedPoint cell = closedPoint(x, y, z);
                    around.levelAt(LeavesAround::cellAt(cell.number())) == 0)
                    cells.set(cell);
    return cells;
}

// Adds the edges of the grid on the edges of merged cells.
void addLeafEdges(const BrickLeaves& leaves, std::array<BitString, 3>& edges) {
    for (int z = 0; z < kCellSide; z += 2)
        for (int y = 0; y < kCellSide; y += 2)
            for (int x = 0; x < kCellSide; x += 2) {
                const int level = leaves.levelOf(x, y, z), side = 1 << level;
                if (level == 0 || ((x | y | z) & (side - 1)) != 0)
                    continue; // none, or not its first cells
                for (std::size_t a = 0; a < 3; ++a)
                    for (int k = 0; k < 4; ++k)
                        for (int i = 0; i < side; ++i) {
                            std::array<int, 3> at{x, y, z};
                            at[a] += i;
                            at[(a + 1) % 3] += k & 1 ? side : 0;
                            at[(a + 2) % 3] += k & 2 ? side : 0;
                            edges[a].set(closedPoint(at[0], at[1], at[2]));
                        }
            }
}

// Adds those edges on the brick's faces that lie on an edge of a leaf beside it, merged or not.
void addEdgesBeside(const LeavesAround& around, std::array<BitString, 3>& edges) {
    const auto isOfLeaf = [&](std::size_t axis, ClosedPoint start) {
        const auto at = coordsOf(start);
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        const int aligned = std::countr_zero(static_cast<unsigned>(at[u] | at[v]));
        const std::int64_t cell = LeavesAround::cellAt(start.number());
        for (int k = 0; k < 4; ++k) {
            const int level = around.levelAt(cell - (k & 1 ? LeavesAround::cellStride(u) : 0) -
                                             (k & 2 ? LeavesAround::cellStride(v) : 0));
            if (level != kNoLevel && level <= aligned)
                return true;
        }
        return false;
    };
    for (std::size_t face = 0; face < 3; ++face)
        for (const int side : {0, kCellSide})
            for (std::size_t k = 1; k < 3; ++k) {
                const std::size_t axis = (face + k) % 3, across = 3 - face - axis;
                std::array<int, 3> at{};
                at[face] = side;
                for (at[across] = 0; at[across] <= kCellSide; ++at[across])
                    for (at[axis] = 0; at[axis] < kCellSide; ++at[axis])
                        if (const ClosedPoint start = closedPoint(at[0], at[1], at[2]); isOfLeaf(axis, start))
                            edges[axis].set(start);
            }
}

} // namespace

// One end of an interval is crossed.
template <class Sample>
void EdgeBlockSource<Sample>::collectMerged(const Part& part, std::size_t record, std::size_t entry, bool goesUp,
                                            Lists& lists) {
    namespace form = index::record_form;
    const index::DecodedPage<Key>& page = part.page;
    const std::uint8_t which = page.forms[record];
    const PointId id(page.ids[record]);
    const bool isActivated = (page.farKeys[entry] > page.keys[record]) == goesUp;
    if (!form::isEdge(which)) {
        const int local = localOf(id).number(), level = form::levelOf(which);
        const int x = (local & 7) >> level, y = (local >> 3 & 7) >> level, z = (local >> 6) >> level;
        const int side = 3 - level; // of the brick, in such cells: 2^side
        lists.leaves[partitionOf(brickOf(id))].push_back(
            {brickOf(id), static_cast<std::uint8_t>(level),
             static_cast<std::uint8_t>(x + (y << side) + (z << (2 * side))), isActivated});
        return;
    }
    const int axis = form::axisOf(which);
    ++(isActivated ? lists.edgesAdded : lists.edgesRemoved);
    forEachHolder(id, axis, [&](BrickIndex brick, ClosedEdge edge) {
        ChangedEdge changed{brick, edge, static_cast<std::uint8_t>(form::levelOf(which)), isActivated};
        if (isActivated) {
            changed.scalar1 = storedOf(sampleOfKey<Sample>(page.farKeys[entry + 1]));
            changed.scalar2 = storedOf(sampleOfKey<Sample>(page.farKeys[entry + 2]));
            changed.normal1 = page.hasNormals() ? page.normals[record] : kNoNormal;
            changed.normal2 = page.hasNormals() ? page.farNormals[entry] : kNoNormal;
        }
        lists.edges[partitionOf(brick)].push_back(changed);
    });
}

// Brings the leaves of a partition's bricks to where the move goes.
template <class Sample>
void EdgeBlockSource<Sample>::changeLeaves(std::size_t partition, Scratch& scratch) {
    const auto forEachChange = [&](bool isActivated, const auto& visit) {
        for (const Lists& lists : *lists_)
            for (const ChangedLeaf& change : lists.leaves[partition])
                if (change.isActivated == isActivated) {
                    const std::uint32_t slot = slotOf_[change.brick.index()];
                    if (slot == 0) { // a leaf has an active edge
                        scratch.isConsistent = false;
                        continue;
                    }
                    visit(BrickSlot(slot - 1), leafBits(change.level, change.number));
                }
    };
    const auto note = [&](BrickSlot slot) {
        if (marks_[slot.index()] == Mark::None) {
            marks_[slot.index()] = Mark::LeavesChanged;
            scratch.otherLeaves.emplace_back(slot, leaves_[slot.index()]);
        }
    };
    forEachChange(false, [&](BrickSlot slot, const BrickLeaves& bits) {
        note(slot);
        BrickLeaves& leaves = leaves_[slot.index()];
        if ((bits.level1 & ~leaves.level1) != 0 || (bits.level2 & ~leaves.level2) != 0 ||
            (bits.level3 && !leaves.level3))
            scratch.isConsistent = false;
        leaves.level1 &= ~bits.level1;
        leaves.level2 = static_cast<std::uint8_t>(leaves.level2 & ~bits.level2);
        leaves.level3 = leaves.level3 && !bits.level3;
    });
    forEachChange(true, [&](BrickSlot slot, const BrickLeaves& bits) {
        note(slot);
        BrickLeaves& leaves = leaves_[slot.index()];
        if ((bits.level1 & leaves.level1) != 0 || (bits.level2 & leaves.level2) != 0 || leaves.level3)
            scratch.isConsistent = false;
        leaves.level1 |= bits.level1;
        leaves.level2 = static_cast<std::uint8_t>(leaves.level2 | bits.level2);
        leaves.level3 = leaves.level3 || bits.level3;
    });
}

// Bricks without a change of theirs that touch leaves which are others now.
template <class Sample>
void EdgeBlockSource<Sample>::listBesideLeaves(const LiveSurface<Live>& surface, std::vector<BrickSlot>& beside) const {
    const BrickGrid& grid = surface.shapes().grid();
    std::vector<bool> isListed(marks_.size(), false);
    for (const Scratch& scratch : *scratches_)
        for (const auto& [slot, before] : scratch.otherLeaves)
            forEachBesideChanged(
                grid, grid.brickCoords(surface.brick(slot).index), before, leaves_[slot.index()],
                [this](BrickIndex brick) { return slotOf_[brick.index()]; },
                [&](BrickSlot other) {
                    if (isListed[other.index()] || !leaves_[other.index()].hasMerged())
                        return;
                    isListed[other.index()] = true;
                    beside.push_back(other);
                });
}

// The edges of the grid on edges of leaves, merged or not: of these it is known whether they are active.
template <class Sample>
void EdgeBlockSource<Sample>::findLeafEdges(BrickSlot slot, const Scratch& scratch,
                                            std::array<BitString, 3>& edges) const {
    edgesOfCells(unmergedCells(scratch.around), edges);
    addLeafEdges(leaves_[slot.index()], edges);
    addEdgesBeside(scratch.around, edges);
}

// The leaves of the brick and of those beside it.
template <class Sample>
void EdgeBlockSource<Sample>::findLeavesAround(BrickSlot slot, const LiveSurface<Live>& surface,
                                               Scratch& scratch) const {
    const BrickIndex brick = surface.brick(slot).index;
    const BrickGrid& grid = surface.shapes().grid();
    const auto coords = grid.brickCoords(brick);
    const auto leavesAt = [&](const BrickStep& step) -> const BrickLeaves* {
        if (step == BrickStep{0, 0, 0})
            return &leaves_[slot.index()];
        const auto other =
            slotBeside(grid, coords, step, [this](BrickIndex beside) { return slotOf_[beside.index()]; });
        return other ? &leaves_[other->index()] : nullptr;
    };
    scratch.around.fill(reader_.info().geometry.dims, surface.shapes().origin(brick), scratch.draft.above, leavesAt);
}

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

// Signs of the corners of all active cells, and of leaves: those at the ends of active edges follow from the scalars
// there, every other corner's along inactive edges. Inside a leaf nothing is known.
template <class Sample>
void EdgeBlockSource<Sample>::findMergedSigns(BrickSlot slot, const LiveSurface<Live>& surface,
                                              Scratch& scratch) const {
    const std::array<BitString, 3>& edges = edges_[slot.index()];
    const BrickMasks& masks = surface.masks(slot);
    BitString seeds;
    seedFromVertices(pointsOf(slot, surface, scratch).samples, scratch.draft, seeds);
    std::array<BitString, 3> still = masks.edges; // inactive edges, of which that is known
    int rounds = kRoundsInCells;
    if (leaves_[slot.index()].hasMerged()) {
        rounds = kClosedPoints; // as long as they bring any
        findLeavesAround(slot, surface, scratch);
        findLeafEdges(slot, scratch, still);
    }
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t w = 0; w < kBitWords; ++w)
            still[a].words[w] &= masks.edges[a].words[w] & ~edges[a].words[w];
    spreadSigns(edges, still, seeds, masks.cells, rounds, scratch.changed.signs);
}

// The polygons of the brick's leaves. False when a leaf has none, when what carries a vertex then, at which level, is
// not what the index states, or when the edges are those of no signs.
template <class Sample>
bool EdgeBlockSource<Sample>::mergeCells(BrickSlot slot, Scratch& scratch) const {
    BrickDraft<Live>& draft = scratch.draft;
    if (leaves_[slot.index()].hasMerged()) {
        draft.merged.find(leaves_[slot.index()], scratch.around, draft.active);
        for (const MergedLeaf& leaf : draft.merged.leaves())
            if (leaf.indexCount < (leaf.hasCentre ? 9 : 3))
                return false;
        if (draft.active.edges != edges_[slot.index()])
            return false;
        for (const MergedCells::Corner& corner : draft.merged.corners())
            if (levelOf(draft.codes[draft.vertices.of(corner.edge)]) != corner.level)
                return false;
    }
    return areUnmergedWhole(scratch) && areEdgesOfSigns(draft.active.edges, {draft.active.cells, draft.above});
}

// Whether the vertices of cells that are not merged lie on edges of the grid.
template <class Sample>
bool EdgeBlockSource<Sample>::areUnmergedWhole(const Scratch& scratch) const {
    std::array<BitString, 3> edges;
    edgesOfCells(scratch.draft.active.cells, edges);
    for (std::uint32_t k = 0; k < scratch.draft.edgeVertices; ++k) {
        const VertexCode code = scratch.draft.codes[k];
        const ClosedEdge edge = edgeOf(code);
        if (levelOf(code) > 0 && edges[static_cast<std::size_t>(axisOf(edge))].test(startOf(edge)))
            return false;
    }
    return true;
}

#define ISO_INSTANTIATE(Sample, Name) \
    template void EdgeBlockSource<Sample>::collectMerged(const Part&, std::size_t, std::size_t, bool, Lists&); \
    template void EdgeBlockSource<Sample>::changeLeaves(std::size_t, Scratch&); \
    template void EdgeBlockSource<Sample>::listBesideLeaves(const LiveSurface<Live>&, std::vector<BrickSlot>&) const; \
    template void EdgeBlockSource<Sample>::findLeafEdges(BrickSlot, const Scratch&, std::array<BitString, 3>&) const; \
    template void EdgeBlockSource<Sample>::findLeavesAround(BrickSlot, const LiveSurface<Live>&, Scratch&) const; \
    template void EdgeBlockSource<Sample>::findMergedSigns(BrickSlot, const LiveSurface<Live>&, Scratch&) const; \
    template bool EdgeBlockSource<Sample>::mergeCells(BrickSlot, Scratch&) const; \
    template bool EdgeBlockSource<Sample>::areUnmergedWhole(const Scratch&) const;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
