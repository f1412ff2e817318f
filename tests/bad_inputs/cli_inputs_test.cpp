// B097 to B103: what is typed.

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/bad_inputs/bad_input_fixture.h"
#include "tests/support/sanitizers.h"
#include "tests/support/slab_oracle.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BadCommand : public BadInputTest {
protected:
    /// Where the locale is: made here, for few machines have it. Empty where that cannot be done.
    static std::string localeFolder(const std::string& name) {
        static const TemporaryFolder folder;
        const auto place = (folder / name).string();
        if (name != "C" && !fs::exists(place)) {
            const auto made =
                runProcess("/usr/bin/env", {"localedef", "-i", name.substr(0, name.find('.')), "-f", "UTF-8", place});
            if (made.exitCode != 0)
                std::printf("%s cannot be made here: %s\n", name.c_str(), made.standardError.c_str());
        }
        return fs::exists(place) ? folder.path().string() : "";
    }
};

TEST_F(BadCommand, B097_IsovaluesThatAreNone) {
    const auto volume = sphereVolume();
    for (const auto* text : {"nan", "inf", "-inf", "1e999", "", "1,5", "0x10"})
        expectRefusedSoon({"extract", volume, "--isovalue", text}, "--isovalue", 2);
    for (const auto* text : {"-1e300", "1e300", "1000"})
        EXPECT_EQ(expectAcceptedSoon({"extract", volume, "--isovalue", text})["triangles"], 0) << text;
    const auto index = sphereIndex();
    for (const auto* text : {"1,nan,2", "", ",", "1,,2", "1;2", "inf", "1,1e999", " 1"})
        expectRefusedSoon({"slide", index, "--path", text}, "--path", 2);
    for (const auto* text : {"nan", "inf", "-inf", "1e999", "", "1,5", "0x10", "5 ", "1e", "--5", "5f", "1e-400"}) {
        expectRefusedSoon({"extract", index, "--isovalue", text}, "--isovalue", 2);
        expectRefusedSoon({"slide", index, "--from", text, "--to", "2", "--steps", "3"}, "--from", 2);
        expectRefusedSoon({"slide", index, "--from", "1", "--to", text, "--steps", "3"}, "--to", 2);
    }
    for (const auto* text : {"-1e300", "1.7976931348623157e308", "1000"})
        EXPECT_EQ(expectAcceptedSoon({"extract", index, "--isovalue", text})["triangles"], 0) << text;
    EXPECT_GT(expectAcceptedSoon({"extract", index, "--isovalue", "5e-324"})["triangles"], 0);
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
        const auto fresh =
            expectAcceptedSoon(joined(joined({"extract"}, volume), {"--isovalue", std::to_string(isovalue)}));
        EXPECT_EQ(fresh["triangles"], steps[static_cast<std::size_t>(isovalue)]["triangles"]) << isovalue;
        EXPECT_EQ(fresh["manifold"], true);
    }
    // What the oracle counts, of each surface that was written. Few enough cells for it to judge them all.
    std::vector<double> scalars;
    for (const char sample : samples)
        scalars.push_back(static_cast<unsigned char>(sample));
    for (int isovalue = 0; isovalue < 256; ++isovalue) {
        const auto expected = sweepGrid(scalars, {12, 12, 12}, isovalue);
        EXPECT_EQ(steps[static_cast<std::size_t>(isovalue)]["active_edges"], expected.activeEdges) << isovalue;
        if (isovalue % 15 != 0) // both ends among them
            continue;
        const auto mesh = expectAcceptedSoon({"check", path(fmt::format("s_{:03}.off", isovalue))});
        EXPECT_EQ(mesh["components"], expected.components) << isovalue;
        EXPECT_EQ(mesh["euler"], expected.euler) << isovalue;
        EXPECT_EQ(mesh["boundary_loops"], expected.loops) << isovalue;
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
    folder_.write("old.ply", std::string(1'000'000, 'x'));
    fs::permissions(path("old.ply"), fs::perms::owner_read);
    ASSERT_EQ(run({"extract", volume, "--isovalue", "5", "-o", path("new.ply")}).exitCode, 0);
    ASSERT_EQ(run({"extract", volume, "--isovalue", "5", "-o", path("old.ply")}).exitCode, 0);
    EXPECT_TRUE(readText(path("old.ply")) == readText(path("new.ply"))) << "nothing of the longer file is left";
    folder_.write("old.isx", std::string(1'000'000, 'x'));
    ASSERT_EQ(run({"build", volume, "-o", path("old.isx")}).exitCode, 0);
    EXPECT_EQ(expectAcceptedSoon({"stats", path("old.isx")})["kind"], "metacells");
}

TEST_F(BadCommand, B099_OutputsThatAreInputsUnderAnotherName) {
    const std::string samples = readText(rawSphere("data.raw"));
    const std::string header = metaImage(16, "MET_FLOAT", "");
    folder_.write("a.mhd", header.substr(0, header.find("LOCAL")) + "data.raw\n");
    expectRefusedSoon({"build", path("a.mhd"), "-o", path("data.raw")}, "is the input", 2);
    expectRefusedSoon({"build", path("a.mhd"), "-o", path("./a.mhd")}, "is the input", 2);
    EXPECT_TRUE(readText(path("data.raw")) == samples);
    // A later step's name would be the index.
    const std::string index = sphereIndex("s_2.ply");
    const std::string bytes = readText(index);
    expectRefusedSoon({"slide", index, "--path", "1,2,3,4", "--export", path("s_%d.ply")}, "is the input", 2);
    EXPECT_FALSE(fs::exists(path("s_0.ply")));
    EXPECT_TRUE(readText(index) == bytes);
    expectRefusedSoon({"slide", index, "--path", "1", "--export", path("none/s_%d.ply")}, "folder", 4);
    fs::create_directory(path("t_0.ply"));
    expectRefusedSoon({"slide", index, "--path", "1", "--export", path("t_%d.ply")}, "directory", 4);
    fs::create_directory(path("folder.mha"));
    for (const auto& [output, says, code] :
         {std::tuple(path("a.mhd"), "is the input", 2), std::tuple(path("folder.mha"), "directory", 4),
          std::tuple(path("none/b.mha"), "folder", 4), std::tuple(path("b.nrrd"), ".mha", 2)})
        expectRefusedSoon({"resample", path("a.mhd"), "-o", output, "--size", "4,4,4"}, says, code);
    EXPECT_FALSE(fs::exists(path("b.mha")));
}

TEST_F(BadCommand, B099_OutputsThatAreLinks) {
    // Written where the link leads, and the link stays one.
    fs::create_directory(path("there"));
    folder_.write("there/old", "what was here");
    for (const auto* name : {"link.ply", "link.isx"})
        fs::create_symlink("there/old", path(name));
    fs::create_symlink("there/new", path("dangling.ply"));
    const auto volume = sphereVolume();
    ASSERT_EQ(run({"extract", volume, "--isovalue", "5", "-o", path("plain.ply")}).exitCode, 0);
    for (const auto* name : {"link.ply", "dangling.ply"}) {
        const auto made = run({"extract", volume, "--isovalue", "5", "-o", path(name)});
        EXPECT_EQ(made.exitCode, 0) << made.standardError;
        EXPECT_TRUE(fs::is_symlink(path(name))) << name;
        EXPECT_TRUE(readText(path(name)) == readText(path("plain.ply"))) << name;
    }
    ASSERT_EQ(run({"build", volume, "-o", path("link.isx")}).exitCode, 0);
    EXPECT_TRUE(fs::is_symlink(path("link.isx")));
    EXPECT_EQ(expectAcceptedSoon({"stats", path("there/old")})["kind"], "metacells");
    EXPECT_EQ(std::distance(fs::directory_iterator(path("there")), {}), 2);
    fs::create_symlink("circle.ply", path("circle.ply"));
    expectRefusedSoon({"extract", volume, "--isovalue", "5", "-o", path("circle.ply")}, "circle.ply", 4);
}

TEST_F(BadCommand, B088_B099_WithoutPermission) {
    const auto index = sphereIndex();
    const auto volume = sphereVolume();
    const auto secret = sphereVolume("secret.mha");
    fs::create_directory(path("locked"));
    fs::copy_file(index, path("locked/a.isx"));
    for (const auto* name : {"", "locked", "sphere.isx", "sphere.mha", "locked/a.isx"})
        fs::permissions(path(name), fs::perms(0555));
    fs::permissions(secret, fs::perms::none);
    ProcessOptions nobody;
    nobody.userId = 65534;
    if (run({"--version"}, nobody).exitCode != 0)
        GTEST_SKIP() << "the program cannot be run by another user here";
    // As on a medium that is read-only: reading works, writing is refused before anything else.
    for (const auto& words : {std::vector<std::string>{"stats", path("locked/a.isx")},
                              {"extract", path("locked/a.isx"), "--isovalue", "5"},
                              {"slide", path("locked/a.isx"), "--path", "5,3"},
                              {"info", volume}})
        EXPECT_EQ(run(words, nobody).exitCode, 0) << words[0];
    for (const auto& words : {std::vector<std::string>{"build", volume, "-o", path("locked/b.isx")},
                              {"build", volume, "-o", path("locked/a.isx")},
                              {"extract", volume, "--isovalue", "5", "-o", path("locked/b.ply")},
                              {"resample", volume, "-o", path("locked/b.mha"), "--size", "4,4,4"},
                              {"slide", path("locked/a.isx"), "--path", "5", "--export", path("locked/b_%d.ply")}}) {
        const auto result = run(words, nobody);
        EXPECT_EQ(result.exitCode, 4) << words[0] << result.standardError;
        EXPECT_THAT(result.standardError, HasSubstr("may not be written to"));
    }
    for (const auto& words : {std::vector<std::string>{"info", secret}, {"extract", secret, "--isovalue", "5"}}) {
        const auto result = run(words, nobody);
        EXPECT_EQ(result.exitCode, 4) << result.standardError;
        EXPECT_THAT(result.standardError, HasSubstr("Permission denied"));
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(path("locked")), {}), 1);
    fs::permissions(folder_.path(), fs::perms::owner_all);
    fs::permissions(path("locked"), fs::perms::owner_all);
}

class BadSignal : public BadCommand {
protected:
    /// u8 noise: a surface of millions of triangles.
    std::vector<std::string> roughVolume() const {
        const int side = test::kHasSanitizers ? 64 : 112; // some seconds of work
        std::string samples(static_cast<std::size_t>(side) * side * side, '\0');
        unsigned state = 7;
        for (char& sample : samples) {
            state = state * 1664525u + 1013904223u;
            sample = static_cast<char>(state >> 24);
        }
        return raw("rough.raw", samples, fmt::format("{0},{0},{0}", side), "u8");
    }
    /// Sends each signal when its moment has come; the program has to end within a second of it, and leave nothing.
    void expectEnds(const std::vector<std::string>& words,
                    const std::function<bool(int signal, std::chrono::milliseconds)>& isTime) const {
        const auto names = folder_.names();
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
            SCOPED_TRACE(fmt::format("{}, signal {}", fmt::join(words, " "), signal));
            ProcessOptions options;
            options.timeout = std::chrono::seconds(100);
            options.signalToSend = signal;
            const auto begin = std::chrono::steady_clock::now();
            std::chrono::milliseconds sent{0};
            options.signalWhen = [&] {
                sent = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
                return isTime(signal, sent);
            };
            const auto result = run(words, options);
            EXPECT_EQ(result.exitCode, 130) << result.signal << ' ' << result.standardError;
            EXPECT_EQ(result.standardError, "isoslider-cli: interrupted\n");
            EXPECT_EQ(result.standardOutput, "");
            EXPECT_EQ(folder_.names(), names);
            // Where other programs keep the machine busy it takes as much longer as all else.
            EXPECT_LT(result.elapsed - sent, std::chrono::milliseconds(3000));
        }
    }
    /// At another moment for each signal.
    static bool isLater(int signal, std::chrono::milliseconds time, int first, int each) {
#if ISO_HAS_SANITIZER
        first += 2000; // it starts slowly
#endif
        return time.count() >= first + each * (signal == SIGINT ? 0 : signal == SIGTERM ? 1 : 2);
    }
};

TEST_F(BadSignal, B100_EndsABuild) {
    const auto volume = BadInputTest::noiseVolume(128);
    for (const auto* kind : {"edges", "metacells"})
        expectEnds({"build", volume, "-o", path("a.isx"), "--index", kind, "--memory", "64M"},
                   [&](int, auto) { return fs::exists(path("a.isx.partial")); });
}

TEST_F(BadSignal, B100_EndsAnExtraction) {
    expectEnds(joined(joined({"extract"}, roughVolume()), {"--isovalue", "127.5", "-o", path("a.off")}),
               [](int signal, auto time) { return isLater(signal, time, 300, 500); });
}

TEST_F(BadSignal, B100_EndsACheck) {
    ASSERT_EQ(run(joined(joined({"extract"}, roughVolume()), {"--isovalue", "127.5", "-o", path("rough.off")}),
                  {.timeout = std::chrono::seconds(60)})
                  .exitCode,
              0);
    expectEnds({"check", path("rough.off")}, [](int signal, auto time) { return isLater(signal, time, 500, 400); });
}

TEST_F(BadSignal, B100_EndsASlide) {
    expectEnds({"slide", sphereIndex(), "--from", "1", "--to", "9", "--steps", "5000000", "--json"},
               [](int signal, auto time) { return isLater(signal, time, 500, 200); });
}

TEST_F(BadCommand, B100_NobodyReads) {
    ProcessOptions options;
    options.closesStandardOutput = true;
    const auto result = run({"slide", sphereIndex(), "--path", "1,2,3,4,5,6,7,8"}, options);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 0) << result.standardError;
}

TEST_F(BadCommand, B101_OtherLocales) {
#if ISO_HAS_SANITIZER
    GTEST_SKIP() << "the C library keeps what it makes of LOCPATH, which is taken for a leak";
#endif
    const auto volume = sphereVolume();
    // Numbers as text, in a format of ours and in two that libraries read.
    folder_.write("a.nrrd",
                  "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nspacings: 0.5 1.25 1e-1\nencoding: ascii\n\n"
                  "0.5 1.5 2.25 3e-1 4.125 5 6 7\n");
    folder_.write(
        "a.vtk",
        "# vtk DataFile Version 3.0\nTITLE\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 3 2 2\nX_COORDINATES 3 float\n"
        "0.5 1.25 4.5\nY_COORDINATES 2 float\n0 1.5\nZ_COORDINATES 2 float\n0 1\nPOINT_DATA 12\n"
        "SCALARS INTENSITY float\nLOOKUP_TABLE default\n0.5 1 4 10 11 14.25 100 101 104 110 111 114\n");
    std::vector<std::string> all;
    for (const auto* locale : {"C", "de_DE.UTF-8", "tr_TR.UTF-8"}) {
        ProcessOptions options;
        options.environment = {{"LC_ALL", locale}, {"LANG", locale}, {"LOCPATH", localeFolder(locale)}};
        std::string output;
        for (const auto& words : {std::vector<std::string>{"info", volume, "--json"},
                                  {"info", path("a.nrrd"), "--json"},
                                  {"info", path("a.vtk"), "--json"},
                                  {"extract", volume, "--isovalue", "4.25", "-o", path("a.obj")},
                                  {"extract", path("a.vtk"), "--isovalue", "12.5", "--json"},
                                  {"check", path("a.obj"), "--json"},
                                  {"build", volume, "-o", path("a.isx")},
                                  {"stats", path("a.isx"), "--json"},
                                  {"extract", path("a.isx"), "--isovalue", "4.25", "-o", path("a.ply")},
                                  {"resample", path("a.vtk"), "-o", path("a.mha"), "--size", "4,4,4"}}) {
            const auto result = run(words, options);
            EXPECT_EQ(result.exitCode, 0) << locale << ' ' << words[0] << ' ' << result.standardError;
            output += words[0] == "build" ? "" : result.standardOutput; // its seconds differ
        }
        for (const auto& words : {std::vector<std::string>{"extract", volume, "--isovalue", "1,5"},
                                  {"info", path("none.mha")},
                                  {"INFO", volume},
                                  {"extract", volume, "--ISOVALUE", "1"}})
            output += run(words, options).standardError;
        for (const auto* name : {"a.obj", "a.ply", "a.isx", "a.mha"})
            output += readText(path(name));
        all.push_back(output);
    }
    EXPECT_TRUE(all[1] == all[0]) << "de_DE";
    EXPECT_TRUE(all[2] == all[0]) << "tr_TR";
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
    const std::size_t count = 100'000 / test::kSparser;
    const auto many =
        run({"slide", index, "--from", "9", "--to", "-3", "--steps", std::to_string(count), "--json"}, options);
    ASSERT_EQ(many.exitCode, 0) << many.standardError;
    std::vector<OrderedJson> picked;
    {
        const auto all = OrderedJson::parse(many.standardOutput)["steps"];
        ASSERT_EQ(all.size(), count + 1);
        for (const std::size_t step : {std::size_t{0}, std::size_t{1}, count / 3, count / 2, count - 1, count})
            picked.push_back(all[step]);
    }
    for (const auto& step : picked) {
        const auto alone = expectAcceptedSoon({"extract", index, "--isovalue", step["isovalue"].dump()});
        for (const auto* key : {"triangles", "active_edges"})
            EXPECT_EQ(step[key], alone[key]) << step;
    }
    // Records that are printed as they come need no memory.
    const auto lines = run({"slide", index, "--from", "9", "--to", "-3", "--steps", std::to_string(count)}, options);
    EXPECT_EQ(std::count(lines.standardOutput.begin(), lines.standardOutput.end(), '\n'),
              static_cast<std::ptrdiff_t>(count + 2));
#if !ISO_HAS_SANITIZER
    EXPECT_LT(lines.peakRssBytes, few.peakRssBytes + (std::uint64_t{16} << 20));
#endif
    // As many as one argument holds, some of them twice, down and up.
    std::string stops = "3";
    for (int i = 0; i < 20'000 / static_cast<int>(test::kSparser); ++i)
        stops += fmt::format(",{}", i % 7 == 0 ? 3 : (i * 5 + i / 1000) % 13 - 3);
    const auto listed = run({"slide", index, "--path", stops, "--json"}, options);
    ASSERT_EQ(listed.exitCode, 0) << listed.standardError;
    std::map<double, std::pair<OrderedJson, OrderedJson>> found;
    const auto listedSteps = OrderedJson::parse(listed.standardOutput)["steps"];
    for (const auto& step : listedSteps) {
        const auto counts = std::pair(step["triangles"], step["active_edges"]);
        EXPECT_EQ(found.try_emplace(step["isovalue"].get<double>(), counts).first->second, counts) << step;
    }
    EXPECT_EQ(found.size(), 13u);
    for (const auto& [isovalue, counts] : found)
        EXPECT_EQ(expectAcceptedSoon({"extract", index, "--isovalue", fmt::format("{}", isovalue)})["triangles"],
                  counts.first)
            << isovalue;
#if !ISO_HAS_SANITIZER
    EXPECT_LT(many.peakRssBytes, few.peakRssBytes + (std::uint64_t{256} << 20)); // of text that is printed at once
#endif
}

TEST_F(BadCommand, B103_EmptyMeshes) {
    const auto volume = sphereVolume();
    for (const auto* suffix : {"ply", "obj", "stl", "off", "om"}) {
        const auto out = path(std::string("empty.") + suffix);
        EXPECT_EQ(expectAcceptedSoon({"extract", volume, "--isovalue", "99", "-o", out})["triangles"], 0) << suffix;
        const auto checked = expectAcceptedSoon({"check", out});
        for (const auto* key : {"triangles", "vertices", "components", "boundary_loops"})
            EXPECT_EQ(checked[key], 0) << suffix << ' ' << key;
    }
    EXPECT_EQ(run({"slide", sphereIndex(), "--path", "99,-99", "--export", path("none_%d.ply")}).exitCode, 0);
    for (const auto* name : {"none_0.ply", "none_1.ply"})
        EXPECT_EQ(expectAcceptedSoon({"check", path(name)})["triangles"], 0) << name;
    // Meshes beyond what formats can number: mesh_export_test.
}

} // namespace
} // namespace isoslider::test
