// ActiveSurface, step 2: the triangles of each brick.

#include <algorithm>

#include "core/extract/active_surface_detail.h"

namespace isoslider::extract {
namespace {

// Lower grid point and axis of each cell edge, as steps from the cell.
struct EdgeStep {
    int x, y, z;
    int axis;
    int local;  // x + 8 y + 64 z
    int offset; // into the edge table, from the cell's own number
};

std::array<EdgeStep, 12> makeEdgeSteps() {
    std::array<EdgeStep, 12> steps;
    for (int e = 0; e < 12; ++e) {
        const int corner = kCellEdges[e].lowerCorner;
        const int axis = kCellEdges[e].axis;
        const int local = (corner & 1) + 8 * (corner >> 1 & 1) + 64 * (corner >> 2);
        steps[e] = {corner & 1, corner >> 1 & 1, corner >> 2, axis, local, axis * kBrickPoints + local};
    }
    return steps;
}

const std::array<EdgeStep, 12> kEdgeSteps = makeEdgeSteps();

// Cells whose twelve edges all start in their own brick.
bool isInner(LocalPoint cell) { return (cell & 7) < 7 && (cell >> 3 & 7) < 7 && (cell >> 6) < 7; }

struct EdgePlace {
    int brick; // in the neighbourhood
    LocalEdge edge;
};

EdgePlace placeOf(LocalPoint cell, const EdgeStep& step) {
    const int x = (cell & 7) + step.x, y = (cell >> 3 & 7) + step.y, z = (cell >> 6) + step.z;
    return {(x >> 3) | (y >> 3) << 1 | (z >> 3) << 2,
            static_cast<LocalEdge>(step.axis * kBrickPoints + (x & 7) + 8 * (y & 7) + 64 * (z & 7))};
}

constexpr int kWholeBrickShare = 3; // a brick is laid out anew when more than 1/3 of its cells change

} // namespace

// The case follows from the twelve edges alone, up to its complement; which of the two, from the
// direction of one of them.
template <class Live>
std::uint8_t ActiveSurface<Live>::caseOf(const Brick& brick, const Neighbourhood& around, LocalPoint cell) const {
    unsigned mask = 0;
    unsigned rising = 0;
    if (isInner(cell)) {
        const int z = cell >> 6;
        const int s = cell & 63;
        const auto gather = [&](const std::array<BrickBits, 3>& bits) {
            const std::uint64_t x0 = bits[0][z] >> s, x1 = bits[0][z + 1] >> s;
            const std::uint64_t y0 = bits[1][z] >> s, y1 = bits[1][z + 1] >> s;
            const std::uint64_t zz = bits[2][z] >> s;
            return static_cast<unsigned>((x0 & 1) | (x0 >> 7 & 2) | (x1 & 1) << 2 | (x1 >> 5 & 8) | (y0 & 3) << 4 | (y1 & 3) << 6 |
                                         (zz & 3) << 8 | (zz >> 8 & 3) << 10);
        };
        mask = gather(brick.active);
        rising = gather(brick.rising);
    } else {
        for (int e = 0; e < 12; ++e) {
            const EdgePlace place = placeOf(cell, kEdgeSteps[e]);
            const Brick* owner = around.bricks[place.brick];
            if (!owner || !owner->isActiveEdge(place.edge))
                continue;
            mask |= 1u << e;
            rising |= static_cast<unsigned>(owner->rising[place.edge >> 9][place.edge >> 6 & 7] >> (place.edge & 63) & 1) << e;
        }
    }
    if (mask == 0)
        return 0;
    const std::uint8_t caseIndex = caseFromEdgeMask()[mask];
    const int e = std::countr_zero(mask);
    const bool lowerIsAbove = !(rising >> e & 1);
    const bool lowerInCase = caseIndex >> kCellEdges[e].lowerCorner & 1;
    return lowerIsAbove == lowerInCase ? caseIndex : static_cast<std::uint8_t>(~caseIndex);
}

template <class Live>
void ActiveSurface<Live>::writeCell(const Neighbourhood& around, LocalPoint cell, std::uint8_t caseIndex, std::uint32_t* out) const {
    const CellCase& cellCase = caseTable()[caseIndex];
    const int count = 3 * cellCase.triangleCount;
    const Brick& brick = *around.bricks[0];
    if (isInner(cell)) {
        const std::uint16_t* slots = brick.slot.data() + cell;
        for (int k = 0; k < count; ++k)
            out[k] = brick.vertexBegin + slots[kEdgeSteps[cellCase.edges[k]].offset];
        return;
    }
    std::uint32_t vertices[12];
    for (unsigned mask = cellCase.edgeMask; mask != 0; mask &= mask - 1) {
        const int e = std::countr_zero(mask);
        const EdgePlace place = placeOf(cell, kEdgeSteps[e]);
        const Brick& owner = *around.bricks[place.brick];
        vertices[e] = owner.vertexBegin + owner.slot[place.edge];
    }
    for (int k = 0; k < count; ++k)
        out[k] = vertices[cellCase.edges[k]];
}

template <class Live>
void ActiveSurface<Live>::retriangulate(Brick& brick, Scratch& scratch) {
    brick.isListedDirty.store(false, std::memory_order_relaxed);
    Neighbourhood around;
    const BrickGrid& grid = table_.grid();
    const auto coords = grid.brickCoords(brick.index);
    for (int k = 0; k < 8; ++k) {
        bool isInside = true;
        std::int64_t index = brick.index;
        for (int a = 0; a < 3; ++a)
            if (k >> a & 1) {
                isInside = isInside && coords[a] + 1 < grid.bricks()[a];
                index += grid.brickStride(a);
            }
        around.bricks[k] = isInside ? table_.find(static_cast<BrickIndex>(index)) : nullptr;
    }
    const std::int64_t before = brick.triangleCount();
    scratch.cells += static_cast<std::uint64_t>(countBits(brick.dirty));
    if (!patchCells(brick, around, scratch))
        layOutBrick(brick, around);
    scratch.triangleDifference += std::int64_t{brick.triangleCount()} - before;
    brick.dirty = {};
}

// Moves a bucket's last run into the hole that a cell leaves.
template <class Live>
void ActiveSurface<Live>::removeRun(Brick& brick, LocalPoint cell, int triangles) {
    const std::uint32_t last = --brick.bucketRuns[triangles];
    const std::uint32_t bucket = brick.triangleBegin + brick.bucketBegin[triangles];
    const std::size_t from = bucket + static_cast<std::uint32_t>(triangles) * last;
    const std::size_t to = bucket + static_cast<std::uint32_t>(triangles) * brick.cellRun[cell];
    if (from != to) {
        const LocalPoint moved = runOwners_[from];
        std::copy_n(indices_.data() + 3 * from, 3 * triangles, indices_.data() + 3 * to);
        runOwners_[to] = moved;
        brick.cellRun[moved] = brick.cellRun[cell];
    }
    std::fill_n(indices_.data() + 3 * from, 3 * triangles, 0u);
}

// False when the brick must be laid out anew: its new cases are set then, its triangles undefined.
template <class Live>
bool ActiveSurface<Live>::patchCells(Brick& brick, const Neighbourhood& around, Scratch&) {
    std::uint32_t runs = 0;
    for (int t = 1; t <= kMaxCellTriangles; ++t)
        runs += brick.bucketRuns[t];
    const int dirtyCells = countBits(brick.dirty);
    const auto& table = caseTable();
    bool patches = brick.triangleBegin != kNoRun && dirtyCells * kWholeBrickShare <= static_cast<int>(runs);

    // Delete before add, so that the runs given up are there for the new ones.
    LocalPoint cells[kBrickPoints];
    int count = 0;
    forEachBit(brick.dirty, [&](LocalPoint cell) {
        const std::uint8_t caseIndex = caseOf(brick, around, cell);
        const std::uint8_t newCase = table[caseIndex].triangleCount == 0 ? 0 : caseIndex;
        const int before = table[brick.cellCase[cell]].triangleCount;
        const int after = table[newCase].triangleCount;
        if (patches && before != after && before > 0)
            removeRun(brick, cell, before);
        if (before != after)
            brick.cellRun[cell] = kNoSlot;
        brick.cellCase[cell] = newCase;
        if (after > 0)
            cells[count++] = cell;
    });
    if (!patches)
        return false;
    for (int i = 0; i < count; ++i) {
        const LocalPoint cell = cells[i];
        const int t = table[brick.cellCase[cell]].triangleCount;
        if (brick.cellRun[cell] == kNoSlot) {
            if (brick.bucketRuns[t] == brick.bucketCapacity(t))
                return false;
            brick.cellRun[cell] = brick.bucketRuns[t]++;
        }
        const std::uint32_t begin = runBegin(brick, cell, t);
        runOwners_[begin] = cell;
        writeCell(around, cell, brick.cellCase[cell], indices_.data() + 3 * std::size_t{begin});
    }
    return true;
}

template <class Live>
void ActiveSurface<Live>::layOutBrick(Brick& brick, const Neighbourhood& around) {
    const auto& table = caseTable();
    std::array<std::uint32_t, kMaxCellTriangles + 1> runs{};
    for (int cell = 0; cell < kBrickPoints; ++cell)
        ++runs[table[brick.cellCase[cell]].triangleCount];
    std::uint32_t total = 0;
    std::array<std::uint16_t, kMaxCellTriangles + 2> begins{};
    bool isEmpty = true;
    for (int t = 1; t <= kMaxCellTriangles; ++t) {
        begins[t] = static_cast<std::uint16_t>(total);
        total += static_cast<std::uint32_t>(t) * (runs[t] + runs[t] / 8 + (t <= 2 ? 2 : 1));
        isEmpty = isEmpty && runs[t] == 0;
    }
    begins[kMaxCellTriangles + 1] = static_cast<std::uint16_t>(total);

    const std::uint32_t capacity = isEmpty ? 0 : triangleRuns_.roundUp(total);
    if (brick.triangleBegin != kNoRun) {
        std::fill_n(indices_.data() + 3 * std::size_t{brick.triangleBegin}, 3 * std::size_t{brick.triangleCapacity}, 0u);
        if (capacity > brick.triangleCapacity || capacity < brick.triangleCapacity / 2) {
            triangleRuns_.free(brick.triangleBegin, brick.triangleCapacity);
            brick.triangleBegin = kNoRun;
            brick.triangleCapacity = 0;
        }
    }
    brick.bucketRuns.fill(0);
    brick.bucketBegin = begins;
    if (isEmpty)
        return;
    if (brick.triangleBegin == kNoRun) {
        brick.triangleBegin = triangleRuns_.allocate(capacity);
        brick.triangleCapacity = capacity;
    }
    for (int cell = 0; cell < kBrickPoints; ++cell) {
        const std::uint8_t caseIndex = brick.cellCase[cell];
        if (caseIndex == 0)
            continue;
        const int t = table[caseIndex].triangleCount;
        brick.cellRun[cell] = brick.bucketRuns[t]++;
        const std::uint32_t begin = runBegin(brick, static_cast<LocalPoint>(cell), t);
        runOwners_[begin] = static_cast<LocalPoint>(cell);
        writeCell(around, static_cast<LocalPoint>(cell), caseIndex, indices_.data() + 3 * std::size_t{begin});
    }
}

#define ISO_INSTANTIATE(Live)                                                                                        \
    template void ActiveSurface<Live>::retriangulate(Brick&, Scratch&);                                              \
    template bool ActiveSurface<Live>::patchCells(Brick&, const Neighbourhood&, Scratch&);                           \
    template void ActiveSurface<Live>::layOutBrick(Brick&, const Neighbourhood&);                                    \
    template std::uint8_t ActiveSurface<Live>::caseOf(const Brick&, const Neighbourhood&, LocalPoint) const;         \
    template void ActiveSurface<Live>::writeCell(const Neighbourhood&, LocalPoint, std::uint8_t, std::uint32_t*) const; \
    template void ActiveSurface<Live>::removeRun(Brick&, LocalPoint, int);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
