#include <cmath>
#include <numbers>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

using ::testing::ElementsAre;

class CliExtract : public CliTest {
protected:
    static void expectSphere(const OrderedJson& json) {
        EXPECT_EQ(json["components"], 1);
        EXPECT_EQ(json["euler"], 2);
        EXPECT_EQ(json["boundary_loops"], 0);
        EXPECT_EQ(json["closed"], true);
        EXPECT_EQ(json["manifold"], true);
        EXPECT_EQ(json["vertices"], json["active_edges"]);
        EXPECT_NEAR(json["area"].get<double>(), 4 * std::numbers::pi * 25, 10);
        EXPECT_NEAR(json["volume"].get<double>(), 4.0 / 3 * std::numbers::pi * 125, 20);
    }
};

TEST_F(CliExtract, CountsTheSurfaceOfAVolume) {
    const auto json = runJson({"extract", sphereVolume(), "--isovalue", "5"});
    EXPECT_THAT(keysOf(json),
                ElementsAre("isovalue", "source", "vertices", "triangles", "active_edges", "components",
                            "euler", "boundary_loops", "closed", "manifold", "area", "volume"));
    EXPECT_EQ(json["isovalue"], 5.0);
    EXPECT_EQ(json["source"], "volume");
    expectSphere(json);
}

TEST_F(CliExtract, CountsTheSameFromTheIndex) {
    auto fromIndex = runJson({"extract", sphereIndex(), "--isovalue", "5"});
    EXPECT_EQ(fromIndex["source"], "index");
    expectSphere(fromIndex);
    const auto fromVolume = runJson({"extract", sphereVolume(), "--isovalue", "5"});
    for (const auto* key : {"vertices", "triangles", "active_edges", "components", "euler", "boundary_loops"})
        EXPECT_EQ(fromIndex[key], fromVolume[key]) << key;
}

TEST_F(CliExtract, NeedsOnlyTheIndexOnceItIsBuilt) {
    const auto index = sphereIndex();
    std::filesystem::remove(path("sphere.mha"));
    EXPECT_EQ(run({"extract", index, "--isovalue", "5", "-o", path("a.ply")}).exitCode, 0);
}

TEST_F(CliExtract, WritesEveryMeshFormatThatCheckAccepts) {
    const auto index = sphereIndex();
    for (const auto* name : {"a.ply", "a.obj", "a.stl", "a.off", "a.om"}) {
        ASSERT_EQ(run({"extract", index, "--isovalue", "5", "-o", path(name)}).exitCode, 0) << name;
        const auto report = runJson({"check", path(name)});
        EXPECT_EQ(report["closed"], true) << name;
        EXPECT_EQ(report["euler"], 2) << name;
    }
}

TEST_F(CliExtract, GivesAnEmptySurfaceOutsideTheRange) {
    for (const auto& input : {sphereVolume(), sphereIndex()}) {
        for (const auto* isovalue : {"1000", "-1000", "-1e308"}) {
            const auto json = runJson({"extract", input, "--isovalue", isovalue, "-o", path("empty.ply")});
            EXPECT_EQ(json["triangles"], 0);
            EXPECT_TRUE(std::filesystem::exists(path("empty.ply")));
        }
    }
}

TEST_F(CliExtract, RefusesOutputsBeforeWork) {
    const auto volume = sphereVolume();
    expectRefusal({"extract", volume}, 2, "--isovalue");
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("a.docx")}, 2, "a.docx");
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("missing/a.ply")}, 4, "folder");
    std::filesystem::create_directory(path("folder.ply"));
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("folder.ply")}, 4, "directory");
    std::filesystem::copy_file(volume, path("volume.ply"));
    std::filesystem::create_symlink(volume, path("link.ply"));
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("link.ply")}, 2, "is the input");
}

TEST_F(CliExtract, RefusesAnIndexOfAnotherVersion) {
    auto bytes = readText(sphereIndex());
    bytes[12] = static_cast<char>(bytes[12] + 1); // the version lies behind the twelve bytes of magic
    folder_.write("later.isx", bytes);
    expectRefusal({"extract", path("later.isx"), "--isovalue", "5"}, 3, "version");
}

TEST_F(CliExtract, RefusesADamagedIndex) {
    const auto index = sphereIndex();
    const auto whole = readText(index);
    for (std::size_t place = 0; place < whole.size(); place += 1 + whole.size() / 40) {
        auto bytes = whole;
        bytes[place] = static_cast<char>(bytes[place] ^ 0x10);
        folder_.write("damaged.isx", bytes);
        const auto result =
            run({"extract", path("damaged.isx"), "--isovalue", "5", "-o", path("damaged.ply")});
        // Padding and pages that this isovalue does not need may carry the damage unseen.
        EXPECT_TRUE(result.exitCode == 0 || result.exitCode == 3) << place << ": " << result.standardError;
        EXPECT_EQ(std::filesystem::exists(path("damaged.ply")), result.exitCode == 0);
        std::filesystem::remove(path("damaged.ply"));
    }
}

} // namespace isoslider::test
