#include "tests/cli/cli_fixture.h"

#include <cmath>

namespace isoslider::test {

using ::testing::HasSubstr;

class CliInfo : public CliTest {};

TEST_F(CliInfo, TellsWhatAVolumeHolds) {
    const auto json = runJson({"info", sphereVolume()});
    EXPECT_THAT(keysOf(json),
                ::testing::ElementsAre("dims", "spacing", "origin", "scalar_type", "min", "max", "mean",
                                       "standard_deviation", "distinct_values", "nan_count", "format", "direction"));
    EXPECT_EQ(json["dims"], OrderedJson({16, 16, 16}));
    EXPECT_EQ(json["spacing"], OrderedJson({1.0, 1.0, 1.0}));
    EXPECT_EQ(json["scalar_type"], "f32");
    EXPECT_EQ(json["nan_count"], 0);
    EXPECT_NEAR(json["max"].get<double>(), 10.0 - std::sqrt(0.75), 1e-5);
    EXPECT_GT(json["distinct_values"], 20);
}

TEST_F(CliInfo, TellsTheSameOfTheIndex) {
    const auto volume = runJson({"info", sphereVolume()});
    const auto index = runJson({"info", sphereIndex()});
    EXPECT_EQ(keysOf(volume), keysOf(index));
    for (const auto* key : {"dims", "spacing", "origin", "scalar_type", "min", "max", "mean", "standard_deviation",
                            "distinct_values", "nan_count", "direction"})
        EXPECT_EQ(volume[key], index[key]) << key;
}

TEST_F(CliInfo, StatesMeanAndStandardDeviation) {
    folder_.write("a.mha", metaImage(2, "MET_FLOAT", floatSamples(2, [](int x, int y, int z) {
                                         return std::vector<float>{
                                             2, 4, 4, 4, 5, 5, 7, 9}[static_cast<std::size_t>(x + 2 * y + 4 * z)];
                                     })));
    const auto json = runJson({"info", path("a.mha")});
    EXPECT_EQ(json["mean"], 5.0);
    EXPECT_EQ(json["standard_deviation"], 2.0);
    EXPECT_FALSE(json.contains("mean_is_estimated"));
    EXPECT_THAT(run({"info", path("a.mha")}).standardOutput, HasSubstr("mean             5\nstd. deviation   2\n"));
}

TEST_F(CliInfo, ReadsAHeaderlessVolumeAsTold) {
    const auto raw = rawSphere();
    auto arguments = std::vector<std::string>{"info", raw, "--raw-spacing", "1,2,0.5"};
    for (const auto& option : rawOptions())
        arguments.push_back(option);
    const auto json = runJson(arguments);
    EXPECT_EQ(json["dims"], OrderedJson({16, 16, 16}));
    EXPECT_EQ(json["spacing"], OrderedJson({1.0, 2.0, 0.5}));
    EXPECT_EQ(json["distinct_values"], runJson({"info", sphereVolume()})["distinct_values"]);
}

TEST_F(CliInfo, SkipsBytesAndSwapsThem) {
    folder_.write("big.raw", std::string("xx\x01\x02\x00\x03\x00\x04\x00\x05\x00\x06\x00\x07\x00\x08\x00\x09", 18));
    const auto json = runJson(
        {"info", path("big.raw"), "--raw-dims", "2,2,2", "--raw-type", "u16", "--raw-skip", "2", "--big-endian"});
    EXPECT_EQ(json["min"], 3.0);
    EXPECT_EQ(json["max"], 258.0);
}

TEST_F(CliInfo, RefusesARawFileOfAnotherSize) {
    folder_.write("short.raw", std::string(63, 'x'));
    folder_.write("long.raw", std::string(65, 'x'));
    const std::vector<std::string> layout{"--raw-dims", "4,4,4", "--raw-type", "u8"};
    const auto withLayout = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), layout.begin(), layout.end());
        return arguments;
    };
    expectRefusal(withLayout({"info", path("short.raw")}), 3, "63");
    expectRefusal(withLayout({"info", path("long.raw")}), 3, "65");
    EXPECT_EQ(run(withLayout({"info", path("long.raw"), "--allow-trailing"})).exitCode, 0);
}

TEST_F(CliInfo, TellsTheUnitOfLengthAndTheTitle) {
    folder_.write("a.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 2\n"
                            "units: \"micron\" \"micron\" \"micron\"\ncontent: a shell\nencoding: raw\n\n12345678");
    const auto json = runJson({"info", path("a.nrrd")});
    EXPECT_EQ(json["length_unit"], "µm");
    EXPECT_EQ(json["title"], "a shell");
    const auto text = run({"info", path("a.nrrd")}).standardOutput;
    EXPECT_THAT(text, HasSubstr("spacing          1 1 2 µm\n"));
    EXPECT_THAT(text, HasSubstr("title            a shell\n"));
    for (const char* kind : {"edges", "metacells"}) {
        run({"build", path("a.nrrd"), "-o", path("a.isx"), "--index", kind});
        EXPECT_EQ(runJson({"info", path("a.isx")})["length_unit"], "µm") << kind;
    }
    EXPECT_FALSE(runJson({"info", sphereVolume()}).contains("length_unit"));
}

TEST_F(CliInfo, NamesThePatientsDirectionsOfTheWorldsAxes) {
    const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspace: RAS\n"
                             "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n12345678";
    folder_.write("a.nrrd", nrrd);
    EXPECT_EQ(runJson({"info", path("a.nrrd")})["coordinates"], "LPS");
    EXPECT_THAT(run({"info", path("a.nrrd")}).standardOutput,
                HasSubstr("coordinates      LPS: x to the left, y to posterior, z to superior\n"));
    EXPECT_EQ(runJson({"extract", path("a.nrrd"), "--isovalue", "52"})["coordinates"], "LPS");
    ASSERT_EQ(run({"extract", path("a.nrrd"), "--isovalue", "52", "-o", path("a.ply")}).exitCode, 0);
    EXPECT_THAT(readText(path("a.ply")), HasSubstr("comment coordinates: LPS: x to the left"));
    for (const char* kind : {"edges", "metacells"}) {
        SCOPED_TRACE(kind);
        ASSERT_EQ(run({"build", path("a.nrrd"), "-o", path("a.isx"), "--index", kind}).exitCode, 0);
        EXPECT_EQ(runJson({"info", path("a.isx")})["coordinates"], "LPS");
        EXPECT_EQ(runJson({"extract", path("a.isx"), "--isovalue", "52"})["coordinates"], "LPS");
    }
    EXPECT_FALSE(runJson({"info", sphereVolume()}).contains("coordinates"));
    EXPECT_FALSE(runJson({"extract", sphereVolume(), "--isovalue", "5"}).contains("coordinates"));
}

TEST_F(CliInfo, ReadsEveryFrameOfASeries) {
    std::string samples(8 * 70, '\5');
    samples[8 * 69] = '\x63'; // in the last frame
    folder_.write("a.nrrd", "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 70\n"
                            "kinds: domain domain domain time\nencoding: raw\n\n" +
                                samples);
    const auto json = runJson({"info", path("a.nrrd")});
    EXPECT_EQ(json["parts"].size(), 70u);
    EXPECT_EQ(json["parts_in_all"], 70);
    EXPECT_EQ(json["min"], 5.0);
    EXPECT_EQ(json["max"], 99.0);
    EXPECT_FALSE(json.contains("notes"));
}

TEST_F(CliInfo, SaysWhichFramesOfVeryManyItRead) {
    folder_.write("a.nrrd", "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 5000\n"
                            "kinds: domain domain domain time\nencoding: raw\n\n" +
                                std::string(8 * 5000, '\5'));
    const auto json = runJson({"info", path("a.nrrd")});
    EXPECT_EQ(json["parts"].size(), 4096u);
    EXPECT_EQ(json["parts_in_all"], 5000);
    EXPECT_THAT(json["notes"].dump(), HasSubstr("the first 4096 of 5000"));
}

TEST_F(CliInfo, RefusesUnknownFilesInAShortLine) {
    folder_.write("a.xyzzy", "The quick brown fox\n");
    const auto result = run({"info", path("a.xyzzy")});
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_THAT(result.standardError, HasSubstr("a.xyzzy: is of no volume format that is known"));
    EXPECT_LT(result.standardError.size(), path("a.xyzzy").size() + 120);
}

TEST_F(CliInfo, RefusesGridsThatCannotBe) {
    folder_.write("a.raw", std::string(64, 'x'));
    for (const auto* dims :
         {"0,10,10", "-1,64,64", "65536,65537,1", "2097152,2097152,2097152", "4294967296,4294967296,1"})
        expectRefusal({"info", path("a.raw"), "--raw-dims", dims, "--raw-type", "u8"}, 3);
    expectRefusal({"info", path("a.raw"), "--raw-dims", "4,4", "--raw-type", "u8"}, 2);
    expectRefusal({"info", path("a.raw"), "--raw-dims", "4,4,4"}, 2, "--raw-type");
    expectRefusal({"info", path("a.raw"), "--raw-dims", "4,4,4", "--raw-type", "float128"}, 2, "u16");
}

TEST_F(CliInfo, RefusesWhatABuildLeftBehind) {
    const std::string said = "is a part of the index 'a.isx', not a volume";
    for (const char* name : {"a.isx.resume", "a.isx.partial", "a.isx.sort.partial", "a.isx.levels"}) {
        folder_.write(name, std::string(4096, 'x'));
        expectRefusal({"info", path(name)}, 3, said);
        expectRefusal({"info", path(name), "--raw-dims", "16,16,16", "--raw-type", "u8"}, 3, said);
        expectRefusal({"extract", path(name), "--isovalue", "1"}, 3, said);
        expectRefusal({"build", path(name), "-o", path("b.isx")}, 3, said);
    }
    expectRefusal({"info", path("b.isx.resume")}, 4, "b.isx.resume");
}

TEST_F(CliInfo, RefusesWhatIsNotThereOrNoVolume) {
    expectRefusal({"info", path("missing.mha")}, 4, "missing.mha");
    folder_.write("empty.mha", "");
    expectRefusal({"info", path("empty.mha")}, 3, "empty.mha");
    folder_.write("text.mha", "The quick brown fox\n");
    expectRefusal({"info", path("text.mha")}, 3, "text.mha");
    const auto whole = readText(sphereVolume());
    folder_.write("truncated.mha", whole.substr(0, whole.size() - 1));
    expectRefusal({"info", path("truncated.mha")}, 3, "truncated.mha");
    expectRefusal({"info", folder_.path().string()}, 3);
}

TEST_F(CliInfo, PrintsOneLineForANameWithALineBreak) { expectRefusal({"info", path("new\nline%s%n.mha")}, 4, "\\x0a"); }

TEST_F(CliInfo, KeepsAFieldsNameInItsLine) {
    folder_.write("a.vti",
                  "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">"
                  "<ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\">"
                  "<Piece Extent=\"0 1 0 1 0 1\"><PointData>"
                  "<DataArray type=\"UInt8\" Name=\"a&#10;&#127;b\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray>"
                  "</PointData></Piece></ImageData></VTKFile>");
    const auto result = run({"info", path("a.vti")});
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    EXPECT_THAT(result.standardOutput, HasSubstr("field            a  b\n"));
}

TEST_F(CliInfo, KnowsAnIndexByItsContent) {
    std::filesystem::rename(sphereIndex(), path("renamed.mha"));
    EXPECT_EQ(runJson({"info", path("renamed.mha")})["format"], "ISOSLIDER index");
}

TEST_F(CliInfo, RefusesABrokenIndexAsAnIndex) {
    folder_.write("text.isx", "The quick brown fox jumps over the lazy dog, and that is no index.\n");
    expectRefusal({"info", path("text.isx")}, 3, "index");
    runJson({"build", sphereVolume(), "-o", path("whole.isx"), "--no-topology"});
    const auto whole = readText(path("whole.isx"));
    folder_.write("head.isx", whole.substr(0, 40));
    expectRefusal({"info", path("head.isx")}, 3, "head.isx");
    folder_.write("cut.isx", whole.substr(0, whole.size() - 1));
    expectRefusal({"info", path("cut.isx")}, 3, "cut.isx");
}

} // namespace isoslider::test
