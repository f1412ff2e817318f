// ActiveSurface, step 2: the triangles of each brick.

#include <algorithm>

#include "core/extract/active_surface_detail.h"
#include "core/extract/cell_words.h"

namespace isoslider::extract {
namespace {

// Where the twelve edges of each cell of a brick start: brick of the neighbourhood << 11 | local edge.
using EdgePlace = std::uint16_t;
constexpr int kEdgeBits = 11;
constexpr EdgePlace kEdgeMask = (1u << kEdgeBits) - 1;

std::array<std::array<EdgePlace, 12>, kBrickPoints> makeEdgePlaces() {
    std::array<std::array<EdgePlace, 12>, kBrickPoints> places;
    for (int cell = 0; cell < kBrickPoints; ++cell)
        for (int e = 0; e < 12; ++e) {
            const int corner = kCellEdges[e].lowerCorner;
            const int x = (cell & 7) + (corner & 1), y = (cell >> 3 & 7) + (corner >> 1 & 1), z = (cell >> 6) + (corner >> 2);
            const int brick = (x >> 3) | (y >> 3) << 1 | (z >> 3) << 2;
            const int edge = kCellEdges[e].axis * kBrickPoints + (x & 7) + 8 * (y & 7) + 64 * (z & 7);
            places[cell][e] = static_cast<EdgePlace>(brick << kEdgeBits | edge);
        }
    return places;
}

const std::array<std::array<EdgePlace, 12>, kBrickPoints>& edgePlaces() {
    static const auto places = makeEdgePlaces();
    return places;
}

constexpr int kFewCells = 12;       // up to which cells are solved one by one
constexpr int kWholeBrickShare = 3; // a brick is laid out anew when more than 1/3 of its cells change

// The twelve edges of an inner cell, as steps from its number into the brick's own edge table.
std::array<std::array<std::uint16_t, 15>, 256> makeInnerSteps() {
    std::array<std::array<std::uint16_t, 15>, 256> steps{};
    for (int c = 0; c < 256; ++c)
        for (int k = 0; k < 3 * caseTable()[c].triangleCount; ++k) {
            const CellEdge& edge = kCellEdges[caseTable()[c].edges[k]];
            steps[c][k] = static_cast<std::uint16_t>(edge.axis * kBrickPoints + (edge.lowerCorner & 1) +
                                                     8 * (edge.lowerCorner >> 1 & 1) + 64 * (edge.lowerCorner >> 2));
        }
    return steps;
}

const std::array<std::array<std::uint16_t, 15>, 256>& innerSteps() {
    static const auto steps = makeInnerSteps();
    return steps;
}

// Cells whose twelve edges all start in their own brick.
bool isInner(LocalPoint cell) { return (cell & 7) != 7 && (cell & 56) != 56 && cell < 448; }

// Writes triangles of one brick's cells as vertex numbers.
template <class Around>
class CellWriter {
public:
    explicit CellWriter(const Around& around) : bricks_(around.bricks) {}

    void write(LocalPoint cell, std::uint8_t caseIndex, const CellCase& cellCase, std::uint32_t* out) const {
        const int count = 3 * cellCase.triangleCount;
        if (isInner(cell)) {
            const auto& steps = steps_[caseIndex];
            const std::uint16_t* slots = bricks_[0]->slot.data() + cell;
            const std::uint32_t begin = bricks_[0]->vertexBegin;
            for (int k = 0; k < count; ++k)
                out[k] = begin + slots[steps[k]];
            return;
        }
        const auto& places = places_[cell];
        for (int k = 0; k < count; ++k) {
            const EdgePlace place = places[cellCase.edges[k]];
            out[k] = bricks_[place >> kEdgeBits]->vertexOf(place & kEdgeMask);
        }
    }

private:
    const std::array<std::array<EdgePlace, 12>, kBrickPoints>& places_ = edgePlaces();
    const std::array<std::array<std::uint16_t, 15>, 256>& steps_ = innerSteps();
    const std::array<const Brick*, 8>& bricks_;
};

// Asks for the slots of the edges just above a brick, which its outermost cells use: those at x = 0 of
// the next brick along x lie in every line of its table, those at z = 0 in a few.
void prefetchBorders(const std::array<const Brick*, 8>& bricks) {
    for (int axis = 0; axis < 3; ++axis) {
        const Brick* above = bricks[std::size_t{1} << axis];
        if (!above)
            continue;
        __builtin_prefetch(above);
        for (int other = 0; other < 3; ++other) {
            if (other == axis)
                continue;
            const std::uint16_t* slots = above->slot.data() + other * kBrickPoints;
            const int lines = axis == 2 ? 2 : 16; // of 32 slots each
            for (int line = 0; line < lines; ++line)
                __builtin_prefetch(slots + 32 * line);
        }
    }
}

} // namespace

template <class Live>
void ActiveSurface<Live>::retriangulate(Brick& brick, Scratch& scratch) {
    brick.isListedDirty.store(false, std::memory_order_relaxed);
    Neighbourhood around;
    EdgeBitsAround touched{};
    const BrickGrid& grid = table_.grid();
    for (int k = 0; k < 8; ++k) {
        bool isInside = true;
        std::int64_t index = brick.index;
        for (int a = 0; a < 3; ++a)
            if (k >> a & 1) {
                isInside = isInside && brick.origin[a] + kBrickSide < grid.dims()[a];
                index += grid.brickStride(a);
            }
        if (!isInside)
            continue;
        const BrickTable::Entry entry = table_.entry(static_cast<BrickIndex>(index));
        around.bricks[k] = entry.brick;
        touched[k] = entry.isTouched ? &entry.brick->touched : nullptr;
    }
    scratch.rewritten = cellsWithEdges(touched);
    for (int z = 0; z < kBrickSide; ++z)
        scratch.rewritten[z] &= brick.usableCells[z];

    if (countBits(scratch.rewritten) > kBrickPoints / 16)
        prefetchBorders(around.bricks);
    const std::int64_t before = brick.triangleCount();
    if (!findCases(brick, around, scratch)) {
        scratch.isConsistent = false;
        return;
    }
    if (!patchCells(brick, around, scratch))
        layOutBrick(brick, around);
    scratch.triangleDifference += std::int64_t{brick.triangleCount()} - before;
}

template <class Live>
bool ActiveSurface<Live>::isLowerEndBelow(const Brick& brick, LocalEdge edge) const {
    const std::size_t at = brick.vertexOf(edge);
    return scalars1_[at] < scalars2_[at];
}

// New cases of the cells to be rewritten. All signs follow from the active edges up to inversion;
// one edge's scalars decide that. Beside missing values signs do not carry over from cell to cell, so
// there each cell is solved on its own. False when the active edges of a cell belong to no signs, which
// only a damaged index can bring about; nothing is changed then.
template <class Live>
bool ActiveSurface<Live>::findCases(Brick& brick, const Neighbourhood& around, Scratch& scratch) {
    const auto& places = edgePlaces();
    const auto& table = caseTable();
    bool isConsistent = true;
    const auto solveCell = [&](LocalPoint cell) -> std::uint8_t {
        unsigned mask = 0;
        for (int e = 0; e < 12; ++e) {
            const Brick* owner = around.bricks[places[cell][e] >> kEdgeBits];
            mask |= static_cast<unsigned>(owner && owner->isActiveEdge(places[cell][e] & kEdgeMask)) << e;
        }
        const std::uint8_t caseIndex = caseFromEdgeMask()[mask];
        if (caseIndex == 0) {
            isConsistent = isConsistent && mask == 0;
            return 0;
        }
        const int e = std::countr_zero(mask);
        const bool isBelow = isLowerEndBelow(*around.bricks[places[cell][e] >> kEdgeBits], places[cell][e] & kEdgeMask);
        const bool isBelowInCase = !(caseIndex >> kCellEdges[e].lowerCorner & 1);
        const std::uint8_t solved = isBelow == isBelowInCase ? caseIndex : static_cast<std::uint8_t>(~caseIndex);
        return table[solved].triangleCount > 0 ? solved : 0;
    };

    BrickBits active{};
    if (brick.hasMissing || countBits(scratch.rewritten) <= kFewCells) {
        forEachBit(scratch.rewritten, [&](LocalPoint cell) {
            scratch.newCase[cell] = solveCell(cell);
            active[cell >> 6] |= std::uint64_t{scratch.newCase[cell] != 0} << (cell & 63);
        });
    } else {
        EdgeBitsAround edges{};
        for (int k = 0; k < 8; ++k)
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
            const bool inverted = caseOfCell(corners, anchor, false) != solveCell(anchor);
            forEachBit(active, [&](LocalPoint cell) { scratch.newCase[cell] = caseOfCell(corners, cell, inverted); });
        }
    }
    if (!isConsistent)
        return false;
    for (int z = 0; z < kBrickSide; ++z) {
        for (std::uint64_t word = scratch.rewritten[z] & ~active[z]; word != 0; word &= word - 1)
            scratch.newCase[64 * z + std::countr_zero(word)] = 0;
        brick.activeCells[z] = (brick.activeCells[z] & ~scratch.rewritten[z]) | active[z];
    }
    return true;
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
bool ActiveSurface<Live>::patchCells(Brick& brick, const Neighbourhood& around, Scratch& scratch) {
    std::uint32_t runs = 0;
    for (int t = 1; t <= kMaxCellTriangles; ++t)
        runs += brick.bucketRuns[t];
    const auto& table = caseTable();
    const bool patches = brick.triangleBegin != kNoRun && countBits(scratch.rewritten) * kWholeBrickShare <= static_cast<int>(runs);

    // Delete before add, so that the runs given up are there for the new ones.
    LocalPoint cells[kBrickPoints];
    int count = 0;
    forEachBit(scratch.rewritten, [&](LocalPoint cell) {
        const std::uint8_t oldCase = brick.cellCase[cell];
        const std::uint8_t newCase = scratch.newCase[cell];
        if (oldCase != newCase) {
            const int before = table[oldCase].triangleCount;
            brick.changedCells[cell >> 6] |= std::uint64_t{1} << (cell & 63);
            brick.cellCase[cell] = newCase;
            if (patches && before != table[newCase].triangleCount) {
                if (before > 0)
                    removeRun(brick, cell, before);
                brick.cellRun[cell] = kNoSlot;
            }
        }
        if (newCase != 0)
            cells[count++] = cell;
    });
    scratch.cells += static_cast<std::uint64_t>(countBits(brick.changedCells));
    if (!patches)
        return false;
    const CellWriter writer(around);
    for (int i = 0; i < count; ++i) {
        const LocalPoint cell = cells[i];
        const CellCase& cellCase = table[brick.cellCase[cell]];
        const int t = cellCase.triangleCount;
        if (brick.cellRun[cell] == kNoSlot) {
            if (brick.bucketRuns[t] == brick.bucketCapacity(t))
                return false;
            brick.cellRun[cell] = brick.bucketRuns[t]++;
        }
        const std::uint32_t begin = runBegin(brick, cell, t);
        runOwners_[begin] = cell;
        writer.write(cell, brick.cellCase[cell], cellCase, indices_.data() + 3 * std::size_t{begin});
    }
    return true;
}

template <class Live>
void ActiveSurface<Live>::layOutBrick(Brick& brick, const Neighbourhood& around) {
    const auto& table = caseTable();
    std::array<std::uint32_t, kMaxCellTriangles + 1> runs{};
    forEachBit(brick.activeCells, [&](LocalPoint cell) { ++runs[table[brick.cellCase[cell]].triangleCount]; });
    std::uint32_t total = 0;
    bool isEmpty = true;
    for (int t = 1; t <= kMaxCellTriangles; ++t) {
        brick.bucketBegin[t] = static_cast<std::uint16_t>(total);
        total += static_cast<std::uint32_t>(t) * (runs[t] + runs[t] / 5 + 3);
        isEmpty = isEmpty && runs[t] == 0;
    }
    brick.bucketBegin[kMaxCellTriangles + 1] = static_cast<std::uint16_t>(total);
    brick.bucketRuns.fill(0);

    const std::uint32_t capacity = isEmpty ? 0 : triangleRuns_.roundUp(total);
    if (brick.triangleBegin != kNoRun && (capacity > brick.triangleCapacity || capacity < brick.triangleCapacity / 2)) {
        std::fill_n(indices_.data() + 3 * std::size_t{brick.triangleBegin}, 3 * std::size_t{brick.triangleCapacity}, 0u);
        triangleRuns_.free(brick.triangleBegin, brick.triangleCapacity);
        brick.triangleBegin = kNoRun;
        brick.triangleCapacity = 0;
    }
    if (isEmpty)
        return;
    if (brick.triangleBegin == kNoRun) {
        brick.triangleBegin = triangleRuns_.allocate(capacity);
        brick.triangleCapacity = capacity;
    }
    const CellWriter writer(around);
    forEachBit(brick.activeCells, [&](LocalPoint cell) {
        const CellCase& cellCase = table[brick.cellCase[cell]];
        brick.cellRun[cell] = brick.bucketRuns[cellCase.triangleCount]++;
        const std::uint32_t begin = runBegin(brick, cell, cellCase.triangleCount);
        runOwners_[begin] = cell;
        writer.write(cell, brick.cellCase[cell], cellCase, indices_.data() + 3 * std::size_t{begin});
    });
    // What the runs leave free draws as nothing.
    std::uint32_t* indices = indices_.data() + 3 * std::size_t{brick.triangleBegin};
    for (int t = 1; t <= kMaxCellTriangles; ++t) {
        const std::uint32_t used = brick.bucketBegin[t] + static_cast<std::uint32_t>(t) * brick.bucketRuns[t];
        const std::uint32_t end = t == kMaxCellTriangles ? brick.triangleCapacity : brick.bucketBegin[t + 1];
        std::fill(indices + 3 * used, indices + 3 * std::size_t{end}, 0u);
    }
}

#define ISO_INSTANTIATE(Live)                                                                       \
    template void ActiveSurface<Live>::retriangulate(Brick&, Scratch&);                             \
    template bool ActiveSurface<Live>::isLowerEndBelow(const Brick&, LocalEdge) const;              \
    template bool ActiveSurface<Live>::findCases(Brick&, const Neighbourhood&, Scratch&);           \
    template bool ActiveSurface<Live>::patchCells(Brick&, const Neighbourhood&, Scratch&);          \
    template void ActiveSurface<Live>::layOutBrick(Brick&, const Neighbourhood&);                   \
    template void ActiveSurface<Live>::removeRun(Brick&, LocalPoint, int);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
