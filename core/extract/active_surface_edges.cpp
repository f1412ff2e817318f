// ActiveSurface, step 1: the active edges of each brick.

#include <algorithm>
#include <cstring>

#include "core/extract/active_surface_detail.h"

namespace isoslider::extract {
namespace {

// A set bit may be wanted by several threads at once: the owner and bricks below it.
void setAtomically(std::uint64_t& word, std::uint64_t bits) {
    std::atomic_ref<std::uint64_t> reference(word);
    if ((reference.load(std::memory_order_relaxed) & bits) != bits)
        reference.fetch_or(bits, std::memory_order_relaxed);
}

// Room for a brick to grow before its run must move.
std::uint32_t withRoom(std::uint32_t count) { return count + count / 8 + 4; }

} // namespace

template <class Live>
void ActiveSurface<Live>::chainChanges(const ChangeSet<Live>& changes, unsigned partition, Scratch& scratch) {
    scratch.touched.clear();
    scratch.activated.clear();
    scratch.deactivated.clear();
    scratch.nextActivated.clear();
    scratch.nextDeactivated.clear();
    Brick* brick = nullptr;
    const auto touch = [&](BrickIndex index) {
        if (!brick || brick->index != index)
            brick = &table_.findOrCreate(index);
        if (brick->firstActivated == kNoRun && brick->firstDeactivated == kNoRun)
            scratch.touched.push_back(brick);
    };
    changes.forEachList([&](const typename ChangeSet<Live>::Lists& lists) {
        for (const DeactivatedEdge& change : lists.deactivated[partition]) {
            touch(change.brick);
            scratch.nextDeactivated.push_back(brick->firstDeactivated);
            brick->firstDeactivated = static_cast<std::uint32_t>(scratch.deactivated.size());
            ++brick->deactivatedCount;
            scratch.deactivated.push_back(&change);
        }
        for (const ActivatedEdge<Live>& change : lists.activated[partition]) {
            touch(change.brick);
            scratch.nextActivated.push_back(brick->firstActivated);
            brick->firstActivated = static_cast<std::uint32_t>(scratch.activated.size());
            ++brick->activatedCount;
            scratch.activated.push_back(&change);
        }
    });
}

template <class Live>
bool ActiveSurface<Live>::applyToBrick(Brick& brick, Scratch& scratch) {
    scratch.dirtyHere = {};
    scratch.changedHere = {};
    bool isConsistent = brick.deactivatedCount <= brick.vertexCount;

    // PAPER 3.3: the Delete list first, so that additions fill the holes.
    scratch.holes.clear();
    for (std::uint32_t i = brick.firstDeactivated; i != kNoRun; i = scratch.nextDeactivated[i]) {
        const LocalEdge edge = scratch.deactivated[i]->edge;
        if (!brick.isActiveEdge(edge)) {
            isConsistent = false;
            continue;
        }
        scratch.holes.push_back(brick.slot[edge]);
        brick.slot[edge] = kNoSlot;
        brick.active[edge >> 9][edge >> 6 & 7] &= ~(std::uint64_t{1} << (edge & 63));
        markEdge(brick, edge, true, scratch);
        ++scratch.removed;
    }
    const std::uint32_t holes = static_cast<std::uint32_t>(scratch.holes.size());
    const std::uint32_t finalCount = brick.vertexCount - holes + brick.activatedCount;
    if (finalCount > brick.vertexCapacity)
        growVertices(brick, finalCount, scratch);
    for (std::uint32_t i = brick.firstActivated; i != kNoRun; i = scratch.nextActivated[i]) {
        const ActivatedEdge<Live>& change = *scratch.activated[i];
        if (brick.isActiveEdge(change.edge)) {
            isConsistent = false;
            continue;
        }
        std::uint32_t slot = brick.vertexCount;
        if (scratch.holes.empty()) {
            ++brick.vertexCount;
        } else {
            slot = scratch.holes.back();
            scratch.holes.pop_back();
        }
        activate(brick, change, slot);
        markEdge(brick, change.edge, true, scratch);
        ++scratch.added;
    }
    closeHoles(brick, scratch);

    brick.firstActivated = brick.firstDeactivated = kNoRun;
    brick.activatedCount = brick.deactivatedCount = 0;
    for (int z = 0; z < kBrickSide; ++z) {
        setAtomically(brick.dirty[z], scratch.dirtyHere[z] & brick.usableCells[z]);
        setAtomically(brick.changed[z], scratch.changedHere[z] & brick.usableCells[z]);
    }
    markBrick(brick, scratch);
    return isConsistent;
}

template <class Live>
void ActiveSurface<Live>::activate(Brick& brick, const ActivatedEdge<Live>& change, std::uint32_t slot) {
    const std::size_t at = brick.vertexBegin + slot;
    scalars1_[at] = change.scalar1;
    scalars2_[at] = change.scalar2;
    edgeNormals_[at] = change.normal1 | static_cast<std::uint32_t>(change.normal2) << 16;
    edges_[at] = change.edge;
    brick.slot[change.edge] = static_cast<std::uint16_t>(slot);
    const std::uint64_t bit = std::uint64_t{1} << (change.edge & 63);
    brick.active[change.edge >> 9][change.edge >> 6 & 7] |= bit;
    std::uint64_t& rising = brick.rising[change.edge >> 9][change.edge >> 6 & 7];
    rising = change.scalar1 < change.scalar2 ? rising | bit : rising & ~bit;
}

// Entries from the end move into the holes that are left; their cells get new indices.
template <class Live>
void ActiveSurface<Live>::closeHoles(Brick& brick, Scratch& scratch) {
    std::sort(scratch.holes.begin(), scratch.holes.end(), std::greater<>());
    for (const std::uint16_t hole : scratch.holes) {
        const std::uint32_t last = --brick.vertexCount;
        if (hole == last)
            continue;
        const std::size_t from = brick.vertexBegin + last;
        const std::size_t to = brick.vertexBegin + hole;
        scalars1_[to] = scalars1_[from];
        scalars2_[to] = scalars2_[from];
        edgeNormals_[to] = edgeNormals_[from];
        edges_[to] = edges_[from];
        brick.slot[edges_[to]] = hole;
        markEdge(brick, edges_[to], false, scratch);
    }
}

// The brick's vertices move to a larger run: every triangle that uses one must be written again, in
// this brick and in those below it.
template <class Live>
void ActiveSurface<Live>::growVertices(Brick& brick, std::uint32_t count, Scratch& scratch) {
    const std::uint32_t capacity = vertexRuns_.roundUp(withRoom(count));
    const std::uint32_t begin = vertexRuns_.allocate(capacity);
    if (brick.vertexBegin != kNoRun) {
        const auto move = [&](auto& column) {
            std::memcpy(column.data() + begin, column.data() + brick.vertexBegin, brick.vertexCount * sizeof column[0]);
        };
        move(scalars1_);
        move(scalars2_);
        move(edgeNormals_);
        move(edges_);
        for (int axis = 0; axis < 3; ++axis)
            for (int z = 0; z < kBrickSide; ++z)
                for (std::uint64_t word = brick.active[axis][z]; word != 0; word &= word - 1)
                    markEdge(brick, static_cast<LocalEdge>(axis * kBrickPoints + 64 * z + std::countr_zero(word)), false, scratch);
        vertexRuns_.free(brick.vertexBegin, brick.vertexCapacity);
    }
    brick.vertexBegin = begin;
    brick.vertexCapacity = capacity;
}

// PAPER 2.2: an edge activates the four cells round it. Those of lower bricks are marked there.
template <class Live>
void ActiveSurface<Live>::markEdge(Brick& brick, LocalEdge edge, bool isChange, Scratch& scratch) {
    static constexpr int kStrides[3] = {1, 8, 64};
    const int axis = edge >> 9;
    const int local = edge & 511;
    const int u = axis == 0 ? 1 : 0;
    const int v = axis == 2 ? 1 : 2;
    const int coordinates[3] = {local & 7, local >> 3 & 7, local >> 6};
    for (int k = 0; k < 4; ++k) {
        const bool leavesU = (k & 1) && coordinates[u] == 0;
        const bool leavesV = (k & 2) && coordinates[v] == 0;
        // One step down, or round to the far side of the brick below.
        const int cell = local + ((k & 1) ? (leavesU ? 7 : -1) * kStrides[u] : 0) + ((k & 2) ? (leavesV ? 7 : -1) * kStrides[v] : 0);
        const std::uint64_t bit = std::uint64_t{1} << (cell & 63);
        if (!leavesU && !leavesV) {
            scratch.dirtyHere[cell >> 6] |= bit;
            if (isChange)
                scratch.changedHere[cell >> 6] |= bit;
            continue;
        }
        if ((leavesU && brick.origin[u] == 0) || (leavesV && brick.origin[v] == 0))
            continue; // outside the box
        const BrickGrid& grid = table_.grid();
        const std::int64_t below = std::int64_t{brick.index} - (leavesU ? grid.brickStride(u) : 0) - (leavesV ? grid.brickStride(v) : 0);
        Brick& other = table_.findOrCreate(static_cast<BrickIndex>(below));
        if (!(other.usableCells[cell >> 6] & bit)) {
            markBrick(other, scratch); // it may have just been made for nothing: looked at, and released
            continue;
        }
        setAtomically(other.dirty[cell >> 6], bit);
        if (isChange)
            setAtomically(other.changed[cell >> 6], bit);
        markBrick(other, scratch);
    }
}

template <class Live>
void ActiveSurface<Live>::markBrick(Brick& brick, Scratch& scratch) {
    if (!brick.isListedDirty.load(std::memory_order_relaxed) && !brick.isListedDirty.exchange(true, std::memory_order_relaxed))
        scratch.dirty.push_back(&brick);
}

#define ISO_INSTANTIATE(Live)                                                                       \
    template void ActiveSurface<Live>::chainChanges(const ChangeSet<Live>&, unsigned, Scratch&);    \
    template bool ActiveSurface<Live>::applyToBrick(Brick&, Scratch&);                              \
    template void ActiveSurface<Live>::growVertices(Brick&, std::uint32_t, Scratch&);               \
    template void ActiveSurface<Live>::activate(Brick&, const ActivatedEdge<Live>&, std::uint32_t); \
    template void ActiveSurface<Live>::closeHoles(Brick&, Scratch&);                                \
    template void ActiveSurface<Live>::markEdge(Brick&, LocalEdge, bool, Scratch&);                 \
    template void ActiveSurface<Live>::markBrick(Brick&, Scratch&);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
