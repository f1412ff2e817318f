// B097 to B103: what is typed.

#include <csignal>
#include <filesystem>

#include <fmt/format.h>

#include "tests/bad_inputs/bad_input_fixture.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BadCommand : public BadInputTest {};

TEST_F(BadCommand, B097_IsovaluesThatAreNone) {
    const auto volume = sphereVolume();
    for (const auto* text : {"nan", "inf", "-inf", "1e999", "", "1,5", "0x10"})
        expectRefusedSoon({"extract", volume, "--isovalue", text}, "--isovalue", 2);
    for (const auto* text : {"-1e300", "1e300", "1000"})
        EXPECT_EQ(expectAcceptedSoon({"extract", volume, "--isovalue", text})["triangles"], 0) << text;
    expectRefusedSoon({"slide", sphereIndex(), "--path", "1,nan,2"}, "--path", 2);
}

TEST_F(BadCommand, B098_IsovalueAtEverySample) {
    std::string samples;
    unsigned state = 1;
    for (int i = 0; i < 12 * 12 * 12; ++i) {
        state = state * 1664525u + 1013904223u;
        samples.push_back(static_cast<char>(i < 256 ? i : static_cast<int>(state >> 24)));
    }
    const auto volume = raw("a.raw", samples, "12,12,12", "u8");
    ASSERT_EQ(expectAcceptedSoon(joined({"info"}, volume))["distinct_values"], 256);
    ASSERT_EQ(run(joined(joined({"build"}, volume), {"-o", path("a.isx")})).exitCode, 0);
    std::string all = "0";
    for (int isovalue = 1; isovalue < 256; ++isovalue)
        all += fmt::format(",{}", isovalue);
    // Ends with 1 when the certificate of any step finds a fault.
    const auto slid = run({"slide", path("a.isx"), "--path", all, "--export", path("s_%03d.off"), "--json"});
    ASSERT_EQ(slid.exitCode, 0) << slid.standardError;
    const auto steps = OrderedJson::parse(slid.standardOutput)["steps"];
    for (const int isovalue : {0, 1, 100, 254, 255}) {
        const auto fresh = expectAcceptedSoon(joined(joined({"extract"}, volume), {"--isovalue", std::to_string(isovalue)}));
        EXPECT_EQ(fresh["triangles"], steps[static_cast<std::size_t>(isovalue)]["triangles"]) << isovalue;
        EXPECT_EQ(fresh["manifold"], true);
    }
}

TEST_F(BadCommand, B099_OutputsInTheWay) {
    const auto volume = sphereVolume();
    const std::string before = readText(volume);
    fs::create_directory(path("folder.ply"));
    fs::copy_file(volume, path("volume.ply"));
    fs::create_symlink(volume, path("link.ply"));
    expectRefusedSoon({"extract", volume, "--isovalue", "5", "-o", path("link.ply")}, "is the input", 2);
    expectRefusedSoon({"extract", volume, "--isovalue", "5", "-o", path("folder.ply")}, "directory", 4);
    expectRefusedSoon({"extract", volume, "--isovalue", "5", "-o", path("none/a.ply")}, "folder", 4);
    expectRefusedSoon({"build", volume, "-o", volume}, "input", 2);
    expectRefusedSoon({"build", volume, "-o", path("folder.ply")}, "directory", 4);
    EXPECT_TRUE(readText(volume) == before);
    // A file that is there is replaced whole, and only by a result.
    folder_.write("old.ply", "what was here");
    expectRefusedSoon({"extract", path("none.mha"), "--isovalue", "5", "-o", path("old.ply")}, "none.mha", 4);
    EXPECT_EQ(readText(path("old.ply")), "what was here");
}

class BadSignal : public BadCommand, public ::testing::WithParamInterface<int> {};

TEST_P(BadSignal, B100_EndsWithinASecondAndLeavesNothing) {
    const auto volume = BadInputTest::noiseVolume(128);
    ProcessOptions options;
    options.timeout = std::chrono::seconds(50);
    options.signalToSend = GetParam();
    std::chrono::steady_clock::time_point sent;
    options.signalWhen = [&] {
        sent = std::chrono::steady_clock::now();
        return folder_.names().size() > 1;
    };
    const auto result = run({"build", volume, "-o", path("a.isx"), "--index", "edges", "--memory", "64M"}, options);
    EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(5));
    EXPECT_EQ(result.exitCode, 130) << result.standardError;
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"noise.mha"});
}

INSTANTIATE_TEST_SUITE_P(Signals, BadSignal, ::testing::Values(SIGINT, SIGTERM, SIGHUP));

TEST_F(BadCommand, B100_NobodyReads) {
    ProcessOptions options;
    options.closesStandardOutput = true;
    const auto result = run({"slide", sphereIndex(), "--path", "1,2,3,4,5,6,7,8"}, options);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 0) << result.standardError;
}

TEST_F(BadCommand, B101_OtherLocales) {
    const auto volume = sphereVolume();
    std::vector<std::string> outputs, meshes;
    for (const auto* locale : {"C", "de_DE.UTF-8", "tr_TR.UTF-8"}) {
        ProcessOptions options;
        options.environment = {{"LC_ALL", locale}, {"LANG", locale}};
        outputs.push_back(run({"info", volume, "--json"}, options).standardOutput);
        EXPECT_EQ(run({"extract", volume, "--isovalue", "4.25", "-o", path("a.obj")}, options).exitCode, 0);
        meshes.push_back(readText(path("a.obj")));
    }
    for (std::size_t i = 1; i < outputs.size(); ++i) {
        EXPECT_EQ(outputs[i], outputs[0]);
        EXPECT_TRUE(meshes[i] == meshes[0]);
    }
}

TEST_F(BadCommand, B102_ManyIsovalues) {
    const auto index = sphereIndex();
    std::string some = "9,8.5,8.5,3,-4,3";
    const auto few = run({"slide", index, "--path", some, "--json"});
    ASSERT_EQ(few.exitCode, 0) << few.standardError;
    const auto steps = OrderedJson::parse(few.standardOutput)["steps"];
    for (const auto& step : steps) {
        const auto fresh = expectAcceptedSoon({"extract", index, "--isovalue", step["isovalue"].dump()});
        EXPECT_EQ(step["triangles"], fresh["triangles"]);
    }
    ProcessOptions options;
    options.timeout = std::chrono::minutes(2);
    const auto many = run({"slide", index, "--from", "9", "--to", "-3", "--steps", "100000", "--json"}, options);
    ASSERT_EQ(many.exitCode, 0) << many.standardError;
    EXPECT_EQ(OrderedJson::parse(many.standardOutput)["steps"].size(), 100001u);
#if !defined(__SANITIZE_ADDRESS__)
    EXPECT_LT(many.peakRssBytes, few.peakRssBytes + (std::uint64_t{256} << 20)); // of text that is printed at once
#endif
}

TEST_F(BadCommand, B103_EmptyMeshes) {
    const auto volume = sphereVolume();
    for (const auto* suffix : {"ply", "obj", "stl", "off", "om"}) {
        const auto out = path(std::string("empty.") + suffix);
        EXPECT_EQ(expectAcceptedSoon({"extract", volume, "--isovalue", "99", "-o", out})["triangles"], 0) << suffix;
        EXPECT_EQ(expectAcceptedSoon({"check", out})["triangles"], 0) << suffix;
    }
}

} // namespace
} // namespace isoslider::test
