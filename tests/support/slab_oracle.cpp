#include "tests/support/slab_oracle.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>

namespace isoslider::test {
namespace {

class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::size_t i) {
        auto root = static_cast<std::uint32_t>(i);
        while (parent_[root] != root)
            root = parent_[root] = parent_[parent_[root]];
        return root;
    }
    void unite(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

private:
    std::vector<std::uint32_t> parent_;
};

// --- numbers ------------------------------------------------------------------------------------------

using Narrow = __int128; // NOLINT: an extension that GCC and Clang share
using Wide = boost::multiprecision::int512_t;
using Any = boost::multiprecision::cpp_int;

// The largest polynomial is below 2^7 M^4 for numbers below M.
constexpr int kNarrowBits = 29;
constexpr int kWideBits = 120;

template <class Integer>
int signOf(const Integer& x) {
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

// Sign of c0 + c1 e + c2 e^2 for small e > 0.
template <class Integer>
int signOf(const Integer& c0, const Integer& c1, const Integer& c2) {
    if (const int sign = signOf(c0))
        return sign;
    const int sign = signOf(c1);
    return sign ? sign : signOf(c2);
}

// mantissa * 2^exponent, the mantissa odd or zero.
struct Binary {
    std::int64_t mantissa = 0;
    int exponent = 0;
};

Binary toBinary(double number) {
    Binary binary;
    if (number == 0.0)
        return binary;
    binary.mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(number, &binary.exponent), 53));
    const int zeros = std::countr_zero(static_cast<std::uint64_t>(binary.mantissa));
    binary.mantissa /= std::int64_t{1} << zeros;
    binary.exponent += zeros - 53;
    return binary;
}

// Where nine numbers lie on a common lattice.
struct Lattice {
    std::array<Binary, 9> numbers; // the last is the isovalue
    int lowest = 0;
    int bits = 0; // of a difference of two

    explicit Lattice(const std::array<double, 8>& scalars, double isovalue) {
        int highest = 0;
        bool isFirst = true;
        for (std::size_t i = 0; i < 9; ++i) {
            const Binary binary = numbers[i] = toBinary(i < 8 ? scalars[i] : isovalue);
            if (binary.mantissa == 0)
                continue;
            const auto magnitude = static_cast<std::uint64_t>(std::abs(binary.mantissa));
            const int end = binary.exponent + static_cast<int>(std::bit_width(magnitude));
            lowest = isFirst ? binary.exponent : std::min(lowest, binary.exponent);
            highest = isFirst ? end : std::max(highest, end);
            isFirst = false;
        }
        bits = highest - lowest + 1;
    }

    template <class Integer>
    std::array<Integer, 8> differences() const {
        const auto at = [&](const Binary& binary) {
            Integer value = binary.mantissa;
            if (binary.mantissa != 0)
                value *= Integer(1) << (binary.exponent - lowest); // a shift of a negative number is not defined
            return value;
        };
        const Integer isovalue = at(numbers[8]);
        std::array<Integer, 8> result;
        for (std::size_t i = 0; i < 8; ++i)
            result[i] = at(numbers[i]) - isovalue;
        return result;
    }
};

// --- faces --------------------------------------------------------------------------------------------

// Corners of a slice or face across `axis`, cyclic; `side` 1 for those at the far end.
std::array<int, 4> sliceCorners(int axis, int side) {
    const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3, base = side << axis;
    return {base, base | b, base | b | c, base | c};
}

// Edges as pairs of corners: number 8 * lower + upper.
int edgeKey(int cornerA, int cornerB) { return 8 * std::min(cornerA, cornerB) + std::max(cornerA, cornerB); }

bool isAmbiguous(unsigned signs4) { return signs4 == 0b0101u || signs4 == 0b1010u; }

unsigned pickSigns(std::uint8_t signs, const std::array<int, 4>& corners) {
    unsigned picked = 0;
    for (unsigned k = 0; k < 4; ++k)
        picked |= (signs >> corners[k] & 1u) << k;
    return picked;
}

// Segments on a face whose first and third corner are joined, or the other two, as pairs of edge keys.
template <class Visit>
void forEachSegment(unsigned signs4, bool isFirstPairJoined, const std::array<int, 4>& corners, Visit&& visit) {
    const auto edge = [&](unsigned k) { return edgeKey(corners[k % 4], corners[(k + 1) % 4]); };
    if (isAmbiguous(signs4)) {
        const unsigned cutOff = isFirstPairJoined ? 1 : 0; // segments go round this corner and the one across
        visit(edge(cutOff + 3), edge(cutOff));
        visit(edge(cutOff + 1), edge(cutOff + 2));
        return;
    }
    int first = -1;
    for (unsigned k = 0; k < 4; ++k) {
        if ((signs4 >> k & 1u) == (signs4 >> (k + 1) % 4 & 1u))
            continue;
        if (first >= 0)
            visit(first, edge(k));
        first = edge(k);
    }
}

// --- one cell -------------------------------------------------------------------------------------------

// A place p / r along the swept axis, p = p0 + p1 e and r > 0.
template <class Integer>
struct Place {
    Integer p0, p1, r;
    unsigned corners = 0; // of the slice that are zero there
};

struct Slab {
    unsigned signs4 = 0;
    bool isFirstPairJoined = false; // meant where the signs are ambiguous
};

template <class Integer>
class CellSweep {
public:
    CellSweep(const std::array<Integer, 8>& g, std::uint8_t signs, int axis)
        : signs_(signs), low_(sliceCorners(axis, 0)), high_(sliceCorners(axis, 1)) {
        for (std::size_t k = 0; k < 4; ++k) {
            u_[k] = g[static_cast<std::size_t>(low_[k])];
            d_[k] = g[static_cast<std::size_t>(high_[k])] - u_[k];
        }
        a_ = d_[0] * d_[2] - d_[1] * d_[3];
        b0_ = u_[0] * d_[2] + u_[2] * d_[0] - u_[1] * d_[3] - u_[3] * d_[1];
        b1_ = d_[0] + d_[2] - d_[1] - d_[3];
        c0_ = u_[0] * u_[2] - u_[1] * u_[3];
        c1_ = u_[0] + u_[2] - u_[1] - u_[3];
        cutIntoSlabs();
    }

    // Regions of the cell's corners, and their number by side.
    void regions(CellTopology& topology) const {
        DisjointSets sets(4 * slabs_.size());
        for (std::size_t s = 0; s < slabs_.size(); ++s) {
            uniteWithin(s, sets);
            if (s > 0)
                for (unsigned k = 0; k < 4; ++k)
                    if (((slabs_[s - 1].signs4 ^ slabs_[s].signs4) >> k & 1u) == 0)
                        sets.unite(4 * s - 4 + k, 4 * s + k);
        }
        std::array<std::uint32_t, 8> root{};
        for (std::size_t k = 0; k < 4; ++k) {
            root[static_cast<std::size_t>(low_[k])] = sets.find(k);
            root[static_cast<std::size_t>(high_[k])] = sets.find(4 * slabs_.size() - 4 + k);
        }
        topology.aboveRegions = number(root, true, 0, topology.region);
        topology.belowRegions = number(root, false, topology.aboveRegions, topology.region);
    }

    // Of the surface: curves at the slices where something happens, less the curves between.
    int euler() const { return euler_; }

private:
    void cutIntoSlabs() {
        const std::vector<Place<Integer>> places = cornerCrossings();
        unsigned signs4 = pickSigns(signs_, low_);
        Place<Integer> from{0, 0, 1};
        euler_ = arcs(signs4);
        for (const Place<Integer>& place : places) {
            addSlabs(signs4, from, place);
            euler_ += curveThrough(place.corners, signs4);
            signs4 ^= place.corners;
            from = place;
        }
        addSlabs(signs4, from, {1, 0, 1});
        euler_ += arcs(signs4);
    }

    // In order along the axis, those at the same place for every e as one.
    std::vector<Place<Integer>> cornerCrossings() const {
        std::vector<Place<Integer>> places;
        for (unsigned k = 0; k < 4; ++k) {
            if ((signs_ >> low_[k] & 1) == (signs_ >> high_[k] & 1))
                continue;
            if (d_[k] > 0)
                places.push_back({-u_[k], -1, d_[k], 1u << k});
            else
                places.push_back({u_[k], 1, -d_[k], 1u << k});
        }
        std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return compare(a, b) < 0; });
        std::vector<Place<Integer>> merged;
        for (const Place<Integer>& place : places) {
            if (!merged.empty() && compare(merged.back(), place) == 0)
                merged.back().corners |= place.corners;
            else
                merged.push_back(place);
        }
        return merged;
    }

    static int compare(const Place<Integer>& a, const Place<Integer>& b) {
        const Integer c0 = a.p0 * b.r - b.p0 * a.r, c1 = a.p1 * b.r - b.p1 * a.r;
        return signOf(c0, c1, Integer(0));
    }

    // Between two crossings: one slab, or as many as A C - B D changes sign where that matters.
    void addSlabs(unsigned signs4, const Place<Integer>& from, const Place<Integer>& to) {
        if (!isAmbiguous(signs4))
            return addSlab(signs4, false);
        const int first = quadraticAt(from), last = quadraticAt(to);
        addSlab(signs4, first > 0);
        if (first == last && hasTwoRootsBetween(from, to, first)) {
            euler_ += 1; // the slice's curve is a cross there
            addSlab(signs4, first < 0);
        }
        if (slabs_.back().isFirstPairJoined != (last > 0)) {
            euler_ += 1;
            addSlab(signs4, last > 0);
        }
    }

    void addSlab(unsigned signs4, bool isFirstPairJoined) {
        slabs_.push_back({signs4, isFirstPairJoined});
        euler_ -= arcs(signs4);
    }

    int quadraticAt(const Place<Integer>& t) const {
        const Integer e0 = a_ * t.p0 * t.p0 + b0_ * t.p0 * t.r + c0_ * t.r * t.r;
        const Integer e1 = 2 * a_ * t.p0 * t.p1 + (b0_ * t.p1 + b1_ * t.p0) * t.r + c1_ * t.r * t.r;
        const Integer e2 = a_ * t.p1 * t.p1 + b1_ * t.p1 * t.r;
        return signOf(e0, e1, e2);
    }

    // The quadratic has `sign` at both ends: its extremum must lie between and beyond zero.
    bool hasTwoRootsBetween(const Place<Integer>& from, const Place<Integer>& to, int sign) const {
        if (signOf(a_) != sign)
            return false;
        const Integer f0 = b0_ * b0_ - 4 * a_ * c0_, f1 = 2 * b0_ * b1_ - 4 * a_ * c1_, f2 = b1_ * b1_;
        if (signOf(f0, f1, f2) <= 0)
            return false;
        return slopeAt(from) == -sign && slopeAt(to) == sign;
    }

    int slopeAt(const Place<Integer>& t) const {
        const Integer e0 = b0_ * t.r + 2 * a_ * t.p0, e1 = b1_ * t.r + 2 * a_ * t.p1;
        return signOf(e0, e1, Integer(0));
    }

    static int arcs(unsigned signs4) { return std::popcount(signs4 ^ ((signs4 >> 1 | signs4 << 3) & 15u)) / 2; }

    // Euler number of the slice's curve where the corners `zero` are crossed; of the others only the signs
    // matter. Corners crossed together go the same way.
    static int curveThrough(unsigned zero, unsigned signs4) {
        const auto isAbove = [&](int k) { return (signs4 >> (k & 3) & 1u) != 0; };
        const int k = std::countr_zero(zero);
        if (zero == (1u << k) && isAbove(k + 1) == isAbove(k + 3))
            return isAbove(k + 2) == isAbove(k + 1) ? 1 : 2; // a point alone, and an arc around the far corner
        if (isAmbiguous(zero))
            return isAbove(k + 1) == isAbove(k + 3) ? 2 : 1; // two points, or an arc from one to the other
        return 1;
    }

    void uniteWithin(std::size_t s, DisjointSets& sets) const {
        const Slab& slab = slabs_[s];
        for (unsigned k = 0; k < 4; ++k)
            if ((slab.signs4 >> k & 1u) == (slab.signs4 >> (k + 1) % 4 & 1u))
                sets.unite(4 * s + k, 4 * s + (k + 1) % 4);
        if (isAmbiguous(slab.signs4)) {
            const unsigned k = slab.isFirstPairJoined ? 0 : 1;
            sets.unite(4 * s + k, 4 * s + k + 2);
        }
    }

    int number(const std::array<std::uint32_t, 8>& root, bool above, int firstNumber,
               std::array<std::uint8_t, 8>& region) const {
        int count = 0;
        for (unsigned i = 0; i < 8; ++i) {
            if ((signs_ >> i & 1) != above)
                continue;
            unsigned j = 0;
            while ((signs_ >> j & 1) != above || root[j] != root[i])
                ++j;
            region[i] = j < i ? region[j] : static_cast<std::uint8_t>(firstNumber + count++);
        }
        return count;
    }

    std::uint8_t signs_;
    std::array<int, 4> low_, high_;
    std::array<Integer, 4> u_, d_; // slice corner k at t: u + d t + e
    Integer a_, b0_, b1_, c0_, c1_; // A C - B D = a t^2 + (b0 + b1 e) t + c0 + c1 e
    std::vector<Slab> slabs_;
    int euler_ = 0;
};

// Faces and loops, and how many regions the faces alone leave apart.
template <class Integer>
void decideFaces(const std::array<Integer, 8>& g, CellTopology& topology) {
    DisjointSets corners(8), edges(64);
    for (int face = 0; face < 6; ++face) {
        const std::array<int, 4> c = sliceCorners(face / 2, face % 2);
        const unsigned signs4 = pickSigns(topology.signs, c);
        const auto at = [&](unsigned k) -> const Integer& { return g[static_cast<std::size_t>(c[k])]; };
        bool isFirstPairJoined = false;
        if (isAmbiguous(signs4)) {
            const Integer e0 = at(0) * at(2) - at(1) * at(3), e1 = at(0) + at(2) - at(1) - at(3);
            isFirstPairJoined = signOf(e0, e1, Integer(0)) > 0;
            const unsigned joined = isFirstPairJoined ? 0 : 1;
            corners.unite(static_cast<std::size_t>(c[joined]), static_cast<std::size_t>(c[joined + 2]));
            topology.ambiguousFaces |= static_cast<std::uint8_t>(1 << face);
            if ((signs4 >> joined & 1u) != 0)
                topology.joinedFaces |= static_cast<std::uint8_t>(1 << face);
        }
        for (unsigned k = 0; k < 4; ++k)
            if ((signs4 >> k & 1u) == (signs4 >> (k + 1) % 4 & 1u))
                corners.unite(static_cast<std::size_t>(c[k]), static_cast<std::size_t>(c[(k + 1) % 4]));
        forEachSegment(signs4, isFirstPairJoined, c,
                       [&](int e, int f) { edges.unite(static_cast<std::size_t>(e), static_cast<std::size_t>(f)); });
    }
    int apart[2] = {0, 0};
    for (unsigned i = 0; i < 8; ++i) {
        apart[topology.signs >> i & 1] += corners.find(i) == i;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const unsigned j = i | 1u << axis;
            if (i != j && (topology.signs >> i & 1) != (topology.signs >> j & 1))
                topology.loops += edges.find(8 * i + j) == 8 * i + j;
        }
    }
    topology.aboveJoinsInside = apart[1] - topology.aboveRegions;
    topology.belowJoinsInside = apart[0] - topology.belowRegions;
}

template <class Integer>
CellTopology sweep(const std::array<Integer, 8>& g, int axis) {
    CellTopology topology;
    for (unsigned i = 0; i < 8; ++i)
        topology.signs |= static_cast<std::uint8_t>((g[i] >= 0 ? 1u : 0u) << i);
    const CellSweep<Integer> cell(g, topology.signs, axis);
    cell.regions(topology);
    topology.euler = cell.euler();
    // A cube is simply connected: every piece of the surface parts it, so regions and pieces form a tree.
    topology.components = topology.aboveRegions + topology.belowRegions - 1;
    decideFaces(g, topology);
    return topology;
}

} // namespace

CellTopology sweepCell(const std::array<double, 8>& scalars, double isovalue, int axis) {
    const Lattice lattice(scalars, isovalue);
    if (lattice.bits <= kNarrowBits)
        return sweep(lattice.differences<Narrow>(), axis);
    if (lattice.bits <= kWideBits)
        return sweep(lattice.differences<Wide>(), axis);
    return sweep(lattice.differences<Any>(), axis);
}

std::string oracleFault(const std::array<double, 8>& scalars, double isovalue) {
    const CellTopology z = sweepCell(scalars, isovalue, 2);
    for (int axis = 0; axis < 2; ++axis)
        if (const CellTopology other = sweepCell(scalars, isovalue, axis); other != z)
            return "swept along axis " + std::to_string(axis) + ": " + toString(other) + ", along z: " + toString(z);
    if (z.euler != 2 * z.components - z.loops)
        return "Euler number is not 2 components - loops: " + toString(z);
    if (z.aboveJoinsInside < 0 || z.belowJoinsInside < 0 || z.aboveJoinsInside + z.belowJoinsInside > 1 ||
        z.loops - z.components != z.aboveJoinsInside + z.belowJoinsInside)
        return "regions do not fit the loops: " + toString(z);
    return {};
}

// --- a grid ---------------------------------------------------------------------------------------------

namespace {

class GridSweep {
public:
    GridSweep(std::span<const double> scalars, const std::array<std::int64_t, 3>& dims, double isovalue, int axis)
        : scalars_(scalars),
          dims_(dims),
          isovalue_(isovalue),
          axis_(axis),
          pieces_(3 * scalars.size()),
          boxCurves_(3 * scalars.size()),
          isActive_(3 * scalars.size()) {}

    GridTopology run() {
        std::array<std::int64_t, 3> p{};
        for (p[2] = 0; p[2] + 1 < dims_[2]; ++p[2])
            for (p[1] = 0; p[1] + 1 < dims_[1]; ++p[1])
                for (p[0] = 0; p[0] + 1 < dims_[0]; ++p[0])
                    addCell(p);
        for (std::size_t e = 0; e < isActive_.size(); ++e) {
            if (isActive_[e] == 0)
                continue;
            topology_.activeEdges += 1;
            topology_.components += pieces_.find(e) == e;
            topology_.loops += isActive_[e] == 2 && boxCurves_.find(e) == e;
        }
        // Vertices, less segments, and the insides of the pieces. A segment belongs to two cells or to the
        // box.
        topology_.euler += topology_.activeEdges - (halfSegments_ / 2);
        return topology_;
    }

private:
    std::size_t point(const std::array<std::int64_t, 3>& cell, int corner) const {
        const std::int64_t x = cell[0] + (corner & 1), y = cell[1] + (corner >> 1 & 1), z = cell[2] + (corner >> 2);
        return static_cast<std::size_t>(x + dims_[0] * (y + dims_[1] * z));
    }

    std::size_t gridEdge(const std::array<std::int64_t, 3>& cell, int edgeKey) const {
        const int lower = edgeKey / 8, axis = std::countr_zero(static_cast<unsigned>(edgeKey / 8 ^ edgeKey % 8));
        return 3 * point(cell, lower) + static_cast<std::size_t>(axis);
    }

    void addCell(const std::array<std::int64_t, 3>& cell) {
        std::array<double, 8> corners;
        for (int i = 0; i < 8; ++i)
            corners[static_cast<std::size_t>(i)] = scalars_[point(cell, i)];
        const auto [least, greatest] = std::minmax_element(corners.begin(), corners.end());
        if (*least >= isovalue_ || *greatest < isovalue_)
            return;
        const CellTopology topology = sweepCell(corners, isovalue_, axis_);
        topology_.euler += topology.euler;
        topology_.tunnels += topology.aboveJoinsInside + topology.belowJoinsInside;
        joinPieces(cell, topology);
        for (int face = 0; face < 6; ++face)
            addFace(cell, topology, face);
    }

    // Edges between the same two regions are on the same piece of the surface.
    void joinPieces(const std::array<std::int64_t, 3>& cell, const CellTopology& topology) {
        std::array<std::int64_t, 64> firstEdge;
        firstEdge.fill(-1);
        for (int i = 0; i < 8; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const int j = i | 1 << axis;
                if (i == j || (topology.signs >> i & 1) == (topology.signs >> j & 1))
                    continue;
                const std::size_t edge = gridEdge(cell, edgeKey(i, j));
                isActive_[edge] = std::max<std::uint8_t>(isActive_[edge], 1);
                const int a = topology.region[static_cast<std::size_t>(i)],
                          b = topology.region[static_cast<std::size_t>(j)];
                std::int64_t& first = firstEdge[static_cast<std::size_t>(8 * std::min(a, b) + std::max(a, b))];
                if (first >= 0)
                    pieces_.unite(static_cast<std::size_t>(first), edge);
                first = static_cast<std::int64_t>(edge);
            }
    }

    void addFace(const std::array<std::int64_t, 3>& cell, const CellTopology& topology, int face) {
        const std::size_t axis = static_cast<std::size_t>(face / 2);
        const bool isOnBox = face % 2 == 0 ? cell[axis] == 0 : cell[axis] + 2 == dims_[axis];
        const std::array<int, 4> corners = sliceCorners(face / 2, face % 2);
        const unsigned signs4 = pickSigns(topology.signs, corners);
        const bool isJoined = (topology.joinedFaces >> face & 1) != 0;
        forEachSegment(signs4, isJoined == ((signs4 & 1u) != 0), corners, [&](int e, int f) {
            halfSegments_ += isOnBox ? 2 : 1;
            if (!isOnBox)
                return;
            const std::size_t a = gridEdge(cell, e), b = gridEdge(cell, f);
            boxCurves_.unite(a, b);
            isActive_[a] = isActive_[b] = 2;
        });
    }

    std::span<const double> scalars_;
    std::array<std::int64_t, 3> dims_;
    double isovalue_;
    int axis_;
    DisjointSets pieces_, boxCurves_;
    std::vector<std::uint8_t> isActive_; // 2: on the box
    std::int64_t halfSegments_ = 0;
    GridTopology topology_;
};

} // namespace

GridTopology sweepGrid(std::span<const double> scalars, const std::array<std::int64_t, 3>& dims, double isovalue,
                       int axis) {
    return GridSweep(scalars, dims, isovalue, axis).run();
}

std::string toString(const CellTopology& t) {
    std::string text = "signs " + std::to_string(t.signs) + " joined faces " + std::to_string(t.joinedFaces) + " of " +
                       std::to_string(t.ambiguousFaces) + " loops " + std::to_string(t.loops) + " components " +
                       std::to_string(t.components) + " Euler " + std::to_string(t.euler) + " joins inside " +
                       std::to_string(t.aboveJoinsInside) + " above " + std::to_string(t.belowJoinsInside) +
                       " below, regions ";
    for (const std::uint8_t region : t.region)
        text += std::to_string(region);
    return text;
}

std::string toString(const GridTopology& t) {
    return "components " + std::to_string(t.components) + " Euler " + std::to_string(t.euler) + " loops " +
           std::to_string(t.loops) + " active edges " + std::to_string(t.activeEdges) + " tunnels " +
           std::to_string(t.tunnels);
}

} // namespace isoslider::test
