#include "core/cell/merged_cell.h"

#include <array>
#include <bit>

#include "core/cell/cell_numbering.h"
#include "core/cell/cell_states.h"

namespace isoslider::cell {
namespace {

constexpr int kStride[3] = {1, 3, 9};

// Samples whose coordinates lie below `end`, in steps of `step`, per axis.
constexpr MergedSigns places(int endX, int endY, int endZ, int step) {
    MergedSigns mask = 0;
    for (int z = 0; z < endZ; z += step)
        for (int y = 0; y < endY; y += step)
            for (int x = 0; x < endX; x += step)
                mask |= MergedSigns{1} << (x + 3 * y + 9 * z);
    return mask;
}

// Where edges and squares along the axes of a bit set start, at the spacing of the halves (1) or of the cell (2).
constexpr MergedSigns edgeStarts(int axis, int step) {
    const auto end = [&](int a) { return a == axis ? 3 - step : 3; };
    return places(end(0), end(1), end(2), step);
}
constexpr MergedSigns squareStarts(int normal, int step) {
    const auto end = [&](int a) { return a != normal ? 3 - step : 3; };
    return places(end(0), end(1), end(2), step);
}

// Squares with a corner pattern: both diagonals of one sign each, and those differ.
bool hasAmbiguousSquare(MergedSigns s, int step) {
    for (int normal = 0; normal < 3; ++normal) {
        const int u = step * kStride[(normal + 1) % 3], v = step * kStride[(normal + 2) % 3];
        if ((~(s ^ s >> (u + v)) & ~(s >> u ^ s >> v) & (s ^ s >> u) & squareStarts(normal, step)) != 0)
            return true;
    }
    return false;
}

std::uint8_t cornersFrom(MergedSigns s, int first, int step) {
    unsigned corners = 0;
    for (int c = 0; c < 8; ++c)
        corners |= (s >> (first + step * ((c & 1) + 3 * (c >> 1 & 1) + 9 * (c >> 2))) & 1u) << c;
    return static_cast<std::uint8_t>(corners);
}

int loopsOf(std::uint8_t corners) { return cellStates()[corners].loops; }

// A middle that differs from the middles of its face's four edges.
bool hasLoneMiddle(MergedSigns s) {
    for (int normal = 0; normal < 3; ++normal) {
        const int u = kStride[(normal + 1) % 3], v = kStride[(normal + 2) % 3];
        for (const int start : {0, 2 * kStride[normal]}) {
            const int m = start + u + v;
            const unsigned middle = s >> m & 1;
            if ((s >> (m - u) & 1) != middle && (s >> (m + u) & 1) != middle && (s >> (m - v) & 1) != middle &&
                (s >> (m + v) & 1) != middle)
                return true;
        }
    }
    return false;
}

// Vertices less segments and loops of the halves' surface. REQUIRES: no square is ambiguous, no half has two loops.
int eulerNumberOfHalves(MergedSigns s) {
    int euler = 0;
    for (int axis = 0; axis < 3; ++axis) {
        euler += std::popcount((s ^ s >> kStride[axis]) & edgeStarts(axis, 1));
        const int u = kStride[(axis + 1) % 3], v = kStride[(axis + 2) % 3];
        const MergedSigns any = s | s >> u | s >> v | s >> (u + v), all = s & s >> u & s >> v & s >> (u + v);
        euler -= std::popcount(any & ~all & squareStarts(axis, 1));
    }
    for (int c = 0; c < 8; ++c) {
        const std::uint8_t half = cornersFrom(s, (c & 1) + 3 * (c >> 1 & 1) + 9 * (c >> 2), 1);
        euler += half != 0 && half != 255;
    }
    return euler;
}

} // namespace

bool keepsTopology(MergedSigns s) {
    if (s == 0 || s == kAllAbove)
        return true;
    for (int axis = 0; axis < 3; ++axis)
        if ((~(s ^ s >> 2 * kStride[axis]) & (s ^ s >> kStride[axis]) & edgeStarts(axis, 2)) != 0)
            return false;
    if (hasAmbiguousSquare(s, 1) || hasAmbiguousSquare(s, 2) || hasLoneMiddle(s))
        return false;
    if (loopsOf(cornersFrom(s, 0, 2)) != 1)
        return false;
    for (int c = 0; c < 8; ++c)
        if (loopsOf(cornersFrom(s, (c & 1) + 3 * (c >> 1 & 1) + 9 * (c >> 2), 1)) > 1)
            return false;
    return eulerNumberOfHalves(s) == 1;
}

} // namespace isoslider::cell
