#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {
namespace {

using testing::ElementsAre;

class CliTopology : public CliTest {};

TEST_F(CliTopology, CountsWhatExtractionCounts) {
    const auto volume = noiseVolume(12);
    runJson({"build", volume, "-o", path("noise.isx")});
    for (const char* isovalue : {"100.5", "700", "864.25", "1500"}) {
        const auto counts = runJson({"topology", volume, "--at", isovalue});
        EXPECT_THAT(keysOf(counts), ElementsAre("isovalue", "components", "euler", "boundary_loops", "handles", "voids",
                                                "area", "volume", "triangles", "mean_gradient"));
        const auto surface = runJson({"extract", volume, "--isovalue", isovalue});
        for (const char* key : {"components", "euler", "boundary_loops"})
            EXPECT_EQ(counts[key], surface[key]) << key << " at " << isovalue;
        const auto ofIndex = runJson({"topology", path("noise.isx"), "--at", isovalue});
        for (const char* key : {"components", "euler", "boundary_loops", "handles", "voids"})
            EXPECT_EQ(ofIndex[key], counts[key]) << key << " at " << isovalue;
        EXPECT_NEAR(ofIndex["area"].get<double>(), counts["area"].get<double>(), 0.01 * counts["area"].get<double>());
    }
}

// Two columns of cells that have an edge in common: the surface would touch itself there, and is two pieces in the
// mesh.
TEST_F(CliTopology, SaysWhatIsKnownWhereSamplesAreMissing) {
    std::vector<float> samples;
    for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 3; ++x)
                samples.push_back(std::abs(x - y) == 2 ? std::numeric_limits<float>::quiet_NaN()
                                                       : static_cast<float>(z));
    std::ofstream(path("v.raw"), std::ios::binary)
        .write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(samples.size() * sizeof(float)));
    const std::vector<std::string> volume{path("v.raw"), "--raw-dims", "3,3,2", "--raw-type", "f32"};
    const auto answer = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin() + 1, volume.begin(), volume.end());
        return arguments;
    };
    const auto counts = runJson(answer({"topology", "--at", "0.5"}));
    const auto surface = runJson(answer({"extract", "--isovalue", "0.5"}));
    EXPECT_FALSE(counts["counts_exact"].get<bool>());
    EXPECT_EQ(counts["euler"], 2);
    EXPECT_EQ(counts["euler"], surface["euler"]);
    EXPECT_LE(counts["components"], surface["components"]);
    EXPECT_TRUE(counts["handles"].is_null());
    EXPECT_THAT(run(answer({"topology", "--at", "0.5"})).standardOutput, testing::HasSubstr("unknown tunnels"));
}

/// What is counted of a mesh here, by its vertices and triangles alone.
struct MeshCounts {
    std::int64_t pieces = 0, euler = 0, loops = 0, tunnels = 0, voids = 0;
};

int rootOf(std::vector<int>& parents, int of) {
    while (parents[static_cast<std::size_t>(of)] != of)
        of = parents[static_cast<std::size_t>(of)] =
            parents[static_cast<std::size_t>(parents[static_cast<std::size_t>(of)])];
    return of;
}

// A void is bounded from outside by one closed piece, which is wound towards it: its volume is negative.
MeshCounts countsOfObj(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<std::array<double, 3>> places;
    std::vector<std::array<int, 3>> triangles;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind, corner;
        words >> kind;
        if (kind == "v")
            words >> places.emplace_back()[0] >> places.back()[1] >> places.back()[2];
        if (kind == "f")
            for (int& vertex : triangles.emplace_back()) {
                words >> corner;
                vertex = std::stoi(corner) - 1; // up to a slash
            }
    }
    std::vector<int> pieces(places.size()), ends(places.size());
    std::iota(pieces.begin(), pieces.end(), 0);
    std::set<std::pair<int, int>> directed;
    for (const auto& triangle : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const int from = triangle[k], to = triangle[(k + 1) % 3];
            EXPECT_TRUE(directed.emplace(from, to).second) << "an edge twice";
            pieces[static_cast<std::size_t>(rootOf(pieces, from))] = rootOf(pieces, to);
        }
    MeshCounts counts;
    std::int64_t borders = 0;
    std::set<int> open; // pieces with a border
    std::iota(ends.begin(), ends.end(), 0);
    std::set<int> onBorder;
    for (const auto& [from, to] : directed)
        if (directed.count({to, from}) == 0) {
            ++borders;
            open.insert(rootOf(pieces, from));
            onBorder.insert({from, to});
            ends[static_cast<std::size_t>(rootOf(ends, from))] = rootOf(ends, to);
        }
    for (const int vertex : onBorder)
        counts.loops += rootOf(ends, vertex) == vertex ? 1 : 0;
    std::map<int, double> volumes;
    for (const auto& triangle : triangles) {
        const auto& a = places[static_cast<std::size_t>(triangle[0])];
        const auto& b = places[static_cast<std::size_t>(triangle[1])];
        const auto& c = places[static_cast<std::size_t>(triangle[2])];
        const auto& origin = places[static_cast<std::size_t>(rootOf(pieces, triangle[0]))]; // near: nothing cancels
        const auto from = [&origin](const std::array<double, 3>& p) {
            return std::array{p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        };
        const auto u = from(a), v = from(b), w = from(c);
        volumes[rootOf(pieces, triangle[0])] += u[0] * (v[1] * w[2] - v[2] * w[1]) +
                                                u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
    }
    const auto edges = (static_cast<std::int64_t>(directed.size()) + borders) / 2;
    counts.pieces = static_cast<std::int64_t>(volumes.size());
    counts.euler = static_cast<std::int64_t>(places.size()) - edges + static_cast<std::int64_t>(triangles.size());
    counts.tunnels = (2 * counts.pieces - counts.loops - counts.euler) / 2;
    for (const auto& [piece, volume] : volumes)
        counts.voids += open.count(piece) == 0 && volume < 0.0 ? 1 : 0;
    return counts;
}

TEST_F(CliTopology, CountsWhatTheExtractedMeshHas) {
    std::mt19937 random(5);
    MeshCounts all;
    for (const bool isInteger : {false, true})
        for (int grid = 0; grid < 2; ++grid) {
            std::vector<float> samples(16 * 16 * 16);
            for (float& sample : samples)
                sample = isInteger ? static_cast<float>(random() % 6)
                                   : std::uniform_real_distribution<float>(0.0F, 5.0F)(random);
            std::ofstream(path("grid.raw"), std::ios::binary)
                .write(reinterpret_cast<const char*>(samples.data()),
                       static_cast<std::streamsize>(samples.size() * sizeof(float)));
            const std::vector<std::string> raw{path("grid.raw"), "--raw-dims", "16,16,16", "--raw-type", "f32"};
            for (int i = 0; i < 6; ++i) {
                const std::string isovalue =
                    fmt::format("{}", std::uniform_real_distribution<double>(0.3, 4.7)(random));
                SCOPED_TRACE(fmt::format("{} grid {} at {}", isInteger ? "integer" : "real", grid, isovalue));
                std::vector<std::string> count{"topology", "--at", isovalue};
                count.insert(count.end(), raw.begin(), raw.end());
                std::vector<std::string> extract{"extract", "--isovalue", isovalue, "-o", path("mesh.obj")};
                extract.insert(extract.end(), raw.begin(), raw.end());
                const auto counts = runJson(count);
                runJson(extract);
                const MeshCounts mesh = countsOfObj(path("mesh.obj"));
                EXPECT_EQ(counts["components"], mesh.pieces);
                EXPECT_EQ(counts["euler"], mesh.euler);
                EXPECT_EQ(counts["boundary_loops"], mesh.loops);
                EXPECT_EQ(counts["handles"], mesh.tunnels);
                EXPECT_EQ(counts["voids"], mesh.voids);
                all.tunnels += mesh.tunnels;
                all.voids += mesh.voids;
            }
        }
    EXPECT_GT(all.tunnels, 1000);
    EXPECT_GT(all.voids, 500);
}

TEST_F(CliTopology, ListsTheMostPersistentEvents) {
    const auto volume = noiseVolume(10);
    const auto all = runJson({"topology", volume, "--events", "0"});
    ASSERT_EQ(all["events"].size(), all["event_count"]);
    ASSERT_GT(all["events"].size(), 100u);
    EXPECT_THAT(keysOf(all["events"][0]), ElementsAre("isovalue", "kind", "position", "before", "after", "persistence",
                                                      "births", "deaths", "joins", "splits"));
    for (std::size_t i = 1; i < all["events"].size(); ++i)
        EXPECT_EQ(all["events"][i]["before"], all["events"][i - 1]["after"]);
    const auto few = runJson({"topology", volume, "--events", "5"});
    ASSERT_EQ(few["events"].size(), 5u);
    double least = 1e9;
    for (const auto& event : few["events"])
        least = std::min(least, event["persistence"].get<double>());
    std::size_t atLeast = 0;
    for (const auto& event : all["events"])
        atLeast += event["persistence"].get<double>() > least ? 1 : 0;
    EXPECT_LT(atLeast, 5u);
    EXPECT_EQ(runJson({"topology", volume})["event_count"], all["event_count"]);
}

TEST_F(CliTopology, DrawsCurvesWhereTheSurfaceWasMeasured) {
    const auto volume = sphereVolume();
    const auto curves = runJson({"topology", volume, "--curves"});
    const std::size_t steps = curves["isovalue"].size();
    ASSERT_GT(steps, 128u);
    ASSERT_LE(steps, 256u);
    for (const char* key :
         {"components", "euler", "boundary_loops", "handles", "voids", "area", "volume", "triangles", "mean_gradient"})
        EXPECT_EQ(curves[key].size(), steps) << key;
    for (std::size_t step = 5; step < steps; step += 50) {
        const double isovalue = curves["isovalue"][step];
        const auto mesh = runJson({"extract", volume, "--isovalue", fmt::format("{}", isovalue), "-o",
                                   (folder_ / fmt::format("{}.ply", step)).string()});
        EXPECT_NEAR(curves["triangles"][step].get<double>(), mesh["triangles"].get<double>(), 0.5) << isovalue;
    }
    EXPECT_THAT(run({"topology", volume, "--at", "5"}).standardOutput,
                testing::StartsWith("isovalue 5: 1 piece, 0 tunnels, 0 boundary loops, 0 voids, Euler number 2\n"));
}

TEST_F(CliTopology, AnswersOtherQuestions) {
    const auto volume = sphereVolume(); // distances from a point near the middle
    const auto one = runJson({"topology", volume, "--pieces", "1"});
    ASSERT_FALSE(one["intervals"].empty());
    EXPECT_LT(one["intervals"][0][0], 5);
    EXPECT_GT(one["intervals"][0][1], 5);
    const auto measures = runJson({"topology", volume, "--at", "5"});
    for (const char* question : {"area", "volume"}) {
        const auto found = runJson(
            {"topology", volume, fmt::format("--{}", question), fmt::format("{}", measures[question].get<double>())});
        ASSERT_FALSE(found["isovalues"].empty()) << question;
        double nearest = 1e9;
        for (const auto& isovalue : found["isovalues"])
            nearest = std::min(nearest, std::abs(isovalue.get<double>() - 5.0));
        EXPECT_LT(nearest, 1e-6) << question;
    }
    const auto between = runJson({"topology", volume, "--between", "3", "5"});
    EXPECT_EQ(between["from"]["components"], 1);
    EXPECT_NEAR(std::abs(between["volume_between"].get<double>()), 4.0 / 3.0 * 3.14159265 * (343 - 125),
                15.0); // radii of 7 and 5
    const auto suggested = runJson({"topology", volume, "--suggest"});
    EXPECT_FALSE(suggested["suggestions"].empty());
    for (const auto& suggestion : suggested["suggestions"])
        EXPECT_FALSE(suggestion["reason"].get<std::string>().empty());
    EXPECT_THAT(run({"topology", volume, "--tunnels", "77"}).standardOutput, testing::HasSubstr("no isovalue"));
    expectRefusal({"topology", volume, "--between", "5", "3"}, 2, "lesser");
    expectRefusal({"topology", volume, "--between", "5"}, 2);
}

TEST_F(CliTopology, AddsWhatAnIndexLacks) {
    const auto index = path("bare.isx");
    runJson({"build", sphereVolume(), "-o", index, "--no-topology"});
    const auto size = std::filesystem::file_size(index);
    const auto first = runJson({"topology", index, "--events", "0"});
    EXPECT_GT(std::filesystem::file_size(index), size);
    EXPECT_EQ(runJson({"topology", index, "--events", "0"}), first);
    EXPECT_EQ(runJson({"stats", index}).is_object(), true);
}

TEST_F(CliTopology, IsFoundInTheSamplesOfAnIndexOfEdgesToo) {
    runJson({"build", sphereVolume(), "-o", path("edges.isx"), "--index", "edges", "--no-topology"});
    runJson({"build", sphereVolume(), "-o", path("metacells.isx"), "--index", "metacells", "--no-topology"});
    EXPECT_EQ(runJson({"topology", path("edges.isx"), "--at", "5"}),
              runJson({"topology", path("metacells.isx"), "--at", "5"}));
}

TEST_F(CliTopology, RefusesWhatItCannotCount) {
    expectRefusal({"topology", sphereVolume(), "--at", "5", "--curves"}, 2);
    expectRefusal({"topology", sphereVolume(), "--events", "-1"}, 2);
    expectRefusal({"topology", path("missing.mha")}, 4);
}

} // namespace
} // namespace isoslider::test
