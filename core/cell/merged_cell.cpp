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

// The cells for which exactly `number` of the words have their bit set: full adders take three words of one weight to
// one of it and one of the next.
template <class Word, std::size_t Count>
Word areSet(std::array<Word, Count> words, unsigned number) {
    Word differs{};
    for (std::size_t count = Count; count > 0; number >>= 1) {
        std::size_t carries = 0;
        Word sum = words[0];
        for (std::size_t i = 1; i < count; i += 2) { // behind the last stands a zero
            const Word b = words[i], c = i + 1 < count ? words[i + 1] : Word{}, either = b ^ c;
            words[carries++] = (b & c) | (sum & either);
            sum ^= either;
        }
        differs |= number & 1 ? ~sum : sum;
        count = carries;
    }
    return number == 0 ? ~differs : Word{};
}

// Calls visit(first corner, axis u, axis v) for the squares of the given spacing.
template <class Visit>
void forEachSquare(std::size_t step, const Visit& visit) {
    for (std::size_t normal = 0; normal < 3; ++normal) {
        const std::size_t axisU = (normal + 1) % 3, axisV = (normal + 2) % 3;
        const auto stride = [](std::size_t axis) { return static_cast<std::size_t>(kStride[axis]); };
        for (std::size_t i = 0; i < 3; i += step)
            for (std::size_t j = 0; j + step < 3; j += step)
                for (std::size_t k = 0; k + step < 3; k += step)
                    visit(i * stride(normal) + j * stride(axisU) + k * stride(axisV), axisU, axisV);
    }
}

// Of cells without an ambiguous face, by the signs of their corners.
template <class Word>
struct Corners {
    Word isCrossed; ///< they differ
    Word hasTwoLoops; ///< two opposite corners differ from the six others
};
template <class Word>
Corners<Word> lookAtCorners(const std::array<Word, 27>& s, std::size_t first, std::size_t step) {
    std::array<Word, 4> all, any; // of opposite corners
    for (std::size_t c = 0; c < 4; ++c) {
        const auto corner = [&](std::size_t k) {
            return s[first + step * ((k & 1) + 3 * (k >> 1 & 1) + 9 * (k >> 2))];
        };
        all[c] = corner(c) & corner(7 - c);
        any[c] = corner(c) | corner(7 - c);
    }
    const Word any01 = any[0] | any[1], any23 = any[2] | any[3], all01 = all[0] & all[1], all23 = all[2] & all[3];
    const Word above = (all[0] & ~(any[1] | any23)) | (all[1] & ~(any[0] | any23)) | (all[2] & ~(any01 | any[3])) |
                       (all[3] & ~(any01 | any[2]));
    const Word below = (all[1] & all23 & ~any[0]) | (all[0] & all23 & ~any[1]) | (all01 & all[3] & ~any[2]) |
                       (all01 & all[2] & ~any[3]);
    return {(any01 | any23) & ~(all01 & all23), above | below};
}

// For each bit of a word what keepsTopology() answers.
template <class Word>
Word keepsTopologyOf(const std::array<Word, 27>& s) {
    Word fails{};
    std::array<std::array<Word, 27>, 3> edges; // by axis and lower point: the signs at its ends differ
    std::array<Word, 54 + 36 + 8> counted; // vertices, loops, and the segments that are not there
    std::size_t count = 0;
    constexpr unsigned kSegments = 36;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto along = static_cast<std::size_t>(kStride[axis]),
                   u = static_cast<std::size_t>(kStride[(axis + 1) % 3]),
                   v = static_cast<std::size_t>(kStride[(axis + 2) % 3]);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                const std::size_t p = i * u + j * v;
                const Word first = s[p] ^ s[p + along], second = s[p + along] ^ s[p + 2 * along];
                edges[axis][p] = counted[count++] = first;
                edges[axis][p + along] = counted[count++] = second;
                if (i != 1 && j != 1) // an edge of the cell
                    fails |= first & second;
            }
    }
    forEachSquare(1, [&](std::size_t p, std::size_t axisU, std::size_t axisV) {
        const auto u = static_cast<std::size_t>(kStride[axisU]), v = static_cast<std::size_t>(kStride[axisV]);
        const Word a = edges[axisU][p], b = edges[axisU][p + v], c = edges[axisV][p], d = edges[axisV][p + u];
        fails |= a & b & c & d; // ambiguous
        counted[count++] = ~(a | b | c);
    });
    forEachSquare(2, [&](std::size_t p, std::size_t axisU, std::size_t axisV) {
        const auto u = static_cast<std::size_t>(kStride[axisU]), v = static_cast<std::size_t>(kStride[axisV]);
        const Word a = s[p], b = s[p + 2 * u], c = s[p + 2 * v], d = s[p + 2 * (u + v)];
        fails |= ~(a ^ d) & ~(b ^ c) & (a ^ b);
        // The middle of the face, which differs from those of all its edges.
        fails |= edges[axisU][p + v] & edges[axisU][p + u + v] & edges[axisV][p + u] & edges[axisV][p + u + v];
    });
    const Corners<Word> whole = lookAtCorners(s, 0, 2);
    fails |= ~whole.isCrossed | whole.hasTwoLoops; // no loop, or two
    for (std::size_t c = 0; c < 8; ++c) {
        const Corners<Word> half = lookAtCorners(s, (c & 1) + 3 * (c >> 1 & 1) + 9 * (c >> 2), 1);
        fails |= half.hasTwoLoops;
        counted[count++] = half.isCrossed;
    }
    Word any{}, all = ~Word{};
    for (const Word sign : s) {
        any |= sign;
        all &= sign;
    }
    return (~fails & areSet(counted, kSegments + 1)) | ~any | all;
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
