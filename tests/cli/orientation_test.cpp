// One shape, stored with its axes in other orders and directions, lies in one place in space.

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {
namespace {

using Vector = std::array<double, 3>;

// A lump with a different radius along each half axis, and a bump: no turn or mirror image of itself.
double lump(const Vector& p) {
    const double x = p[0] / (p[0] > 0 ? 7.0 : 4.0), y = p[1] / (p[1] > 0 ? 5.0 : 3.5),
                 z = p[2] / (p[2] > 0 ? 6.0 : 4.5);
    const double bump = std::exp(-(std::pow(p[0] - 4, 2) + std::pow(p[1] - 3, 2) + std::pow(p[2] + 2, 2)) / 6);
    return 10.0 - 6.0 * std::sqrt(x * x + y * y + z * z) + 4.0 * bump;
}

struct Axis {
    int world; ///< which axis of space it runs along
    bool isDown; ///< against it
};

class CliOrientation : public CliTest {
protected:
    /// The lump on the same points of space, stored along `axes`: 20 x 16 x 18 points, 1, 1.25 and 0.8 apart.
    std::string store(const std::string& name, const std::array<Axis, 3>& axes) const {
        constexpr std::array<int, 3> kPoints{20, 16, 18};
        const Vector spacing{1.0, 1.25, 0.8}, lowest{-9.0, -9.0, -7.0};
        std::array<int, 3> dims{};
        Vector offset = lowest, distances{};
        std::string matrix;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto w = static_cast<std::size_t>(axes[a].world);
            dims[a] = kPoints[w];
            distances[a] = spacing[w];
            if (axes[a].isDown)
                offset[w] = lowest[w] + spacing[w] * (kPoints[w] - 1);
            for (std::size_t row = 0; row < 3; ++row)
                matrix += row != w ? " 0" : axes[a].isDown ? " -1" : " 1";
        }
        std::string samples;
        for (int k = 0; k < dims[2]; ++k)
            for (int j = 0; j < dims[1]; ++j)
                for (int i = 0; i < dims[0]; ++i) {
                    Vector place = offset;
                    const std::array<int, 3> index{i, j, k};
                    for (std::size_t a = 0; a < 3; ++a) {
                        const auto w = static_cast<std::size_t>(axes[a].world);
                        place[w] = offset[w] + (axes[a].isDown ? -1 : 1) * index[a] * spacing[w];
                    }
                    const auto value = static_cast<float>(lump(place));
                    samples.append(reinterpret_cast<const char*>(&value), sizeof value);
                }
        folder_.write(name,
                      fmt::format("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                                  "CompressedData = False\nTransformMatrix ={}\nOffset = {}\nElementSpacing = {}\n"
                                  "DimSize = {}\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n",
                                  matrix, fmt::join(offset, " "), fmt::join(distances, " "), fmt::join(dims, " ")) +
                          samples);
        return path(name);
    }

    /// Vertices of an exported mesh, sorted, rounded far below the distance of samples.
    std::vector<std::array<long, 3>> verticesOf(const std::string& volume, const std::string& suffix) const {
        const auto out = path("surface." + suffix);
        EXPECT_EQ(run({"extract", volume, "--isovalue", "5", "-o", out}).exitCode, 0);
        std::istringstream text(readText(out));
        std::vector<std::array<long, 3>> vertices;
        std::string word;
        while (text >> word)
            if (word == "v") {
                Vector p{};
                text >> p[0] >> p[1] >> p[2];
                vertices.push_back({std::lround(p[0] * 1e4), std::lround(p[1] * 1e4), std::lround(p[2] * 1e4)});
            } else {
                std::getline(text, word);
            }
        std::sort(vertices.begin(), vertices.end());
        return vertices;
    }
};

TEST_F(CliOrientation, TheSameShapeLiesInTheSamePlace) {
    const std::array<std::array<Axis, 3>, 8> orientations{{{{{0, false}, {1, false}, {2, false}}},
                                                           {{{1, false}, {2, false}, {0, false}}},
                                                           {{{0, true}, {1, true}, {2, false}}},
                                                           {{{2, true}, {0, false}, {1, true}}},
                                                           {{{1, true}, {0, false}, {2, false}}},
                                                           {{{0, false}, {2, true}, {1, false}}},
                                                           // left-handed ones
                                                           {{{0, true}, {1, false}, {2, false}}},
                                                           {{{1, false}, {0, false}, {2, false}}}}};
    const auto first = verticesOf(store("first.mha", orientations[0]), "obj");
    ASSERT_GT(first.size(), 300U);
    const auto facts = runJson({"extract", path("first.mha"), "--isovalue", "5"});
    EXPECT_GT(facts["volume"], 0.0);
    for (std::size_t i = 1; i < orientations.size(); ++i) {
        const auto volume = store("other.mha", orientations[i]);
        const auto other = verticesOf(volume, "obj");
        ASSERT_EQ(other.size(), first.size()) << i;
        for (std::size_t v = 0; v < first.size(); ++v)
            for (std::size_t a = 0; a < 3; ++a)
                ASSERT_NEAR(other[v][a], first[v][a], 2) << i;
        const auto same = runJson({"extract", volume, "--isovalue", "5"});
        // Polygons of a cell are cut into triangles in the order of its axes: the same corners, other diagonals.
        const double volumeThere = facts["volume"], areaThere = facts["area"];
        EXPECT_NEAR(same["volume"].get<double>(), volumeThere, 0.005 * volumeThere) << "outside is outside: " << i;
        EXPECT_NEAR(same["area"].get<double>(), areaThere, 0.005 * areaThere) << i;
        EXPECT_EQ(same["euler"], facts["euler"]);
        // And through an index of either kind.
        for (const auto* kind : {"edges", "metacells"}) {
            ASSERT_EQ(run({"build", volume, "-o", path("other.isx"), "--index", kind}).exitCode, 0);
            EXPECT_EQ(verticesOf(path("other.isx"), "obj"), other) << kind;
        }
    }
}

} // namespace
} // namespace isoslider::test
