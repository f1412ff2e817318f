#include "core/cell/merged_cell.h"

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace isoslider::cell {
namespace {

using Place = std::array<int, 3>;

bool isAbove(MergedSigns signs, const Place& p) { return signs >> (p[0] + 3 * p[1] + 9 * p[2]) & 1; }

// The surface of cubes of side `step` with one sign per corner, from first principles: loops are what the segments of
// all faces join; a face with four crossings is ambiguous.
struct Surface {
    bool isAmbiguous = false;
    int mostLoops = 0; // of one cube
    int euler = 0; // edges crossed - segments + loops
};

std::array<Place, 4> squareAt(const Place& corner, int normal, int step) {
    std::array<Place, 4> square{corner, corner, corner, corner};
    const int u = (normal + 1) % 3, v = (normal + 2) % 3;
    square[1][static_cast<std::size_t>(u)] += step;
    square[2][static_cast<std::size_t>(u)] += step;
    square[2][static_cast<std::size_t>(v)] += step;
    square[3][static_cast<std::size_t>(v)] += step;
    return square;
}

Surface surfaceOf(MergedSigns signs, int step) {
    using Edge = std::array<Place, 2>;
    Surface surface;
    std::set<Edge> crossed;
    std::set<std::set<Edge>> segments;
    int loops = 0;
    for (int z = 0; z < 2; z += step)
        for (int y = 0; y < 2; y += step)
            for (int x = 0; x < 2; x += step) {
                std::vector<std::set<Edge>> groups; // of edges of this cube, joined by segments
                for (int normal = 0; normal < 3; ++normal)
                    for (const int side : {0, step}) {
                        Place corner{x, y, z};
                        corner[static_cast<std::size_t>(normal)] += side;
                        const auto square = squareAt(corner, normal, step);
                        std::set<Edge> ends;
                        for (std::size_t i = 0; i < 4; ++i) {
                            Edge edge{square[i], square[(i + 1) % 4]};
                            if (isAbove(signs, edge[0]) == isAbove(signs, edge[1]))
                                continue;
                            if (edge[1] < edge[0])
                                std::swap(edge[0], edge[1]);
                            ends.insert(edge);
                        }
                        surface.isAmbiguous |= ends.size() == 4;
                        if (ends.empty())
                            continue;
                        crossed.insert(ends.begin(), ends.end());
                        segments.insert(ends);
                        std::set<Edge> joined = ends;
                        std::erase_if(groups, [&](const std::set<Edge>& group) {
                            const bool meets = std::any_of(group.begin(), group.end(),
                                                           [&](const Edge& edge) { return ends.contains(edge); });
                            if (meets)
                                joined.insert(group.begin(), group.end());
                            return meets;
                        });
                        groups.push_back(joined);
                    }
                loops += static_cast<int>(groups.size());
                surface.mostLoops = std::max(surface.mostLoops, static_cast<int>(groups.size()));
            }
    surface.euler = static_cast<int>(crossed.size()) - static_cast<int>(segments.size()) + loops;
    return surface;
}

bool keepsTopologyReference(MergedSigns signs) {
    if (signs == 0 || signs == kAllAbove)
        return true;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int u = 0; u <= 2; u += 2)
            for (int v = 0; v <= 2; v += 2) {
                int changes = 0;
                for (int i = 0; i < 2; ++i) {
                    Place from{}, to{};
                    from[(axis + 1) % 3] = to[(axis + 1) % 3] = u;
                    from[(axis + 2) % 3] = to[(axis + 2) % 3] = v;
                    from[axis] = i;
                    to[axis] = i + 1;
                    changes += isAbove(signs, from) != isAbove(signs, to);
                }
                if (changes > 1)
                    return false;
            }
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int side : {0, 2}) {
            Place middle{1, 1, 1};
            middle[axis] = side;
            int different = 0;
            for (std::size_t other = 0; other < 3; ++other)
                for (const int place : {0, 2}) {
                    Place beside = middle;
                    beside[other] = place;
                    different += other != axis && isAbove(signs, beside) != isAbove(signs, middle);
                }
            if (different == 4)
                return false;
        }
    const Surface halves = surfaceOf(signs, 1), whole = surfaceOf(signs, 2);
    return !halves.isAmbiguous && !whole.isAmbiguous && halves.mostLoops <= 1 && whole.mostLoops == 1 &&
           halves.euler == 1;
}

// A plane through the cell, at a random place, with a few samples turned over.
MergedSigns randomSigns(std::mt19937& random) {
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    const std::array<double, 4> plane{part(random), part(random), part(random), 2.0 * part(random)};
    MergedSigns signs = 0;
    for (int p = 0; p < 27; ++p) {
        const double value = plane[0] * (p % 3 - 1) + plane[1] * (p / 3 % 3 - 1) + plane[2] * (p / 9 - 1) + plane[3];
        signs |= MergedSigns{value > 0.0} << p;
    }
    for (unsigned turned = random() % 4; turned > 1; --turned)
        signs ^= MergedSigns{1} << random() % 27;
    return signs;
}

TEST(MergedCell, KeepsTopologyAsItsDefinitionStates) {
    std::mt19937 random(3);
    int kept = 0, refused = 0;
    for (int i = 0; i < 40000; ++i) {
        const MergedSigns signs = i % 8 == 0 ? random() & kAllAbove : randomSigns(random);
        const bool expected = keepsTopologyReference(signs);
        ASSERT_EQ(keepsTopology(signs), expected) << signs;
        ASSERT_EQ(keepsTopology(~signs & kAllAbove), expected) << signs << ": neither side is special";
        (expected ? kept : refused) += signs != 0 && signs != kAllAbove;
    }
    EXPECT_GT(kept, 4000);
    EXPECT_GT(refused, 4000);
}

// Half-spaces with some signs turned: of random ones hardly any keep their topology.
TEST(MergedCell, AnswersForSixtyFourAsForOne) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int kept = 0, refused = 0;
    for (int round = 0; round < 3000; ++round) {
        std::array<std::uint64_t, 27> words{};
        std::array<MergedSigns, 64> cells{};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const double a = unit(random), b = unit(random), c = unit(random), d = 2.0 * unit(random);
            for (int p = 0; p < 27; ++p)
                if (a * (p % 3 - 1) + b * (p / 3 % 3 - 1) + c * (p / 9 - 1) > d)
                    cells[i] |= MergedSigns{1} << p;
            for (unsigned turned = random() % 3; turned > 0; --turned)
                cells[i] ^= MergedSigns{1} << random() % 27;
            for (std::size_t p = 0; p < 27; ++p)
                words[p] |= std::uint64_t{cells[i] >> p & 1} << i;
        }
        const std::uint64_t answers = keepsTopologyOf64(words);
        std::array<TwoWords, 27> both;
        for (std::size_t p = 0; p < 27; ++p)
            both[p] = TwoWords{words[p], ~words[26 - p]}; // other cells, with the same answers
        const TwoWords answersOfBoth = keepsTopologyOf128(both);
        ASSERT_EQ(answersOfBoth[0], answers);
        ASSERT_EQ(answersOfBoth[1], answers);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            ASSERT_EQ(answers >> i & 1, std::uint64_t{keepsTopology(cells[i])}) << std::hex << cells[i];
            ++(answers >> i & 1 ? kept : refused);
        }
    }
    EXPECT_GT(kept, 10000);
    EXPECT_GT(refused, 10000);
}

TEST(MergedCell, RefusesWhatAMergerWouldLose) {
    EXPECT_FALSE(keepsTopology(MergedSigns{1} << 13)) << "a piece around the middle";
    EXPECT_FALSE(keepsTopology(kAllAbove & ~(MergedSigns{1} << 4))) << "a dent in a face";
    EXPECT_FALSE(keepsTopology(MergedSigns{2})) << "the middle of an edge";
    EXPECT_FALSE(keepsTopology(1u | 1u << 26)) << "two corners";
    EXPECT_TRUE(keepsTopology(1u)) << "one corner";
    EXPECT_TRUE(keepsTopology(0x1ff)) << "a plane";
}

// All patterns in which, from each point above, the next one along each axis is above too: 3 x 3 stacks that do not
// fall along either axis. Turned round along any axes they are those in which samples ascend or descend.
TEST(MergedCell, KeepsTopologyWhereverSamplesAscendOrDescendAlongEachAxis) {
    int patterns = 0;
    for (unsigned code = 0; code < 1u << 18; ++code) {
        const auto height = [code](int x, int y) { return code >> (2 * (x + 3 * y)) & 3; };
        bool rises = true;
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 3; ++x)
                rises = rises && (x == 0 || height(x, y) >= height(x - 1, y)) &&
                        (y == 0 || height(x, y) >= height(x, y - 1));
        if (!rises)
            continue;
        ++patterns;
        for (unsigned turned = 0; turned < 8; ++turned) {
            MergedSigns signs = 0;
            for (int z = 0; z < 3; ++z)
                for (int y = 0; y < 3; ++y)
                    for (int x = 0; x < 3; ++x)
                        if (height(x, y) + static_cast<unsigned>(z) >= 3)
                            signs |= 1u << ((turned & 1 ? 2 - x : x) + 3 * (turned & 2 ? 2 - y : y) +
                                            9 * (turned & 4 ? 2 - z : z));
            if (signs != 0 && signs != kAllAbove)
                ASSERT_TRUE(keepsTopology(signs)) << signs;
        }
    }
    EXPECT_EQ(patterns, 980) << "the plane partitions in a box of side 3";
}

} // namespace
} // namespace isoslider::cell
