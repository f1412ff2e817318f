#include <cmath>
#include <numbers>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class CliExtract : public CliTest {
protected:
    static void expectSphere(const OrderedJson& json) {
        EXPECT_EQ(json["components"], 1);
        EXPECT_EQ(json["euler"], 2);
        EXPECT_EQ(json["boundary_loops"], 0);
        EXPECT_EQ(json["closed"], true);
        EXPECT_EQ(json["manifold"], true);
        EXPECT_EQ(json["oriented"], true);
        EXPECT_EQ(json["valid"], true);
        EXPECT_EQ(json["genus"], 0);
        EXPECT_EQ(json["inner_vertices"], 0);
        for (const auto& opening : json["open_at"])
            EXPECT_EQ(opening["edges"], 0);
        EXPECT_EQ(json["vertices"], json["active_edges"]);
        EXPECT_NEAR(json["area"].get<double>(), 4 * std::numbers::pi * 25, 10);
        EXPECT_NEAR(json["volume"].get<double>(), 4.0 / 3 * std::numbers::pi * 125, 20);
    }
};

TEST_F(CliExtract, CountsTheSurfaceOfAVolume) {
    const auto json = runJson({"extract", sphereVolume(), "--isovalue", "5"});
    EXPECT_THAT(keysOf(json),
                ElementsAre("isovalue", "source", "vertices", "triangles", "active_edges", "components", "euler",
                            "boundary_loops", "closed", "manifold", "oriented", "genus", "area", "volume",
                            "degenerate_triangles", "duplicate_triangles", "open_at", "loops_at_several_places",
                            "nudged_vertices", "largest_nudge", "largest_nudge_world", "inner_vertices", "valid"));
    EXPECT_THAT(keysOf(json["open_at"]), ElementsAre("x0", "x1", "y0", "y1", "z0", "z1", "missing", "elsewhere"));
    EXPECT_THAT(keysOf(json["open_at"]["x0"]), ElementsAre("loops", "edges"));
    EXPECT_EQ(json["isovalue"], 5.0);
    EXPECT_EQ(json["source"], "volume");
    expectSphere(json);
}

TEST_F(CliExtract, TakesIsovaluesInStandardDeviations) {
    const auto info = runJson({"info", sphereVolume()});
    const double mean = info["mean"], deviation = info["standard_deviation"];
    for (const char* text : {"1.5 sigma", "1.5\xCF\x83", "1.5sd"})
        EXPECT_EQ(runJson({"extract", path("sphere.mha"), "--isovalue", text})["isovalue"], mean + 1.5 * deviation);
    EXPECT_EQ(runJson({"extract", sphereIndex(), "--isovalue=-0.5 sigma"})["isovalue"], mean - 0.5 * deviation);
    EXPECT_EQ(runJson({"extract", path("sphere.isx"), "--isovalue", "-0.5 sigma"})["isovalue"], mean - 0.5 * deviation);
    const auto steps = runJson({"slide", path("sphere.isx"), "--from", "-1sd", "--to", "1sd", "--steps", "2"})["steps"];
    EXPECT_EQ(steps[0]["isovalue"], mean - deviation);
    EXPECT_EQ(steps[2]["isovalue"], mean + deviation);
    EXPECT_EQ(runJson({"topology", path("sphere.isx"), "--at", "1 sd"})["isovalue"], mean + deviation);
    expectRefusal({"extract", path("sphere.mha"), "--isovalue", "bone sd"}, 2, "as in '2.5 sigma'");
    folder_.write("flat.mha", metaImage(2, "MET_FLOAT", floatSamples(2, [](int, int, int) { return 3.0F; })));
    expectRefusal({"extract", path("flat.mha"), "--isovalue", "1 sd"}, 3, "no two samples differ");
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

TEST_F(CliExtract, TellsWhereTheSurfaceIsOpen) {
    for (const auto& input : {sphereVolume(), sphereIndex()}) { // radius 9: cut by every face
        const auto json = runJson({"extract", input, "--isovalue", "1"});
        EXPECT_EQ(json["closed"], false);
        EXPECT_EQ(json["volume"], nullptr);
        EXPECT_EQ(json["boundary_loops"], 6);
        EXPECT_EQ(json["valid"], true);
        for (const auto* face : {"x0", "x1", "y0", "y1", "z0", "z1"}) {
            EXPECT_EQ(json["open_at"][face]["loops"], 1) << face;
            EXPECT_EQ(json["open_at"][face]["edges"], json["open_at"]["x0"]["edges"]) << face;
        }
        EXPECT_EQ(json["open_at"]["missing"]["edges"], 0);
        EXPECT_THAT(run({"extract", input, "--isovalue", "1"}).standardOutput, HasSubstr("open at x0 (1 loop, "));
    }
}

TEST_F(CliExtract, TellsHolesAtMissingValues) {
    folder_.write("holed.mha", metaImage(8, "MET_FLOAT", floatSamples(8, [](int x, int y, int z) {
                                             return x == 4 && y == 4 && z == 3 ? std::nanf("") : static_cast<float>(z);
                                         })));
    ASSERT_EQ(run({"build", path("holed.mha"), "-o", path("holed.isx")}).exitCode, 0);
    for (const auto* input : {"holed.mha", "holed.isx"}) {
        const auto json = runJson({"extract", path(input), "--isovalue", "3.5"});
        EXPECT_EQ(json["open_at"]["missing"]["loops"], 1) << input;
        EXPECT_EQ(json["open_at"]["missing"]["edges"], 8) << input;
        EXPECT_EQ(json["open_at"]["elsewhere"]["edges"], 0) << input;
        EXPECT_EQ(json["valid"], true) << input;
    }
}

TEST_F(CliExtract, MergesCellsWithinAnError) {
    const auto volume = sphereVolume();
    const auto whole = runJson({"extract", volume, "--isovalue", "5"});
    for (const char* bound : {"0.3c", "4%"}) {
        const auto json = runJson({"extract", volume, "--isovalue", "5", "--lod-error", bound});
        EXPECT_EQ(json["lod_error"], bound);
        EXPECT_LT(json["triangles"], whole["triangles"]);
        EXPECT_EQ(json["components"], 1);
        EXPECT_EQ(json["euler"], 2);
        EXPECT_EQ(json["valid"], true);
        EXPECT_NEAR(json["area"].get<double>(), 4 * std::numbers::pi * 25, 30);
        ASSERT_EQ(json["leaves"].size(), 6u);
        EXPECT_GT(json["leaves"][1].get<int>() + json["leaves"][2].get<int>(), 0);
    }
    EXPECT_EQ(runJson({"extract", volume, "--isovalue", "5", "--lod-error", "0c"}), whole);
    const auto text = run({"extract", volume, "--isovalue", "5", "--lod-error", "0.3c"});
    EXPECT_THAT(text.standardOutput, HasSubstr("within 0.3 cells"));
    for (const char* bound : {"0.3", "-1c", "c", "%", "1e999%", "nanc", "1%c"})
        expectRefusal({"extract", volume, "--isovalue", "5", "--lod-error", bound}, 2, "is not an error bound");
    const auto ofEdges = runJson({"extract", edgesIndex(), "--isovalue", "5", "--lod-error", "0.3c"});
    EXPECT_EQ(ofEdges["lod_error"], "0.3c");
    EXPECT_LT(ofEdges["triangles"], whole["triangles"]);
}

TEST_F(CliExtract, NoTriangleWithoutAreaLeavesAtATie) {
    folder_.write("point.mha", metaImage(8, "MET_FLOAT", floatSamples(8, [](int x, int y, int z) {
                                             return x == 3 && y == 4 && z == 5 ? 1.0f : 0.0f;
                                         })));
    for (const auto* name : {"a.ply", "a.obj", "a.stl", "a.off", "a.om"}) {
        const auto json = runJson({"extract", path("point.mha"), "--isovalue", "1", "-o", path(name)});
        EXPECT_EQ(json["nudged_vertices"], 6);
        EXPECT_EQ(json["largest_nudge"], 1.0 / 2048);
        EXPECT_EQ(json["degenerate_triangles"], 0);
        const auto report = runJson({"check", path(name)});
        EXPECT_EQ(report["degenerate_triangles"], 0) << name;
        EXPECT_EQ(report["triangles"], 8) << name;
        EXPECT_EQ(report["closed"], true) << name;
        EXPECT_EQ(report["euler"], 2) << name;
    }
}

TEST_F(CliExtract, WritesTheCertificateIntoTheMesh) {
    const auto json = runJson({"extract", sphereIndex(), "--isovalue", "5", "-o", path("a.ply")});
    const auto bytes = readText(path("a.ply"));
    for (const auto& line :
         {std::string("comment source: sphere.mha\n"), std::string("comment isovalue: 5\n"),
          "comment vertices: " + json["vertices"].dump() + "\n",
          "comment triangles: " + json["triangles"].dump() + "\n", std::string("comment valid: yes\n")})
        EXPECT_THAT(bytes, HasSubstr(line));
    ASSERT_EQ(run({"extract", sphereVolume(), "--isovalue", "5", "-o", path("b.ply")}).exitCode, 0);
    const auto header = [](const std::string& ply) { return ply.substr(0, ply.find("end_header")); };
    EXPECT_EQ(header(readText(path("b.ply"))), header(bytes)) << "the index says of the volume what the volume does";
}

TEST_F(CliExtract, NamesTheUnitOfLength) {
    const auto text = readText(sphereVolume());
    std::ofstream(path("um.mha"), std::ios::binary)
        << "ObjectType = Image\nDistanceUnits = um\n" + text.substr(text.find("NDims"));
    ASSERT_EQ(run({"build", path("um.mha"), "-o", path("um.isx")}).exitCode, 0);
    for (const char* input : {"um.mha", "um.isx"}) {
        EXPECT_EQ(runJson({"extract", path(input), "--isovalue", "5"})["length_unit"], "µm") << input;
        ASSERT_EQ(run({"extract", path(input), "--isovalue", "5", "-o", path("a.ply")}).exitCode, 0);
        EXPECT_THAT(readText(path("a.ply")), HasSubstr("units: um, that of the spacing")) << input;
    }
}

TEST_F(CliExtract, WritesAnUnsoundSurfaceAndSaysSo) {
    auto bytes = metaImage(16, "MET_FLOAT", floatSamples(16, [](int x, int, int) { return static_cast<float>(x); }));
    const std::string spacing = "ElementSpacing = 1 1 1";
    ASSERT_NE(bytes.find(spacing), std::string::npos);
    bytes.replace(bytes.find(spacing), spacing.size(), "ElementSpacing = 1e-170 1e-170 1e-170");
    folder_.write("tiny.mha", bytes); // no area that a number could hold
    const auto result = run({"extract", path("tiny.mha"), "--isovalue", "7.5", "-o", path("tiny.ply")});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_THAT(result.standardError, HasSubstr("450 degenerate triangles"));
    EXPECT_THAT(result.standardOutput, HasSubstr("no: 450 degenerate triangles"));
    EXPECT_THAT(readText(path("tiny.ply")), HasSubstr("comment valid: no: 450 degenerate triangles\n"));
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

TEST_F(CliExtract, StatesThatThereIsNoSurface) {
    for (const auto& input : {sphereVolume(), sphereIndex()}) {
        const auto result = run({"extract", input, "--isovalue", "1000", "-o", path("none.ply")});
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_THAT(result.standardOutput, StartsWith("surface               none at this isovalue"));
        const auto checked = run({"check", path("none.ply")});
        EXPECT_EQ(checked.exitCode, 0) << checked.standardError;
        EXPECT_THAT(checked.standardOutput, StartsWith("surface               none: the mesh has no triangle\n"));
    }
    const auto sphere = run({"extract", sphereVolume(), "--isovalue", "5", "-o", path("some.ply")});
    EXPECT_THAT(sphere.standardOutput, Not(HasSubstr("none at this isovalue")));
    EXPECT_THAT(run({"check", path("some.ply")}).standardOutput, Not(HasSubstr("no triangle")));
}

TEST_F(CliExtract, SkipsTheCheckWhenAsked) {
    const auto json = runJson({"extract", sphereVolume(), "--isovalue", "5", "--no-check", "-o", path("a.ply")});
    EXPECT_THAT(keysOf(json), ElementsAre("isovalue", "source", "vertices", "triangles", "active_edges", "checked"));
    EXPECT_EQ(json["checked"], false);
    const auto checked = runJson({"extract", sphereVolume(), "--isovalue", "5", "-o", path("b.ply")});
    EXPECT_EQ(json["vertices"], checked["vertices"]);
    EXPECT_EQ(json["triangles"], checked["triangles"]);
    const auto head = readText(path("a.ply")).substr(0, 2000);
    EXPECT_THAT(head, HasSubstr("comment Isosurface by ISOSLIDER, not checked\n"));
    EXPECT_THAT(head, HasSubstr("comment checked: no\n"));
    EXPECT_THAT(head, ::testing::Not(HasSubstr("valid")));
    EXPECT_THAT(run({"extract", sphereVolume(), "--isovalue", "5", "--no-check"}).standardOutput,
                HasSubstr("checked               no\n"));
    EXPECT_EQ(run({"check", path("a.ply")}).exitCode, 0);
}

TEST_F(CliExtract, WritesThroughASymbolicLink) {
    std::filesystem::create_directory(path("there"));
    folder_.write("there/old.ply", "what was here");
    std::filesystem::create_symlink("there/old.ply", path("link.ply"));
    EXPECT_EQ(run({"extract", sphereVolume(), "--isovalue", "5", "-o", path("link.ply")}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(path("link.ply")));
    EXPECT_EQ(runJson({"check", path("there/old.ply")})["closed"], true);
    EXPECT_EQ(run({"build", sphereVolume(), "-o", path("link.ply")}).exitCode, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(path("link.ply")));
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
        const auto result = run({"extract", path("damaged.isx"), "--isovalue", "5", "-o", path("damaged.ply")});
        // Padding and pages that this isovalue does not need may carry the damage unseen.
        EXPECT_TRUE(result.exitCode == 0 || result.exitCode == 3) << place << ": " << result.standardError;
        EXPECT_EQ(std::filesystem::exists(path("damaged.ply")), result.exitCode == 0);
        std::filesystem::remove(path("damaged.ply"));
    }
}

} // namespace isoslider::test
