// ActiveSurface, step 2: the triangles of each brick.

#include <algorithm>
#include <bit>
#include <vector>

#include "core/extract/active_surface_detail.h"
#include "core/extract/cell_words.h"

namespace isoslider::extract {
namespace {

std::array<std::array<EdgePlace, 12>, kBrickPoints> makeEdgePlaces() {
    std::array<std::array<EdgePlace, 12>, kBrickPoints> places;
    for (int cell = 0; cell < kBrickPoints; ++cell)
        for (int e = 0; e < 12; ++e) {
            const int corner = cell::kCellEdges[e].lowerCorner;
            const int x = (cell & 7) + (corner & 1), y = (cell >> 3 & 7) + (corner >> 1 & 1), z = (cell >> 6) + (corner >> 2);
            const int brick = (x >> 3) | (y >> 3) << 1 | (z >> 3) << 2;
            const int edge = cell::kCellEdges[e].axis * kBrickPoints + (x & 7) + 8 * (y & 7) + 64 * (z & 7);
            places[cell][e] = static_cast<EdgePlace>(brick << kEdgeBits | edge);
        }
    return places;
}

constexpr int kWholeBrickShare = 3; // a brick is laid out anew when more than 1/3 of its cells change

// What writing the triangles of plain states takes, without a look at the large table of states.
struct PlainState {
    std::uint8_t vertices = 0;               ///< three a triangle
    std::array<std::uint8_t, 15> edges{};    ///< cell edges
    std::array<std::uint16_t, 15> steps{};   ///< of an inner cell: from its number into the brick's edge table
};

std::array<PlainState, kPlainStates> makePlainStates() {
    std::array<PlainState, kPlainStates> plain{};
    for (std::size_t s = 0; s < kPlainStates; ++s) {
        if (cell::isAmbiguous(static_cast<std::uint8_t>(s)))
            continue;
        const auto triangles = cell::cellStates()[s].triangles;
        plain[s].vertices = static_cast<std::uint8_t>(triangles.size());
        for (std::size_t k = 0; k < triangles.size(); ++k) {
            const cell::CellEdge& edge = cell::kCellEdges[triangles[k]];
            plain[s].edges[k] = triangles[k];
            plain[s].steps[k] = static_cast<std::uint16_t>(edge.axis * kBrickPoints + (edge.lowerCorner & 1) +
                                                          8 * (edge.lowerCorner >> 1 & 1) + 64 * (edge.lowerCorner >> 2));
        }
    }
    return plain;
}

const std::array<PlainState, kPlainStates>& plainStates() {
    static const auto plain = makePlainStates();
    return plain;
}

// Bucket of each state, kNoBucket where there are no triangles.
constexpr std::uint8_t kNoBucket = 255;

const std::vector<std::uint8_t>& bucketsOfStates() {
    static const std::vector<std::uint8_t> buckets = [] {
        std::vector<std::uint8_t> table;
        for (const cell::CellState& state : cell::cellStates())
            table.push_back(state.triangleCount == 0 ? kNoBucket : kBucketOf[state.triangleCount]);
        return table;
    }();
    return buckets;
}

// Cells whose twelve edges all start in their own brick.
bool isInner(LocalPoint cell) { return (cell & 7) != 7 && (cell & 56) != 56 && cell < 448; }

// Writes triangles of one brick's cells as vertex numbers.
template <class Around>
class CellWriter {
public:
    explicit CellWriter(const Around& around) : bricks_(around.bricks) {}

    void write(LocalPoint cell, cell::StateId state, std::uint32_t* out) const {
        if (state >= kPlainStates)
            return writeAmbiguous(cell, cell::cellStates()[state], out);
        const PlainState& plain = plain_[state];
        if (isInner(cell)) {
            const std::uint16_t* slots = bricks_[0]->slot.data() + cell;
            const std::uint32_t begin = bricks_[0]->vertexBegin;
            for (std::size_t k = 0; k < plain.vertices; ++k)
                out[k] = begin + slots[plain.steps[k]];
            return;
        }
        for (std::size_t k = 0; k < plain.vertices; ++k)
            out[k] = vertexAt(cell, plain.edges[k]);
    }

private:
    std::uint32_t vertexAt(LocalPoint cell, std::size_t edge) const {
        const EdgePlace place = places_[cell][edge];
        return bricks_[place >> kEdgeBits]->vertexOf(place & kEdgeMask);
    }

    // Each edge's vertex is looked up once and used several times.
    void writeAmbiguous(LocalPoint cell, const cell::CellState& state, std::uint32_t* out) const {
        std::array<std::uint32_t, cell::kInnerVertex + 7> vertices;
        for (unsigned mask = cell::activeEdges(state.signs); mask != 0; mask &= mask - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(mask));
            vertices[e] = vertexAt(cell, e);
        }
        if (state.innerVertices > 0) {
            const SlowCells& slow = *bricks_[0]->slow;
            const std::uint32_t first = slow.innerBegin + slow.innerOf(cell).first;
            for (std::uint32_t k = 0; k < state.innerVertices; ++k)
                vertices[cell::kInnerVertex + k] = first + k;
        }
        for (const std::uint8_t vertex : state.triangles)
            *out++ = vertices[vertex];
    }

    const std::array<std::array<EdgePlace, 12>, kBrickPoints>& places_ = edgePlaces();
    const std::array<PlainState, kPlainStates>& plain_ = plainStates();
    const std::array<Brick*, 8>& bricks_;
};

// Asks for the slots of the edges just above a brick, which its outermost cells use: those at x = 0 of
// the next brick along x lie in every line of its table, those at z = 0 in a few.
void prefetchBorders(const std::array<Brick*, 8>& bricks) {
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

// Room for a bucket to grow before the brick is laid out anew; long runs get some only where there are
// ambiguous cells.
std::uint32_t runsWithRoom(std::size_t bucket, std::uint32_t runs, bool hasAmbiguous) {
    if (bucket < kCommonBuckets)
        return runs + runs / 5 + 3;
    return hasAmbiguous ? runs + runs / 4 + 1 : 0;
}

} // namespace

const std::array<std::array<EdgePlace, 12>, kBrickPoints>& edgePlaces() {
    static const auto places = makeEdgePlaces();
    return places;
}

template <class Live>
typename ActiveSurface<Live>::Neighbourhood ActiveSurface<Live>::neighbourhood(const Brick& brick) const {
    Neighbourhood around;
    const BrickGrid& grid = table_.grid();
    for (std::size_t k = 0; k < 8; ++k) {
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
        around.isTouched[k] = entry.isTouched;
    }
    return around;
}

template <class Live>
void ActiveSurface<Live>::retriangulate(Brick& brick, double isovalue, Scratch& scratch) {
    brick.isListedDirty.store(false, std::memory_order_relaxed);
    const Neighbourhood around = neighbourhood(brick);
    EdgeBitsAround touched{};
    for (std::size_t k = 0; k < 8; ++k)
        touched[k] = around.isTouched[k] ? &around.bricks[k]->touched : nullptr;
    scratch.rewritten = cellsWithEdges(touched);
    for (int z = 0; z < kBrickSide; ++z)
        scratch.rewritten[z] &= brick.usableCells[z];
    if (brick.slow)
        for (const AmbiguousCell& ambiguous : brick.slow->ambiguous)
            scratch.rewritten[ambiguous.cell >> 6] |= std::uint64_t{!ambiguous.interval.contains(isovalue)} << (ambiguous.cell & 63);

    if (countBits(scratch.rewritten) > kBrickPoints / 16)
        prefetchBorders(around.bricks);
    const std::int64_t before = brick.triangleCount();
    if (!findStates(brick, around, isovalue, scratch)) {
        scratch.isConsistent = false;
        return;
    }
    if (!patchCells(brick, around, scratch))
        layOutBrick(brick, around);
    scratch.triangleDifference += std::int64_t{brick.triangleCount()} - before;
}

// Moves a bucket's last run into the hole that a cell leaves.
template <class Live>
void ActiveSurface<Live>::removeRun(Brick& brick, LocalPoint cell, int bucket) {
    const auto b = static_cast<std::size_t>(bucket);
    const std::uint32_t last = --brick.bucketRuns[b];
    const std::size_t from = runInBucket(brick, bucket, last);
    const std::size_t to = runInBucket(brick, bucket, brick.cellRun[cell]);
    const std::size_t indices = 3 * std::size_t{kRunLengths[b]};
    if (from != to) {
        const LocalPoint moved = runOwners_[from];
        std::copy_n(indices_.data() + 3 * from, indices, indices_.data() + 3 * to);
        runOwners_[to] = moved;
        brick.cellRun[moved] = brick.cellRun[cell];
    }
    std::fill_n(indices_.data() + 3 * from, indices, 0u);
}

// False when the brick must be laid out anew: its new states are set then, its triangles undefined.
template <class Live>
bool ActiveSurface<Live>::patchCells(Brick& brick, const Neighbourhood& around, Scratch& scratch) {
    std::uint32_t runs = 0;
    for (const std::uint16_t inBucket : brick.bucketRuns)
        runs += inBucket;
    const std::uint8_t* buckets = bucketsOfStates().data();
    const std::array<bool, 256>& isAmbiguous = ambiguousSigns();
    const bool patches = brick.triangleBegin != kNoRun && countBits(scratch.rewritten) * kWholeBrickShare <= static_cast<int>(runs);

    // Delete before add, so that the runs given up are there for the new ones.
    LocalPoint cells[kBrickPoints];
    int count = 0;
    forEachBit(scratch.rewritten, [&](LocalPoint cell) {
        const cell::StateId oldState = stateOf(brick, cell, isAmbiguous);
        const cell::StateId newState = scratch.newState[cell];
        if (oldState != newState) {
            const std::uint8_t before = buckets[oldState];
            brick.changedCells[cell >> 6] |= std::uint64_t{1} << (cell & 63);
            if (newState < kPlainStates) {
                brick.cellSigns[cell] = static_cast<std::uint8_t>(newState);
            } else {
                brick.cellSigns[cell] = cell::cellStates()[newState].signs;
                brick.slow->state[cell] = newState;
            }
            if (patches && before != buckets[newState]) {
                if (before != kNoBucket)
                    removeRun(brick, cell, before);
                brick.cellRun[cell] = kNoSlot;
            }
        }
        if (newState != 0)
            cells[count++] = cell;
    });
    scratch.cells += static_cast<std::uint64_t>(countBits(brick.changedCells));
    if (!patches)
        return false;
    const CellWriter writer(around);
    for (int i = 0; i < count; ++i) {
        const LocalPoint cell = cells[i];
        const cell::StateId state = scratch.newState[cell];
        const int bucket = buckets[state];
        if (brick.cellRun[cell] == kNoSlot) {
            if (brick.bucketRuns[static_cast<std::size_t>(bucket)] == brick.bucketCapacity(bucket))
                return false;
            brick.cellRun[cell] = brick.bucketRuns[static_cast<std::size_t>(bucket)]++;
        }
        const std::uint32_t begin = runInBucket(brick, bucket, brick.cellRun[cell]);
        runOwners_[begin] = cell;
        writer.write(cell, state, indices_.data() + 3 * std::size_t{begin});
    }
    return true;
}

template <class Live>
void ActiveSurface<Live>::layOutBrick(Brick& brick, const Neighbourhood& around) {
    const std::uint8_t* buckets = bucketsOfStates().data();
    const std::array<bool, 256>& isAmbiguous = ambiguousSigns();
    std::array<std::uint32_t, kBuckets> runs{};
    forEachBit(brick.activeCells, [&](LocalPoint cell) { ++runs[buckets[stateOf(brick, cell, isAmbiguous)]]; });
    std::uint32_t total = 0;
    bool isEmpty = true;
    for (std::size_t b = 0; b < kBuckets; ++b) {
        brick.bucketBegin[b] = static_cast<std::uint16_t>(total);
        total += kRunLengths[b] * runsWithRoom(b, runs[b], brick.slow != nullptr);
        isEmpty = isEmpty && runs[b] == 0;
    }
    brick.bucketBegin[kBuckets] = static_cast<std::uint16_t>(total);
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
        const cell::StateId state = stateOf(brick, cell, isAmbiguous);
        const std::size_t bucket = buckets[state];
        brick.cellRun[cell] = brick.bucketRuns[bucket]++;
        const std::uint32_t begin = runInBucket(brick, static_cast<int>(bucket), brick.cellRun[cell]);
        runOwners_[begin] = cell;
        writer.write(cell, state, indices_.data() + 3 * std::size_t{begin});
    });
    // What the runs leave free draws as nothing.
    std::uint32_t* indices = indices_.data() + 3 * std::size_t{brick.triangleBegin};
    for (std::size_t b = 0; b < kBuckets; ++b) {
        const std::uint32_t used = brick.bucketBegin[b] + std::uint32_t{kRunLengths[b]} * brick.bucketRuns[b];
        const std::uint32_t end = b + 1 == kBuckets ? brick.triangleCapacity : brick.bucketBegin[b + 1];
        std::fill(indices + 3 * std::size_t{used}, indices + 3 * std::size_t{end}, 0u);
    }
}

#define ISO_INSTANTIATE(Live)                                                                                                  \
    template typename ActiveSurface<Live>::Neighbourhood ActiveSurface<Live>::neighbourhood(const Brick&) const;               \
    template void ActiveSurface<Live>::retriangulate(Brick&, double, Scratch&);                                                \
    template bool ActiveSurface<Live>::patchCells(Brick&, const Neighbourhood&, Scratch&);                                     \
    template void ActiveSurface<Live>::layOutBrick(Brick&, const Neighbourhood&);                                              \
    template void ActiveSurface<Live>::removeRun(Brick&, LocalPoint, int);
ISO_INSTANTIATE(float)
ISO_INSTANTIATE(double)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
