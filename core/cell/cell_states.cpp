#include "core/cell/cell_states.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "core/base/check.h"

// How the table is made. Nothing is typed in but the numbering:
//  1. For each sign pattern and each way to join its ambiguous faces, the faces' directed segments chain
//     into loops.
//  2. Where opposite faces agree with the signs that a tunnel needs, the state has tunnels too, one for
//     each diagonal that is left open (cell_polynomials.h: the sign of q on a face is that of a corner pair).
//  3. Each loop becomes a disc: of all triangulations without a diagonal in a face the one with the
//     shortest diagonals, edges cut in their middles; a fan around a centre where there is none. The two
//     loops of a tunnel are joined to its ring by bands, of all the one with the shortest edges.

namespace isoslider::cell {
namespace {

struct Point {
    double x, y, z;
};
Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double squaredLength(const Point& a) { return a.x * a.x + a.y * a.y + a.z * a.z; }
double determinant(const Point& a, const Point& b, const Point& c) {
    return a.x * (b.y * c.z - b.z * c.y) - a.y * (b.x * c.z - b.z * c.x) + a.z * (b.x * c.y - b.y * c.x);
}
Point cornerPoint(int c) {
    return {static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1), static_cast<double>(c >> 2)};
}
Point edgeMiddle(int e) {
    const Point a = cornerPoint(kCellEdges[static_cast<std::size_t>(e)].lowerCorner),
                b = cornerPoint(kCellEdges[static_cast<std::size_t>(e)].upperCorner);
    return {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)};
}

using Loop = std::vector<int>; ///< cell edges, in the direction in which its triangles run along it

// Where each active edge's outgoing segment leads; -1 for inactive edges. Going around a face
// counter-clockwise seen from outside, a segment starts where the above region is entered. Parted above
// corners have a segment each; joined ones have a segment around each below corner.
std::array<int, 12> traceSegments(int signs, int joinedFaces) {
    std::array<int, 12> next;
    next.fill(-1);
    for (int f = 0; f < 6; ++f) {
        const auto& corners = kFaceCorners[static_cast<std::size_t>(f)];
        const auto isAbove = [&](int k) { return (signs >> corners[static_cast<std::size_t>(k & 3)] & 1) != 0; };
        const auto edge = [&](int k) {
            return edgeBetween(corners[static_cast<std::size_t>(k & 3)],
                               corners[static_cast<std::size_t>((k + 1) & 3)]);
        };
        for (int k = 0; k < 4; ++k) {
            if (!isAbove(k) || isAbove(k + 3))
                continue; // not where an above run begins
            const int entered = edge(k + 3);
            if (joinedFaces >> f & 1) {
                next[static_cast<std::size_t>(entered)] = edge(k + 2); // around the below corner k + 3
                continue;
            }
            int last = k;
            while (isAbove(last + 1))
                ++last;
            next[static_cast<std::size_t>(entered)] = edge(last);
        }
    }
    return next;
}

std::vector<Loop> loopsOf(int signs, int joinedFaces) {
    const std::array<int, 12> next = traceSegments(signs, joinedFaces);
    std::array<bool, 12> visited{};
    std::vector<Loop> loops;
    for (int start = 0; start < 12; ++start) {
        if (next[static_cast<std::size_t>(start)] < 0 || visited[static_cast<std::size_t>(start)])
            continue;
        Loop loop;
        for (int e = start; !visited[static_cast<std::size_t>(e)]; e = next[static_cast<std::size_t>(e)]) {
            visited[static_cast<std::size_t>(e)] = true;
            loop.push_back(e);
        }
        loops.push_back(loop);
    }
    return loops;
}

// The regions of equal sign on the cell's faces: the lowest corner of each corner's region.
std::array<int, 8> regionsOf(int signs, int joinedFaces) {
    std::array<int, 8> region;
    for (int i = 0; i < 8; ++i)
        region[static_cast<std::size_t>(i)] = i;
    const auto unite = [&](int a, int b) {
        const int from = std::max(region[static_cast<std::size_t>(a)], region[static_cast<std::size_t>(b)]);
        const int to = std::min(region[static_cast<std::size_t>(a)], region[static_cast<std::size_t>(b)]);
        std::replace(region.begin(), region.end(), from, to);
    };
    for (const CellEdge& e : kCellEdges)
        if ((signs >> e.lowerCorner & 1) == (signs >> e.upperCorner & 1))
            unite(e.lowerCorner, e.upperCorner);
    for (int f = 0; f < 6; ++f) {
        if (!(ambiguousFaces(static_cast<std::uint8_t>(signs)) >> f & 1))
            continue;
        const auto& c = kFaceCorners[static_cast<std::size_t>(f)];
        const bool joinsFirst = ((signs >> c[0] & 1) != 0) == ((joinedFaces >> f & 1) != 0);
        unite(c[joinsFirst ? 0 : 1], c[joinsFirst ? 2 : 3]);
    }
    return region;
}

// The two loops that a tunnel joins: they border one region of the other sign, and two of the tunnel's.
// Both -1 when there are no such two or more than two.
struct LoopPair {
    int first = -1;
    int second = -1;
};

LoopPair tunnelLoops(int signs, int joinedFaces, const std::vector<Loop>& loops, Tunnel tunnel) {
    const std::array<int, 8> region = regionsOf(signs, joinedFaces);
    const auto beside = [&](const Loop& loop, bool above) {
        const CellEdge& e = kCellEdges[static_cast<std::size_t>(loop.front())];
        return region[((signs >> e.lowerCorner & 1) != 0) == above ? e.lowerCorner : e.upperCorner];
    };
    LoopPair pair;
    for (std::size_t i = 0; i < loops.size(); ++i)
        for (std::size_t j = i + 1; j < loops.size(); ++j) {
            const bool isAbove = tunnel == Tunnel::Above;
            if (beside(loops[i], isAbove) == beside(loops[j], isAbove) ||
                beside(loops[i], !isAbove) != beside(loops[j], !isAbove))
                continue;
            if (pair.first >= 0)
                return {};
            pair = {static_cast<int>(i), static_cast<int>(j)};
        }
    return pair;
}

// Sign of q = AC - BD on a face where the corner signs and the face's decision determine it, else 0. A and C
// are the corners at (0,0) and (1,1) of the face.
int signOnFace(int signs, int joinedFaces, int axis, int side) {
    const int u = 1 << ((axis + 1) % 3), w = 1 << ((axis + 2) % 3), base = side << axis;
    const bool a = signs >> base & 1, b = signs >> (base + u) & 1, d = signs >> (base + w) & 1,
               c = signs >> (base + u + w) & 1;
    if (a == c && b == d && a != b)
        return ((joinedFaces >> (2 * axis + side) & 1) != 0) == a ? 1 : -1;
    if ((a == c) == (b == d))
        return 0; // all equal, or two neighbours against two
    return a == c ? 1 : -1;
}

// Diagonals for which the faces leave room (trilinear_cell.cpp, diagonalOf): bit per diagonal.
unsigned openDiagonals(int signs, int joinedFaces) {
    unsigned open = 0;
    for (unsigned leading = 0; leading < 8; ++leading) { // bit set: q's leading coefficient is positive
        if (std::popcount(leading) % 2 != 0) // their product must be negative
            continue;
        bool fits = true;
        for (int axis = 0; axis < 3; ++axis)
            for (int side = 0; side < 2; ++side) {
                const int known = signOnFace(signs, joinedFaces, axis, side);
                fits = fits && (known == 0 || known == ((leading >> axis & 1) != 0 ? 1 : -1));
            }
        if (fits)
            open |= 1u << ((leading >> 1 & 1) + 2 * (leading & 1));
    }
    return open;
}

// Triangulates part of a loop, first..last with that edge already there. Cost: squared lengths of
// diagonals; infinite when only diagonals in faces would do.
class DiscTriangulation {
public:
    explicit DiscTriangulation(const Loop& loop) : loop_(loop) {}

    /// Appends triangles and returns true, or leaves them alone.
    bool append(std::vector<std::uint8_t>& triangles) {
        const int last = static_cast<int>(loop_.size()) - 1;
        if (best(0, last).cost == std::numeric_limits<double>::infinity())
            return false;
        emit(0, last, triangles);
        return true;
    }

private:
    struct Choice {
        double cost = -1.0;
        int apex = -1;
    };

    using Costs = std::array<std::array<double, 12>, 12>;
    // Of the diagonals between all edges.
    static const Costs& allCosts() {
        static const auto costs = [] {
            Costs all;
            for (std::size_t a = 0; a < all.size(); ++a)
                for (std::size_t b = 0; b < all.size(); ++b)
                    all[a][b] = (facesOfEdges()[a] & facesOfEdges()[b]) != 0
                                    ? std::numeric_limits<double>::infinity()
                                    : squaredLength(edgeMiddle(static_cast<int>(a)) - edgeMiddle(static_cast<int>(b)));
            return all;
        }();
        return costs;
    }

    double diagonal(int i, int j) const {
        if (j == i + 1)
            return 0.0;
        const int a = loop_[static_cast<std::size_t>(i)], b = loop_[static_cast<std::size_t>(j)];
        return costs_[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
    }

    const Choice& best(int first, int last) {
        Choice& choice = choices_[static_cast<std::size_t>(first)][static_cast<std::size_t>(last)];
        if (choice.cost >= 0.0)
            return choice;
        if (last == first + 1)
            return choice = {0.0, -1};
        Choice found{std::numeric_limits<double>::infinity(), -1};
        for (int apex = first + 1; apex < last; ++apex) {
            const double cost =
                best(first, apex).cost + best(apex, last).cost + diagonal(first, apex) + diagonal(apex, last);
            if (cost < found.cost)
                found = {cost, apex};
        }
        return choice = found;
    }

    void emit(int first, int last, std::vector<std::uint8_t>& triangles) {
        if (last == first + 1)
            return;
        const int apex = best(first, last).apex;
        for (const int k : {first, apex, last})
            triangles.push_back(static_cast<std::uint8_t>(loop_[static_cast<std::size_t>(k)]));
        emit(first, apex, triangles);
        emit(apex, last, triangles);
    }

    const Loop& loop_;
    const Costs& costs_ = allCosts();
    std::array<std::array<Choice, 12>, 12> choices_;
};

// The waist's ring: the box corners that do not lie on the diagonal, each a neighbour of the next.
std::array<std::uint8_t, 6> ringRound(int diagonal) {
    static constexpr int kSteps[6] = {1, 3, 2, 6, 4, 5}; // from corner `diagonal`
    std::array<std::uint8_t, 6> ring;
    for (std::size_t k = 0; k < 6; ++k)
        ring[k] = static_cast<std::uint8_t>(kSteps[k] ^ diagonal);
    return ring;
}

Point ringPoint(int boxCorner) {
    const Point c = cornerPoint(boxCorner);
    return {0.3 + 0.4 * c.x, 0.3 + 0.4 * c.y, 0.3 + 0.4 * c.z};
}

// How a closed line winds around a diagonal: positive or negative area across it.
double winding(const std::vector<Point>& line, int diagonal) {
    const Point axis = cornerPoint(7 - diagonal) - cornerPoint(diagonal), middle{0.5, 0.5, 0.5};
    double sum = 0.0;
    for (std::size_t i = 0; i < line.size(); ++i)
        sum += determinant(line[i] - middle, line[(i + 1) % line.size()] - middle, axis);
    return sum;
}

// Joins a loop to the ring, which winds like it. All edges of the band run from a vertex of the loop to
// one of the ring. Best of all starts; from a start, a shortest path through (vertex of loop, of ring).
class Band {
public:
    Band(const Loop& loop, const std::vector<int>& ring, const std::array<std::uint8_t, 6>& corners)
        : loop_(loop), ring_(ring) {
        for (std::size_t i = 0; i < loop.size(); ++i)
            for (std::size_t k = 0; k < ring.size(); ++k)
                lengths_[i][k] =
                    squaredLength(edgeMiddle(loop[i]) - ringPoint(corners[static_cast<std::size_t>(ring[k])]));
    }

    void append(std::vector<std::uint8_t>& triangles) const {
        double bestCost = std::numeric_limits<double>::infinity();
        std::size_t bestStart = 0;
        Costs costs;
        for (std::size_t start = 0; start < ring_.size(); ++start)
            if (const double cost = findCosts(start, costs); cost < bestCost - 1e-9) {
                bestCost = cost;
                bestStart = start;
            }
        findCosts(bestStart, costs);
        goBack(bestStart, costs, triangles);
    }

private:
    static constexpr std::size_t kMostOfLoop = 12, kRing = 6;
    // By vertices of the loop and of the ring, both closed: the costs of the paths from (0, 0).
    using Costs = std::array<std::array<double, kRing + 1>, kMostOfLoop + 1>;

    double findCosts(std::size_t start, Costs& cost) const {
        const std::size_t n = loop_.size(), m = ring_.size();
        for (std::size_t i = 0; i <= n; ++i) {
            const auto& lengths = lengths_[i < n ? i : 0];
            for (std::size_t j = 0, k = start; j <= m; ++j, k = k + 1 < m ? k + 1 : 0) {
                if (i + j == 0) {
                    cost[0][0] = lengths[k];
                    continue;
                }
                double least = std::numeric_limits<double>::infinity();
                if (i > 0)
                    least = std::min(least, cost[i - 1][j] + lengths[k]);
                if (j > 0)
                    least = std::min(least, cost[i][j - 1] + lengths[k]);
                cost[i][j] = least;
            }
        }
        return cost[n][m];
    }

    // The triangles of the cheapest path, from its end on.
    void goBack(std::size_t start, const Costs& cost, std::vector<std::uint8_t>& triangles) const {
        const std::size_t n = loop_.size(), m = ring_.size();
        const auto edge = [&](std::size_t i) { return static_cast<std::uint8_t>(loop_[i % n]); };
        const auto inner = [&](std::size_t j) {
            return static_cast<std::uint8_t>(kInnerVertex + ring_[(start + j) % m]);
        };
        std::size_t i = n, j = m;
        while (i + j > 0) {
            const bool alongLoop = j == 0 || (i > 0 && cost[i - 1][j] <= cost[i][j - 1]);
            if (alongLoop) {
                triangles.insert(triangles.end(), {edge(i - 1), edge(i), inner(j)});
                --i;
            } else {
                triangles.insert(triangles.end(), {edge(i), inner(j), inner(j - 1)});
                --j;
            }
        }
    }

    const Loop& loop_;
    const std::vector<int>& ring_;
    std::array<std::array<double, kRing>, kMostOfLoop> lengths_; ///< squared, by vertices of both
};

class StateTable {
public:
    StateTable() {
        for (unsigned mask = 0; mask < faces_.packed.size(); ++mask)
            for (unsigned joined = 0; joined < faces_.packed[mask].size(); ++joined)
                faces_.packed[mask][joined] = static_cast<std::uint8_t>(packed(mask, joined));
        for (int signs = 0; signs < 256; ++signs)
            addPlain(signs);
        for (int signs = 0; signs < 256; ++signs)
            addAmbiguous(signs);
        for (std::size_t i = 0; i < states_.size(); ++i) {
            states_[i].triangles = triangles_[i];
            states_[i].centres = centres_[i];
            ISO_CHECK(triangles_[i].size() <= 3 * std::size_t{kMaxStateTriangles});
        }
    }

    const FacesStates& faces() const { return faces_; }
    bool isAmbiguous(std::uint8_t signs) const { return isAmbiguous_[signs]; }
    const std::vector<CellState>& states() const { return states_; }

private:
    // Bits of `joined` at the set bits of `mask`, moved together.
    static unsigned packed(unsigned mask, unsigned joined) {
        unsigned out = 0;
        for (unsigned bit = 0; mask != 0; mask &= mask - 1, ++bit)
            out |= (joined >> std::countr_zero(mask) & 1u) << bit;
        return out;
    }

    void addPlain(int signs) {
        faces_.ambiguous[static_cast<std::size_t>(signs)] = ambiguousFaces(static_cast<std::uint8_t>(signs));
        const unsigned open = openDiagonals(signs, 0);
        const std::vector<Loop> loops = loopsOf(signs, 0);
        isAmbiguous_[static_cast<std::size_t>(signs)] =
            faces_.ambiguous[static_cast<std::size_t>(signs)] != 0 ||
            (open != 0 && (tunnelLoops(signs, 0, loops, Tunnel::Above).first >= 0 ||
                           tunnelLoops(signs, 0, loops, Tunnel::Below).first >= 0));
        addState(signs, 0, loops, Tunnel::None, 0);
    }

    void addAmbiguous(int signs) {
        const auto at = static_cast<std::size_t>(signs);
        faces_.first[at] = static_cast<std::uint16_t>(faces_.states.size());
        const unsigned mask = faces_.ambiguous[at];
        for (unsigned i = 0; i < 1u << std::popcount(mask); ++i) {
            int joined = 0;
            for (unsigned rest = mask, bit = 0; rest != 0; rest &= rest - 1, ++bit)
                joined |= static_cast<int>(i >> bit & 1u) << std::countr_zero(rest);
            if (isAmbiguous_[at])
                addFaces(signs, joined);
            else
                faces_.states.push_back({static_cast<StateId>(signs), 0});
        }
    }

    void addFaces(int signs, int joined) {
        const std::vector<Loop> loops = loopsOf(signs, joined);
        FacesState faces{static_cast<StateId>(states_.size()), 0}; // those with a tunnel follow
        addState(signs, joined, loops, Tunnel::None, 0);
        const unsigned open = openDiagonals(signs, joined);
        for (const Tunnel tunnel : {Tunnel::Above, Tunnel::Below}) {
            if (open == 0 || tunnelLoops(signs, joined, loops, tunnel).first < 0)
                continue;
            faces.tunnels |= tunnel == Tunnel::Above ? 1 : 2;
            for (int diagonal = 0; diagonal < 4; ++diagonal)
                if (open >> diagonal & 1)
                    addState(signs, joined, loops, tunnel, diagonal);
        }
        faces_.states.push_back(faces);
    }

    void addState(int signs, int joined, const std::vector<Loop>& loops, Tunnel tunnel, int diagonal) {
        CellState state;
        state.signs = static_cast<std::uint8_t>(signs);
        state.joinedFaces = static_cast<std::uint8_t>(joined);
        state.tunnel = tunnel;
        state.diagonal = static_cast<std::uint8_t>(diagonal);
        state.loops = static_cast<std::uint8_t>(loops.size());
        state.components = static_cast<std::uint8_t>(loops.size() - (tunnel != Tunnel::None));
        std::vector<std::uint8_t> triangles;
        std::vector<CellCentre> centres;
        LoopPair pair;
        if (tunnel != Tunnel::None) {
            pair = tunnelLoops(signs, joined, loops, tunnel);
            state.ring = ringRound(diagonal);
            state.innerVertices = 6;
            addTunnel(loops[static_cast<std::size_t>(pair.first)], loops[static_cast<std::size_t>(pair.second)], state,
                      triangles);
        }
        for (int i = 0; i < static_cast<int>(loops.size()); ++i)
            if (i != pair.first && i != pair.second)
                addDisc(loops[static_cast<std::size_t>(i)], state, triangles, centres);
        state.triangleCount = static_cast<std::uint8_t>(triangles.size() / 3);
        states_.push_back(state);
        triangles_.push_back(std::move(triangles));
        centres_.push_back(std::move(centres));
    }

    static void addDisc(const Loop& loop, CellState& state, std::vector<std::uint8_t>& triangles,
                        std::vector<CellCentre>& centres) {
        if (DiscTriangulation(loop).append(triangles))
            return;
        const auto centre = static_cast<std::uint8_t>(kInnerVertex + state.innerVertices++);
        CellCentre made{0};
        for (std::size_t i = 0; i < loop.size(); ++i) {
            made.loopEdges |= static_cast<std::uint16_t>(1u << loop[i]);
            triangles.insert(triangles.end(), {static_cast<std::uint8_t>(loop[i]),
                                               static_cast<std::uint8_t>(loop[(i + 1) % loop.size()]), centre});
        }
        centres.push_back(made);
    }

    static void addTunnel(const Loop& first, const Loop& second, const CellState& state,
                          std::vector<std::uint8_t>& triangles) {
        std::vector<int> ring{0, 1, 2, 3, 4, 5};
        std::vector<Point> ringPoints, firstPoints, secondPoints;
        for (const int k : ring)
            ringPoints.push_back(ringPoint(state.ring[static_cast<std::size_t>(k)]));
        for (const int e : first)
            firstPoints.push_back(edgeMiddle(e));
        for (const int e : second)
            secondPoints.push_back(edgeMiddle(e));
        const double turn = winding(firstPoints, state.diagonal);
        ISO_CHECK(turn * winding(secondPoints, state.diagonal) < 0.0);
        if (turn * winding(ringPoints, state.diagonal) < 0.0)
            std::reverse(ring.begin(), ring.end());
        Band(first, ring, state.ring).append(triangles);
        std::reverse(ring.begin(), ring.end());
        Band(second, ring, state.ring).append(triangles);
    }

    std::array<bool, 256> isAmbiguous_{};
    FacesStates faces_;
    std::vector<CellState> states_;
    std::vector<std::vector<std::uint8_t>> triangles_;
    std::vector<std::vector<CellCentre>> centres_;
};

const StateTable& table() {
    static const StateTable made;
    return made;
}

} // namespace

std::span<const CellState> cellStates() { return table().states(); }

const FacesStates& facesStates() { return table().faces(); }

unsigned mayHaveTunnel(std::uint8_t signs, std::uint8_t joinedFaces) {
    return facesStates().of(signs, joinedFaces).tunnels;
}

bool isAmbiguous(std::uint8_t signs) { return table().isAmbiguous(signs); }

StateId stateOf(std::uint8_t signs, std::uint8_t joinedFaces, Tunnel tunnel, std::uint8_t diagonal) {
    StateId id = facesStates().of(signs, joinedFaces).state;
    if (tunnel == Tunnel::None)
        return id;
    const std::vector<CellState>& states = table().states();
    while (states[id].tunnel != tunnel || states[id].diagonal != diagonal) {
        ++id;
        ISO_CHECK(id < states.size() && states[id].signs == signs && states[id].joinedFaces == joinedFaces);
    }
    return id;
}

} // namespace isoslider::cell
