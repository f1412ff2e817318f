// ActiveSurface, step 1: the active edges of each brick.

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/extract/active_surface_detail.h"

namespace isoslider::extract {
namespace {

// Room for a brick to grow before its run must move.
std::uint32_t withRoom(std::uint32_t count) { return count + count / 4 + 8; }

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
        for (const BrickIndex index : lists.cleared[partition])
            if (Brick* cleared = table_.find(index); cleared && cleared->vertexCount > 0) {
                cleared->isCleared = true;
                scratch.touched.push_back(cleared);
            }
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
    if (brick.isCleared)
        clearBrick(brick, scratch);
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
        const std::uint64_t bit = std::uint64_t{1} << (edge & 63);
        brick.active[edge >> 9][edge >> 6 & 7] &= ~bit;
        brick.touched[edge >> 9][edge >> 6 & 7] |= bit;
        ++scratch.removed;
    }
    const std::uint32_t holes = static_cast<std::uint32_t>(scratch.holes.size());
    const std::uint32_t finalCount = brick.vertexCount - holes + brick.activatedCount;
    if (finalCount > brick.vertexCapacity)
        growVertices(brick, finalCount);
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
        ++scratch.added;
    }
    closeHoles(brick, scratch);

    brick.firstActivated = brick.firstDeactivated = kNoRun;
    brick.activatedCount = brick.deactivatedCount = 0;
    table_.setTouched(brick, true);
    listBricks(brick, scratch);
    return isConsistent;
}

// All edges of a brick leave at once.
template <class Live>
void ActiveSurface<Live>::clearBrick(Brick& brick, Scratch& scratch) {
    brick.isCleared = false;
    for (std::uint32_t i = brick.vertexBegin; i < brick.vertexBegin + brick.vertexCount; ++i)
        brick.slot[edges_[i]] = kNoSlot;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t z = 0; z < 8; ++z)
            brick.touched[axis][z] |= std::exchange(brick.active[axis][z], 0);
    scratch.removed += brick.vertexCount;
    brick.vertexCount = 0;
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
    brick.touched[change.edge >> 9][change.edge >> 6 & 7] |= bit;
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
        const LocalEdge edge = edges_[to] = edges_[from];
        brick.slot[edge] = hole;
        brick.touched[edge >> 9][edge >> 6 & 7] |= std::uint64_t{1} << (edge & 63);
    }
}

// The brick's vertices move to a larger run: every triangle that uses one must be written again, in
// this brick and in those below it.
template <class Live>
void ActiveSurface<Live>::growVertices(Brick& brick, std::uint32_t count) {
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
                brick.touched[axis][z] |= brick.active[axis][z];
        vertexRuns_.free(brick.vertexBegin, brick.vertexCapacity);
    }
    brick.vertexBegin = begin;
    brick.vertexCapacity = capacity;
}

// PAPER 2.2: an edge activates the four cells round it. Cells of lower bricks are reached by edges
// that lie in the face between; they will look at `touched` here when it is their turn.
template <class Live>
void ActiveSurface<Live>::listBricks(Brick& brick, Scratch& scratch) {
    constexpr std::uint64_t kColumnX0 = 0x0101010101010101ull;
    constexpr std::uint64_t kRowY0 = 0xffull;
    std::uint64_t all[3] = {0, 0, 0};
    for (int axis = 0; axis < 3; ++axis)
        for (int z = 0; z < kBrickSide; ++z)
            all[axis] |= brick.touched[axis][z];
    const std::uint64_t x0 = brick.touched[0][0], y0 = brick.touched[1][0];
    const bool reaches[8] = {true,
                             ((all[1] | all[2]) & kColumnX0) != 0,
                             ((all[0] | all[2]) & kRowY0) != 0,
                             (all[2] & 1) != 0,
                             (x0 | y0) != 0,
                             (y0 & kColumnX0) != 0,
                             (x0 & kRowY0) != 0,
                             false};
    const BrickGrid& grid = table_.grid();
    for (int k = 0; k < 8; ++k) { // bit a of k: one brick down along axis a
        bool exists = reaches[k];
        std::int64_t index = brick.index;
        for (int a = 0; a < 3; ++a)
            if (k >> a & 1) {
                exists = exists && brick.origin[a] > 0;
                index -= grid.brickStride(a);
            }
        if (!exists)
            continue;
        Brick& listed = k == 0 ? brick : table_.findOrCreate(static_cast<BrickIndex>(index));
        if (!listed.isListedDirty.load(std::memory_order_relaxed) && !listed.isListedDirty.exchange(true, std::memory_order_relaxed))
            scratch.dirty.push_back(&listed);
    }
}

#define ISO_INSTANTIATE(Live)                                                                       \
    template void ActiveSurface<Live>::chainChanges(const ChangeSet<Live>&, unsigned, Scratch&);    \
    template bool ActiveSurface<Live>::applyToBrick(Brick&, Scratch&);                              \
    template void ActiveSurface<Live>::growVertices(Brick&, std::uint32_t);               \
    template void ActiveSurface<Live>::activate(Brick&, const ActivatedEdge<Live>&, std::uint32_t); \
    template void ActiveSurface<Live>::clearBrick(Brick&, Scratch&);                                 \
    template void ActiveSurface<Live>::closeHoles(Brick&, Scratch&);                                \
    template void ActiveSurface<Live>::listBricks(Brick&, Scratch&);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
