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

// How many of the words that it is given have their bit set, as a number for each bit: full adders take three words of
// one weight to one of it and one of the next.
template <class Word>
class BitwiseSum {
public:
    [[gnu::always_inline]] inline void addEight(const std::array<Word, 8>& w) {
        const Word twosA = carryOf(ones_, w[0], w[1]), twosB = carryOf(ones_, w[2], w[3]),
                   foursA = carryOf(twos_, twosA, twosB), twosC = carryOf(ones_, w[4], w[5]),
                   twosD = carryOf(ones_, w[6], w[7]), foursB = carryOf(twos_, twosC, twosD);
        Word carry = carryOf(fours_, foursA, foursB);
        for (Word& bits : higher_) {
            const Word next = bits & carry;
            bits ^= carry;
            carry = next;
        }
    }
    [[gnu::always_inline]] inline Word is(unsigned number) const {
        Word differs = (number & 1 ? ~ones_ : ones_) | (number & 2 ? ~twos_ : twos_) | (number & 4 ? ~fours_ : fours_);
        for (std::size_t i = 0; i < higher_.size(); ++i)
            differs |= number >> (3 + i) & 1 ? ~higher_[i] : higher_[i];
        return ~differs;
    }

private:
    [[gnu::always_inline]] static inline Word carryOf(Word& sum, Word a, Word b) {
        const Word either = sum ^ a, carry = (sum & a) | (either & b);
        sum = either ^ b;
        return carry;
    }
    Word ones_{}, twos_{}, fours_{};
    std::array<Word, 4> higher_{}; // up to 127
};

// Of cells without an ambiguous face: two opposite corners differ from the six others, so all edges at both are
// crossed. Edges along x by y + 2 z, along y by x + 2 z, along z by x + 2 y.
template <class Word>
[[gnu::always_inline]] inline Word haveTwoLoops(const std::array<Word, 4>& x, const std::array<Word, 4>& y,
                                                const std::array<Word, 4>& z) {
    return (x[0] & y[0] & z[0] & (x[3] & y[3] & z[3])) | (x[0] & y[1] & z[1] & (x[3] & y[2] & z[2])) |
           (x[1] & y[0] & z[2] & (x[2] & y[3] & z[1])) | (x[1] & y[1] & z[3] & (x[2] & y[2] & z[0]));
}

// For each bit of a word what keepsTopology() answers. Where the corners of a cell of a grid differ, two neighbouring
// ones do, so all follows from the edges.
template <class Word>
[[gnu::always_inline]] inline Word keepsTopologyOf(const std::array<Word, 27>& s) {
    constexpr std::array<std::size_t, 3> kStrides{1, 3, 9};
    constexpr unsigned kSegments = 36;
    Word fails{};
    std::array<std::array<Word, 27>, 3> edges; // by axis and lower point: the signs at its ends differ
    std::array<std::array<Word, 27>, 3> crossed; // squares of the halves, by their normal and first point
    BitwiseSum<Word> sum; // vertices, loops, and the segments that are not there
#pragma GCC unroll 3
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t along = kStrides[axis], u = kStrides[(axis + 1) % 3], v = kStrides[(axis + 2) % 3];
#pragma GCC unroll 3
        for (std::size_t i = 0; i < 3; ++i)
#pragma GCC unroll 3
            for (std::size_t j = 0; j < 3; ++j) {
                const std::size_t p = i * u + j * v;
                const Word first = s[p] ^ s[p + along], second = s[p + along] ^ s[p + 2 * along];
                edges[axis][p] = first;
                edges[axis][p + along] = second;
                if (i != 1 && j != 1) // an edge of the cell
                    fails |= first & second;
            }
    }
#pragma GCC unroll 3
    for (std::size_t normal = 0; normal < 3; ++normal) {
        const std::size_t axisU = (normal + 1) % 3, axisV = (normal + 2) % 3, u = kStrides[axisU], v = kStrides[axisV];
#pragma GCC unroll 3
        for (std::size_t layer = 0; layer < 3; ++layer) {
            const std::size_t corner = layer * kStrides[normal];
            std::array<Word, 4> noSegments;
#pragma GCC unroll 4
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t p = corner + (k & 1 ? u : 0) + (k & 2 ? v : 0);
                const Word a = edges[axisU][p], b = edges[axisU][p + v], c = edges[axisV][p], d = edges[axisV][p + u];
                fails |= a & b & (c & d); // ambiguous
                crossed[normal][p] = a | b | c;
                noSegments[k] = ~crossed[normal][p];
            }
            sum.addEight({edges[axisU][corner], edges[axisU][corner + u], edges[axisU][corner + v],
                          edges[axisU][corner + u + v], noSegments[0], noSegments[1], noSegments[2], noSegments[3]});
            if (layer == 1)
                continue;
            // The face of the cell.
            const Word a = s[corner], b = s[corner + 2 * u], c = s[corner + 2 * v], d = s[corner + 2 * (u + v)];
            fails |= ~(a ^ d) & ~(b ^ c) & (a ^ b);
            // Its middle differs from those of all its edges.
            fails |= edges[axisU][corner + v] & edges[axisU][corner + u + v] & edges[axisV][corner + u] &
                     edges[axisV][corner + u + v];
        }
    }
    // The edges behind those squares, and the halves.
    std::array<Word, 32> rest{};
    std::size_t count = 0;
#pragma GCC unroll 3
    for (std::size_t normal = 0; normal < 3; ++normal) {
        const std::size_t axisU = (normal + 1) % 3, u = kStrides[axisU], v = kStrides[(normal + 2) % 3];
#pragma GCC unroll 3
        for (std::size_t layer = 0; layer < 3; ++layer) {
            const std::size_t p = layer * kStrides[normal] + 2 * v;
            rest[count++] = edges[axisU][p];
            rest[count++] = edges[axisU][p + u];
        }
    }
    Word isAnyCrossed{};
#pragma GCC unroll 8
    for (std::size_t c = 0; c < 8; ++c) {
        const std::size_t p = kStrides[0] * (c & 1) + kStrides[1] * (c >> 1 & 1) + kStrides[2] * (c >> 2);
        fails |= haveTwoLoops<Word>({edges[0][p], edges[0][p + 3], edges[0][p + 9], edges[0][p + 12]},
                                    {edges[1][p], edges[1][p + 1], edges[1][p + 9], edges[1][p + 10]},
                                    {edges[2][p], edges[2][p + 1], edges[2][p + 3], edges[2][p + 4]});
        rest[count] = crossed[2][p] | crossed[2][p + 9] | edges[2][p];
        isAnyCrossed |= rest[count++];
    }
#pragma GCC unroll 4
    for (std::size_t i = 0; i < rest.size(); i += 8)
        sum.addEight(
            {rest[i], rest[i + 1], rest[i + 2], rest[i + 3], rest[i + 4], rest[i + 5], rest[i + 6], rest[i + 7]});
    // The cell's edges are crossed where one of its two halves is, for none is twice.
    const auto whole = [&](std::size_t axis, std::size_t p) {
        return edges[axis][p] ^ edges[axis][p + kStrides[axis]];
    };
    const std::array<Word, 4> x{whole(0, 0), whole(0, 6), whole(0, 18), whole(0, 24)},
        y{whole(1, 0), whole(1, 2), whole(1, 18), whole(1, 20)}, z{whole(2, 0), whole(2, 2), whole(2, 6), whole(2, 8)};
    fails |= ~(x[0] | x[1] | x[2] | x[3] | y[0] | y[2] | z[0]) | haveTwoLoops(x, y, z); // no loop, or two
    return (~fails & sum.is(kSegments + 1)) | ~isAnyCrossed;
}

} // namespace

std::uint64_t keepsTopologyOf64(const std::array<std::uint64_t, 27>& signs) { return keepsTopologyOf(signs); }
TwoWords keepsTopologyOf128(const std::array<TwoWords, 27>& signs) { return keepsTopologyOf(signs); }

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
