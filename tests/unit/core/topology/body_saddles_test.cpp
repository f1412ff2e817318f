// What a cell changes by derivatives, against what it changes state by state.

#include "core/topology/analysis/body_saddles.h"

#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "core/topology/cell_saddles.h"
#include "tests/unit/core/topology/cell_code_reference.h"

namespace isoslider::topology {
namespace {

struct Join {
    double isovalue;
    bool isOfAbove;
    std::set<int> corners;
    friend auto operator<=>(const Join&, const Join&) = default;
};

/// All that one cell changes, by isovalue.
struct Changes {
    std::map<double, int> euler;
    std::set<Join> inner; ///< joins through the inside
};

void add(std::map<double, int>& sums, double isovalue, int euler) {
    if ((sums[isovalue] += euler) == 0)
        sums.erase(isovalue);
}

Changes byStates(const cell::CornerScalars& scalars) {
    CellHistory history;
    history.find(scalars);
    Changes changes;
    for (std::size_t c = 0; c < 8; ++c)
        add(changes.euler, scalars[c], history.eulerAtCorners()[c]);
    for (const CellSaddle& saddle : history.saddles())
        add(changes.euler, saddle.isovalue, saddle.euler);
    for (const CellJoin& join : history.joins())
        if (join.face < 0)
            changes.inner.insert({join.isovalue, join.isOfAbove, {join.corners[0], join.corners[1]}});
    return changes;
}

Changes byDerivatives(const cell::CornerScalars& scalars, const CellSaddles& saddles, unsigned faces) {
    Changes changes;
    for (unsigned c = 0; c < 8; ++c) {
        int higher = 0;
        for (unsigned axis = 0; axis < 3; ++axis)
            higher += test::isHigher(scalars, c ^ 1u << axis, c) ? 1 : 0;
        add(changes.euler, scalars[c], higher == 3 ? 1 : higher == 0 ? -1 : 0);
    }
    for (; faces != 0; faces &= faces - 1) {
        const int face = std::countr_zero(faces);
        const auto& f = cell::kFaceCorners[static_cast<std::size_t>(face)];
        const std::array<double, 4> at{scalars[f[0]], scalars[f[1]], scalars[f[2]], scalars[f[3]]};
        const std::size_t up = test::isHigher(scalars, f[0], f[1]) ? 0 : 1;
        const double a = at[up], b = at[up + 1], c = at[up + 2], d = at[(up + 3) % 4];
        add(changes.euler, std::min(a, c) > std::max(b, d) ? cell::lastJoined(a, b, c, d) : std::max(b, d),
            saddles.eulerAtFace(face));
    }
    for (const BodySaddle& saddle : saddles.inner()) {
        add(changes.euler, saddle.isovalue, saddle.euler());
        if (saddle.face < 0)
            changes.inner.insert({saddle.isovalue, saddle.isOfAbove, {saddle.corners[0], saddle.corners[1]}});
    }
    return changes;
}

struct Tally {
    int cells = 0, certain = 0, inner = 0;
};

template <class Draw>
Tally expectTheSame(const char* name, int cells, const Draw& draw) {
    Tally tally;
    for (tally.cells = 0; tally.cells < cells; ++tally.cells) {
        cell::CornerScalars scalars;
        for (double& scalar : scalars)
            scalar = draw();
        const unsigned code = test::cellCodeOf(scalars), faces = code & kSaddleFaces;
        CellSaddles saddles;
        if (!saddles.find(scalars, faces, (code & kMayHaveInner) != 0))
            continue;
        ++tally.certain;
        tally.inner += static_cast<int>(saddles.inner().size());
        const Changes expected = byStates(scalars), found = byDerivatives(scalars, saddles, faces);
        if (found.euler == expected.euler && found.inner == expected.inner)
            continue;
        ADD_FAILURE() << name << ", cell " << tally.cells << ": " << testing::PrintToString(scalars);
        break;
    }
    return tally;
}

TEST(CellSaddles, AreThoseOfTheStates) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto reals = expectTheSame("reals", 60000, [&] { return unit(random); });
    EXPECT_GT(reals.certain, 58500);
    EXPECT_GT(reals.inner, 5000);
    const auto floats = expectTheSame("floats", 60000, [&] { return static_cast<float>(100.0 + unit(random)); });
    EXPECT_GT(floats.certain, 58000);
    std::normal_distribution<double> noise(-1000.0, 20.0);
    const auto scan = expectTheSame("a scan's noise", 60000, [&] { return std::round(noise(random)); });
    EXPECT_GT(scan.certain, 59900);
    EXPECT_GT(scan.inner, 5000);
}

// Equal corners, and critical points that lie on faces: little is left to the states, the rest must be as they are.
TEST(CellSaddles, AreThoseOfTheStatesAmongTies) {
    std::mt19937_64 random(12);
    for (const int most : {1, 2, 3, 5, 9}) {
        std::uniform_int_distribution<int> integers(0, most);
        const auto tally = expectTheSame("integers", 40000, [&] { return integers(random); });
        EXPECT_GT(tally.certain, most == 1 ? 30000 : 34000) << most;
        EXPECT_LT(tally.certain, 40000) << most;
    }
}

TEST(CellSaddles, AreLeftToTheStatesWhereDoublesEnd) {
    std::mt19937_64 random(13);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (const double size : {1e-308, 1e-150, 1e100, 1e300})
        expectTheSame("far numbers", 4000, [&] { return size * unit(random); });
}

} // namespace
} // namespace isoslider::topology
