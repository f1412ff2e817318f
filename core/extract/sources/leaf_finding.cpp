#include "core/extract/sources/leaf_finding.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <type_traits>

#include "core/cell/merged_cell.h"
#include "core/extract/live/pair_cells.h"
#include "core/extract/merged/merged_interpolant.h"
#include "core/grid/scalar_type.h"

namespace isoslider::extract {
namespace {

// The 27 signs of all cells of side 2, in words as keepsTopologyOf64() has them.
using SignWords = std::array<std::uint64_t, 27>;

// By rows of nine bits: for x = 0, 1 and 2 of a cell of side 2 the signs of the row's four cells, each in 20 bits.
constexpr unsigned kRowsWidth = 20;
constexpr std::array<std::uint64_t, 512> kRowSigns = [] {
    std::array<std::uint64_t, 512> found{};
    for (std::size_t row = 0; row < found.size(); ++row)
        for (unsigned x = 0; x < 3; ++x)
            for (unsigned cell = 0; cell < 4; ++cell)
                found[row] |= std::uint64_t{row >> (2 * cell + x) & 1} << (kRowsWidth * x + cell);
    return found;
}();

void gatherSigns(const BitString& above, SignWords& signs) {
    signs.fill(0);
#pragma GCC unroll 9
    for (int z = 0; z < kPointSide; ++z) {
        std::uint64_t even = 0, odd = 0; // rows, each behind the one before
#pragma GCC unroll 9
        for (int y = 0; y < kPointSide; ++y)
            (y % 2 == 0 ? even : odd) |= kRowSigns[bitsFrom(above, closedPoint(0, y, z)) & 511] << (4 * (y / 2));
        for (std::size_t x = 0; x < 3; ++x) {
            const std::uint64_t evenRows = even >> (kRowsWidth * x), oddRows = odd >> (kRowsWidth * x);
            const std::array<std::uint64_t, 3> planes{evenRows & 0xffff, oddRows & 0xffff, evenRows >> 4 & 0xffff};
            for (std::size_t y = 0; y < 3; ++y) {
                // A plane at an even place is the first of one layer of cells and the last of the one before.
                std::uint64_t* const ofPoint = signs.data() + x + 3 * y;
                if (z % 2 != 0)
                    ofPoint[9] |= planes[y] << (16 * (z / 2));
                else if (z < kCellSide)
                    ofPoint[0] |= planes[y] << (16 * (z / 2));
                if (z % 2 == 0 && z > 0)
                    ofPoint[18] |= planes[y] << (16 * (z / 2 - 1));
            }
        }
    }
}

// The same of the 8 cells of side 4, and in bit 8 of the one of side 8.
void gatherSignsOfLarger(const BitString& above, SignWords& signs) {
    // Bits of the points with even coordinates, five in a row.
    std::array<unsigned, 25> rows;
    for (int y = 0; y < 5; ++y)
        for (int z = 0; z < 5; ++z)
            rows[static_cast<std::size_t>(y + 5 * z)] = splitRow(bitsFrom(above, closedPoint(0, 2 * y, 2 * z))).even;
    for (int sz = 0; sz < 3; ++sz)
        for (int sy = 0; sy < 3; ++sy) {
            std::array<unsigned, 4> pairs; // of the cells with one y and z: the row through the point
            for (int i = 0; i < 4; ++i)
                pairs[static_cast<std::size_t>(i)] =
                    rows[static_cast<std::size_t>(2 * (i & 1) + sy + 5 * (2 * (i >> 1) + sz))];
            const unsigned whole = splitRow(rows[static_cast<std::size_t>(2 * sy + 5 * 2 * sz)]).even;
            for (int sx = 0; sx < 3; ++sx) {
                std::uint64_t word = std::uint64_t{whole >> sx & 1} << 8;
                for (int i = 0; i < 4; ++i) {
                    const unsigned row = pairs[static_cast<std::size_t>(i)] >> sx;
                    word |= std::uint64_t{(row & 1) | (row >> 1 & 2)} << (2 * i);
                }
                signs[static_cast<std::size_t>(sx + 3 * sy + 9 * sz)] = word;
            }
        }
}

// A cell of side 2^level by its first cell.
struct MergedCell {
    std::array<int, 3> origin;
    int level;
};

template <class Sample>
class BoundCheck {
public:
    BoundCheck(const StoredSample<Sample>* samples, const ActiveBits& active, const BitString& aboveBefore,
               const MergeBound& bound)
        : samples_(samples), active_(active), aboveBefore_(aboveBefore), bound_(bound) {}

    // An active edge that does not keep to the bound in the cell, or -1. `wasWithin`: those that were active before do.
    int findExceeding(const MergedCell& cell, bool wasWithin) const {
        const int side = 1 << cell.level;
        const auto [x0, y0, z0] = cell.origin;
        cell::CornerScalars corners;
        for (std::size_t c = 0; c < 8; ++c)
            corners[c] = sampleAt(x0 + (c & 1 ? side : 0), y0 + (c & 2 ? side : 0), z0 + (c & 4 ? side : 0));
        const MergedInterpolant interpolant(corners, side);
        constexpr int kTogether = 5; // rows that one look at the bits covers
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int endX = axis == 0 ? side : side + 1, endY = axis == 1 ? side : side + 1,
                      endZ = axis == 2 ? side : side + 1;
            for (int z = 0; z < endZ; ++z)
                for (int fromY = 0; fromY < endY; fromY += kTogether) {
                    const ClosedPoint first = closedPoint(x0, y0 + fromY, z0 + z);
                    std::uint64_t rows =
                        bitsFrom(active_.edges[axis], first) & kRows[static_cast<std::size_t>(endX)] &
                        ((std::uint64_t{1} << kPointStride[1] * std::min(kTogether, endY - fromY)) - 1);
                    if (wasWithin && rows != 0)
                        rows &= ~(bitsFrom(aboveBefore_, first) ^ bitsFrom(aboveBefore_, first + kPointStride[axis]));
                    for (; rows != 0; rows &= rows - 1) {
                        const int place = std::countr_zero(rows), y = place / kPointStride[1],
                                  x = place - kPointStride[1] * y;
                        const ClosedPoint lower = first + place;
                        if (!interpolant.keepsWithin(bound_, {x, fromY + y, z}, axis, sampleAt(lower),
                                                     sampleAt(lower + kPointStride[axis])))
                            return closedEdge(static_cast<int>(axis), lower).number();
                    }
                }
        }
        return -1;
    }
    // Whether the bound holds for each active edge in the cell. `exceeding`: its place in ExceedingEdges::ofLarger.
    bool isWithin(const MergedCell& cell, bool wasWithin, std::uint16_t& exceeding) const {
        if (!wasWithin && exceeding != 0) {
            const ClosedEdge edge(exceeding - 1);
            if (active_.edges[static_cast<std::size_t>(axisOf(edge))].test(startOf(edge)))
                return false;
        }
        const int found = findExceeding(cell, wasWithin);
        if (found >= 0)
            exceeding = static_cast<std::uint16_t>(found + 1);
        return found < 0;
    }
    // The same of a cell of side 2. Most are asked for a few times, while a handle goes fast or turns round; of others
    // it pays to look at all edges once.
    bool isPairWithin(int pair, const BitString& above, bool wasWithin, ExceedingEdges& exceeding) const {
        constexpr std::uint8_t kOften = 4;
        const auto number = static_cast<std::size_t>(pair);
        const ClosedPoint first = closedPoint(2 * (pair % 4), 2 * (pair / 4 % 4), 2 * (pair / 16));
        PairEdges edges = activeEdges(signsOfPair(above, first));
        std::uint8_t& asked = exceeding.asked[number];
        if (asked >= kOften) {
            PairEdges& all = exceeding.allOfPairs[number];
            if (asked == kOften) {
                all = findExceedingOfPair(first, kLowerPoints, [](std::uint8_t) { return true; });
                ++asked;
            }
            return ((edges[0] & all[0]) | (edges[1] & all[1]) | (edges[2] & all[2])) == 0;
        }
        ++asked;
        std::uint8_t& known = exceeding.ofPairs[number];
        if (wasWithin) {
            const PairEdges before = activeEdges(signsOfPair(aboveBefore_, first));
            for (std::size_t axis = 0; axis < 3; ++axis)
                edges[axis] &= ~before[axis];
        } else if (known != 0 && (edges[(known - 1u) % 3] >> ((known - 1u) / 3) & 1) != 0) {
            return false;
        }
        const PairEdges found = findExceedingOfPair(first, edges, [&](std::uint8_t edge) {
            known = edge;
            return false;
        });
        return (found[0] | found[1] | found[2]) == 0;
    }

private:
    // By how many there are, the first points of each of five rows.
    static constexpr std::array<std::uint64_t, kPointSide + 1> kRows = [] {
        std::array<std::uint64_t, kPointSide + 1> rows{};
        for (std::size_t length = 0; length < rows.size(); ++length)
            for (unsigned y = 0; y < 5; ++y)
                rows[length] |= ((std::uint64_t{1} << length) - 1) << (kPointStride[1] * y);
        return rows;
    }();
    using PairEdges = std::array<std::uint32_t, 3>; ///< by axis, bits x + 3 y + 9 z of the points where they start
    static constexpr PairEdges kLowerPoints{0333333333, 0077077077, 0000777777}; ///< all edges
    static PairEdges activeEdges(std::uint32_t signs) {
        return {(signs ^ signs >> 1) & kLowerPoints[0], (signs ^ signs >> 3) & kLowerPoints[1],
                (signs ^ signs >> 9) & kLowerPoints[2]};
    }

    // Of the given edges of a cell of side 2 those that exceed the bound; goesOn(edge) says whether to look for more.
    template <class GoesOn>
    PairEdges findExceedingOfPair(ClosedPoint first, const PairEdges& among, const GoesOn& goesOn) const {
        PairEdges found{};
        if ((among[0] | among[1] | among[2]) == 0)
            return found;
        cell::CornerScalars corners;
        for (std::size_t c = 0; c < 8; ++c)
            corners[c] =
                sampleAt(first + 2 * (static_cast<int>(c & 1) + kPointStride[1] * static_cast<int>(c >> 1 & 1) +
                                      kPointStride[2] * static_cast<int>(c >> 2)));
        const MergedInterpolant interpolant(corners, 2);
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::uint32_t open = among[axis]; open != 0; open &= open - 1) {
                const int i = std::countr_zero(open), x = i % 3, y = i / 3 % 3, z = i / 9;
                const ClosedPoint lower = first + (x + kPointStride[1] * y + kPointStride[2] * z);
                if (interpolant.keepsWithin(bound_, {x, y, z}, axis, sampleAt(lower),
                                            sampleAt(lower + kPointStride[axis])))
                    continue;
                found[axis] |= std::uint32_t{1} << i;
                if (!goesOn(static_cast<std::uint8_t>(1 + 3 * i + static_cast<int>(axis))))
                    return found;
            }
        return found;
    }
    double sampleAt(ClosedPoint point) const { return static_cast<double>(sampleOf<Sample>(samples_[point.index()])); }
    double sampleAt(int x, int y, int z) const {
        return static_cast<double>(sampleOf<Sample>(samples_[closedPoint(x, y, z).index()]));
    }

    const StoredSample<Sample>* samples_;
    const ActiveBits& active_;
    const BitString& aboveBefore_;
    const MergeBound& bound_;
};

// The samples of a brick, and how far cells of one side are from them.
class BrickErrors {
public:
    template <class Sample>
    BrickErrors(std::type_identity<Sample>, const StoredSample<Sample>* samples) {
        for (std::size_t p = 0; p < samples_.size(); ++p) {
            samples_[p] = static_cast<double>(sampleOf<Sample>(samples[p]));
            largest_ = std::max(largest_, std::abs(samples_[p]));
        }
    }

    // Whether squares of differences neither overflow nor vanish.
    bool areOfUsualSize() const { return largest_ > 1e-140 && largest_ < 1e140; }

    // Whether the bound holds wherever edges are active: one answer a cell, in the order of x, y, z.
    template <int Side, class Answer>
    void check(const MergeBound& bound, const Answer& answer) {
        interpolate<Side>();
        constexpr int kCells = kCellSide / Side;
        const std::array<double, kClosedPoints>& errors = largestInCells<Side>();
        const double slack = bound.measure == MergeBound::Measure::Scalar ? 1.0 : 1.0 + bound.limit;
        for (int i = 0; i < kCells * kCells * kCells; ++i) {
            const int x = i % kCells, y = i / kCells % kCells, z = i / (kCells * kCells);
            // Rounding, here and where single edges are looked at.
            const double error =
                errors[static_cast<std::size_t>(x + kPointSide * (y + kPointSide * z))] + 1e-13 * largest_ * slack;
            const double unit = bound.measure == MergeBound::Measure::Scalar
                                    ? 1.0
                                    : leastGradient(closedPoint(Side * x, Side * y, Side * z), Side);
            answer(i, error <= (1.0 - 1e-9) * bound.limit * unit);
        }
    }

private:
    static constexpr std::size_t at(int x, int y, int z) { return closedPoint(x, y, z).index(); }

    // Along x where y and z are multiples of the side, then along y where z is one, then along z. Errors of all points.
    template <int Side>
    void interpolate() {
        constexpr double kStep = 1.0 / Side;
        auto& values = interpolated_;
        for (int z = 0; z < kPointSide; z += Side)
            for (int y = 0; y < kPointSide; y += Side)
                for (int x = 0; x < kCellSide; x += Side) {
                    const double first = samples_[at(x, y, z)], last = samples_[at(x + Side, y, z)];
                    for (int k = 0; k <= Side; ++k)
                        values[at(x + k, y, z)] = first * (1.0 - k * kStep) + last * (k * kStep);
                }
        for (int z = 0; z < kPointSide; z += Side)
            for (int y = 0; y < kCellSide; y += Side)
                for (int k = 1; k < Side; ++k)
                    blend(at(0, y, z), at(0, y + Side, z), at(0, y + k, z), kPointSide, k * kStep);
        for (int z = 0; z < kCellSide; z += Side)
            for (int k = 1; k < Side; ++k)
                blend(at(0, 0, z), at(0, 0, z + Side), at(0, 0, z + k), kPointStride[2], k * kStep);
        for (std::size_t p = 0; p < values.size(); ++p)
            values[p] = std::abs(values[p] - samples_[p]);
    }
    void blend(std::size_t first, std::size_t last, std::size_t out, int count, double t) {
        double* const values = interpolated_.data();
        for (int i = 0; i < count; ++i)
            values[out + static_cast<std::size_t>(i)] = values[first + static_cast<std::size_t>(i)] * (1.0 - t) +
                                                        values[last + static_cast<std::size_t>(i)] * t;
    }

    // The largest error of the points of each cell, at the cell's place among its like.
    template <int Side>
    const std::array<double, kClosedPoints>& largestInCells() {
        constexpr int kCells = kCellSide / Side;
        double* const errors = interpolated_.data();
        const auto reduce = [&](std::size_t from, int stride, std::size_t out) {
            double most = 0.0;
            for (int k = 0; k <= Side; ++k)
                most = std::max(most, errors[from + static_cast<std::size_t>(k * stride)]);
            errors[out] = most;
        };
        for (int row = 0; row < kPointSide * kPointSide; ++row)
            for (int x = 0; x < kCells; ++x)
                reduce(static_cast<std::size_t>(kPointSide * row + Side * x), 1,
                       static_cast<std::size_t>(kPointSide * row + x));
        for (int z = 0; z < kPointSide; ++z)
            for (int y = 0; y < kCells; ++y)
                for (int x = 0; x < kCells; ++x)
                    reduce(at(x, Side * y, z), kPointStride[1], at(x, y, z));
        for (int z = 0; z < kCells; ++z)
            for (int y = 0; y < kCells; ++y)
                for (int x = 0; x < kCells; ++x)
                    reduce(at(x, y, Side * z), kPointStride[2], at(x, y, z));
        return interpolated_;
    }

    // A lower bound on the length of the interpolant's gradient in a cell: each component is a blend of the
    // differences along the cell's four edges.
    double leastGradient(ClosedPoint first, int side) const {
        double square = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int along = side * kPointStride[axis], u = side * kPointStride[(axis + 1) % 3],
                      v = side * kPointStride[(axis + 2) % 3];
            double least = std::numeric_limits<double>::infinity(), most = -least;
            for (const int place : {0, u, v, u + v}) {
                const std::size_t p = first.index() + static_cast<std::size_t>(place);
                const double difference = samples_[p + static_cast<std::size_t>(along)] - samples_[p];
                least = std::min(least, difference);
                most = std::max(most, difference);
            }
            const double smallest = least > 0.0 ? least : most < 0.0 ? -most : 0.0;
            square += smallest * smallest;
        }
        return std::sqrt(square) / side;
    }

    std::array<double, kClosedPoints> samples_, interpolated_;
    double largest_ = 0.0;
};

} // namespace

namespace {

template <class Sample>
BrickLeaves findWithin(const StoredSample<Sample>* samples, const MergeBound& bound) {
    BrickErrors errors(std::type_identity<Sample>(), samples);
    BrickLeaves within;
    if (!errors.areOfUsualSize())
        return within;
    errors.check<2>(bound, [&](int i, bool is) { within.level1 |= std::uint64_t{is} << i; });
    errors.check<4>(bound, [&](int i, bool is) { within.level2 = static_cast<std::uint8_t>(within.level2 | is << i); });
    errors.check<8>(bound, [&](int, bool is) { within.level3 = is; });
    return within;
}

// A byte for each point: bits 2 a and 2 a + 1 state whether along axis a the samples ascend, and descend, throughout
// the cell of side 2 that starts there. A missing sample does neither.
using Directions = std::array<std::uint8_t, kClosedPoints>;

template <class Stored>
void findDirections(const Stored* samples, Directions& directions) {
    directions.fill(0);
    Directions edges{}, along{}, across{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto stride = static_cast<std::size_t>(kPointStride[axis]),
                   u = static_cast<std::size_t>(kPointStride[(axis + 1) % 3]),
                   v = static_cast<std::size_t>(kPointStride[(axis + 2) % 3]);
        // Points behind the last cell of a row take part in nothing that is looked at.
        const std::size_t count = kClosedPoints - stride;
        for (std::size_t p = 0; p < count; ++p)
            edges[p] = static_cast<std::uint8_t>((samples[p] <= samples[p + stride] ? 1 : 0) |
                                                 (samples[p] >= samples[p + stride] ? 2 : 0));
        const std::size_t countAlong = count - stride;
        for (std::size_t p = 0; p < countAlong; ++p)
            along[p] = edges[p] & edges[p + stride];
        const std::size_t countU = countAlong - 2 * u;
        for (std::size_t p = 0; p < countU; ++p)
            across[p] = along[p] & along[p + u] & along[p + 2 * u];
        const std::size_t countV = countU - 2 * v;
        for (std::size_t p = 0; p < countV; ++p)
            directions[p] = static_cast<std::uint8_t>(directions[p] | (across[p] & across[p + v] & across[p + 2 * v])
                                                                          << (2 * axis));
    }
}

constexpr bool isMonotone(unsigned directions) {
    return (directions & 3) != 0 && (directions >> 2 & 3) != 0 && (directions >> 4 & 3) != 0;
}

template <class Stored>
BrickLeaves findMonotone(const Stored* samples) {
    Directions directions;
    findDirections(samples, directions);
    BrickLeaves monotone;
    std::array<unsigned, 8> ofHalves;
    ofHalves.fill(~0u);
    unsigned ofAll = ~0u;
    for (unsigned i = 0; i < 64; ++i) {
        const unsigned x = i % 4, y = i / 4 % 4, z = i / 16;
        const unsigned cell =
            directions[closedPoint(static_cast<int>(2 * x), static_cast<int>(2 * y), static_cast<int>(2 * z)).index()];
        monotone.level1 |= std::uint64_t{isMonotone(cell)} << i;
        ofHalves[x / 2 + 2 * (y / 2) + 4 * (z / 2)] &= cell;
        ofAll &= cell;
    }
    for (unsigned i = 0; i < 8; ++i)
        monotone.level2 = static_cast<std::uint8_t>(monotone.level2 | unsigned{isMonotone(ofHalves[i])} << i);
    monotone.level3 = isMonotone(ofAll);
    return monotone;
}

} // namespace

template <class Sample>
SureCells findSureCells(const StoredSample<Sample>* samples, const BitString& validCells, const MergeBound& bound) {
    SureCells sure{findWithin<Sample>(samples, bound), findMonotone(samples), allOfEight(validCells), false, true};
    sure.isOneLeaf = sure.within == leafBits(3, 0) && sure.monotone.level3 && sure.valid == ~std::uint64_t{0};
    return sure;
}

// Cells of side 4 for whose parts a condition holds.
template <class Condition>
unsigned halvesWhere(const Condition& holds) {
    unsigned halves = 0;
    for (unsigned i = 0; i < 8; ++i)
        halves |= unsigned{holds(pairsOfFour(i))} << i;
    return halves;
}

namespace {
// `crossed`: cells of side 2 with active cells in them.
BrickLeaves leavesOfSurface(const BrickLeaves& leaves, std::uint64_t crossed) {
    if (!leaves.hasMerged())
        return {};
    if (leaves.level3)
        return crossed != 0 ? leaves : BrickLeaves();
    BrickLeaves found{leaves.level1 & crossed, 0, false};
    for (unsigned open = leaves.level2; open != 0; open &= open - 1) {
        const auto i = static_cast<unsigned>(std::countr_zero(open));
        if ((crossed & pairsOfFour(i)) == 0)
            continue;
        found.level1 |= pairsOfFour(i);
        found.level2 = static_cast<std::uint8_t>(found.level2 | 1u << i);
    }
    return found;
}
} // namespace

template <class Sample>
FoundLeaves findBrickLeaves(const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                            const BitString& validCells, const MergeBound& bound, const SureCells& sure,
                            ExceedingEdges& exceeding) {
    BitString all;
    all.words.fill(~std::uint64_t{0});
    return updateBrickLeaves<Sample>({}, above, all, samples, above, active, validCells, bound, sure, exceeding);
}

namespace {
template <class Sample>
BrickLeaves updateUsable(const BrickLeaves& before, std::uint64_t touched, std::uint64_t crossed,
                         const BoundCheck<Sample>& check, const BitString& above, std::uint64_t valid,
                         const SureCells& sure, ExceedingEdges& exceeding) {
    if (touched == 0)
        return before;
    const std::uint64_t asked = touched & valid & crossed;
    BrickLeaves leaves;
    SignWords signs;
    std::uint64_t keptSmaller = sure.monotone.level1, keptLarger = 0;
    const bool decidesSmaller = (asked & ~keptSmaller) != 0;
    // Where cells were large they mostly stay so: then all sizes are decided at once.
    const bool decidesAll = decidesSmaller && before.level2 != 0;
    if (decidesAll) {
        gatherSigns(above, signs);
        SignWords larger;
        gatherSignsOfLarger(above, larger);
        std::array<cell::TwoWords, 27> both;
        for (std::size_t i = 0; i < both.size(); ++i)
            both[i] = cell::TwoWords{signs[i], larger[i]};
        const cell::TwoWords kept = cell::keepsTopologyOf128(both);
        keptSmaller = kept[0];
        keptLarger = kept[1];
    } else if (decidesSmaller) {
        gatherSigns(above, signs);
        keptSmaller = cell::keepsTopologyOf64(signs);
    }
    const std::uint64_t kept = asked & keptSmaller;
    leaves.level1 = (before.level1 & ~touched) | (touched & valid & ~crossed) | (kept & sure.within.level1);
    for (std::uint64_t open = kept & ~sure.within.level1; open != 0; open &= open - 1) {
        const int i = std::countr_zero(open);
        if (check.isPairWithin(i, above, (before.level1 >> i & 1) != 0, exceeding))
            leaves.level1 |= std::uint64_t{1} << i;
    }
    const unsigned whole = halvesWhere([&](std::uint64_t parts) { return (leaves.level1 & parts) == parts; });
    if (whole == 0)
        return leaves;
    const unsigned crossedHalves = halvesWhere([&](std::uint64_t parts) { return (crossed & parts) != 0; }),
                   touchedHalves = halvesWhere([&](std::uint64_t parts) { return (touched & parts) != 0; });
    if (!decidesAll) {
        const unsigned monotone = sure.monotone.level2 | (sure.monotone.level3 ? 1u << 8 : 0u);
        const unsigned undecided =
            (whole & crossedHalves & touchedHalves) | (whole == 0xff && crossed != 0 ? 1u << 8 : 0u);
        keptLarger = monotone;
        if ((undecided & ~monotone) != 0) {
            gatherSignsOfLarger(above, signs);
            keptLarger = cell::keepsTopologyOf64(signs);
        }
    }
    const auto isUsable = [&](int i) {
        const bool was = (before.level2 >> i & 1) != 0;
        if ((touchedHalves >> i & 1) == 0)
            return was;
        return (crossedHalves >> i & 1) == 0 ||
               ((keptLarger >> i & 1) != 0 && ((sure.within.level2 >> i & 1) != 0 ||
                                               check.isWithin({{4 * (i & 1), 4 * (i >> 1 & 1), 4 * (i >> 2)}, 2}, was,
                                                              exceeding.ofLarger[static_cast<std::size_t>(i)])));
    };
    for (unsigned open = whole; open != 0; open &= open - 1)
        leaves.level2 = static_cast<std::uint8_t>(leaves.level2 | unsigned{isUsable(std::countr_zero(open))}
                                                                      << std::countr_zero(open));
    leaves.level3 = leaves.level2 == 0xff &&
                    (crossed == 0 ||
                     ((keptLarger >> 8 & 1) != 0 &&
                      (sure.within.level3 || check.isWithin({{0, 0, 0}, 3}, before.level3, exceeding.ofLarger[8]))));
    return leaves;
}

} // namespace

template <class Sample>
FoundLeaves updateBrickLeaves(const BrickLeaves& before, const BitString& aboveBefore, const BitString& changed,
                              const StoredSample<Sample>* samples, const BitString& above, const ActiveBits& active,
                              const BitString& validCells, const MergeBound& bound, const SureCells& sure,
                              ExceedingEdges& exceeding) {
    const std::uint64_t crossed = anyOfEight(active.cells);
    const BoundCheck<Sample> check(samples, active, aboveBefore, bound);
    const BrickLeaves usable = updateUsable(before, anyOfEight(changed), crossed, check, above,
                                            sure.isKnown ? sure.valid : allOfEight(validCells), sure, exceeding);
    return {usable, leavesOfSurface(usable, crossed)};
}

#define ISO_INSTANTIATE(Sample, Name) \
    template FoundLeaves findBrickLeaves<Sample>(const StoredSample<Sample>*, const BitString&, const ActiveBits&, \
                                                 const BitString&, const MergeBound&, const SureCells&, \
                                                 ExceedingEdges&); \
    template FoundLeaves updateBrickLeaves<Sample>( \
        const BrickLeaves&, const BitString&, const BitString&, const StoredSample<Sample>*, const BitString&, \
        const ActiveBits&, const BitString&, const MergeBound&, const SureCells&, ExceedingEdges&); \
    template SureCells findSureCells<Sample>(const StoredSample<Sample>*, const BitString&, const MergeBound&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
