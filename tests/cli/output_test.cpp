#include "tests/cli/cli_fixture.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {

using ::testing::HasSubstr;

class CliOutput : public CliTest {
protected:
    /// Expects that no command replaces `data`, which `volume` is read from, under any of its names.
    void expectKept(const std::string& volume, const std::string& data) const {
        const std::string before = readText(data);
        const auto linkTo = [&](const std::string& name, bool isHard) {
            std::filesystem::remove(path(name));
            if (isHard)
                std::filesystem::create_hard_link(data, path(name));
            else
                std::filesystem::create_symlink(data, path(name));
            return path(name);
        };
        constexpr std::string_view kSaying = "is the input; choose another output";
        for (const bool isHard : {false, true}) {
            expectRefusal({"extract", volume, "--isovalue", "5", "-o", linkTo("a.ply", isHard)}, 2, kSaying);
            expectRefusal({"build", volume, "-o", linkTo("a.isx", isHard)}, 2, kSaying);
            expectRefusal({"resample", volume, "-o", linkTo("a.mha", isHard)}, 2, kSaying);
            expectRefusal({"report", sphereVolume(), volume, "--steps", "1", "-o", linkTo("a.md", isHard)}, 2, kSaying);
        }
        std::filesystem::remove(path("a.md"));
        linkTo("a_steps.svg", false);
        expectRefusal({"report", volume, "--steps", "1", "-o", path("a.md")}, 2, kSaying);
        std::filesystem::remove(path("a_steps.svg"));
        EXPECT_EQ(readText(data), before);
    }

    /// A header whose samples lie in a separate file.
    std::string detachedSphere(const std::string& header, const std::string& data) const {
        rawSphere(data);
        return folder_
            .write(header, "ObjectType = Image\nNDims = 3\nDimSize = 16 16 16\nElementType = MET_FLOAT\n"
                           "ElementDataFile = " +
                               data + "\n")
            .string();
    }
};

TEST_F(CliOutput, NeverReplacesTheDataFileOfAHeader) {
    const auto volume = detachedSphere("detached.mhd", "data.ply");
    expectKept(volume, path("data.ply"));
    const auto before = readText(path("data.ply"));
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("data.ply")}, 2, "data.ply: is the input");
    EXPECT_EQ(readText(path("data.ply")), before);
    const auto other = detachedSphere("other.mhd", "data.md");
    expectRefusal({"report", other, "--steps", "1", "-o", path("data.md")}, 2, "data.md: is the input");
    EXPECT_EQ(readText(path("data.md")), before);
}

TEST_F(CliOutput, NeverReplacesOneOfSeveralDataFiles) {
    const std::string samples = readText(rawSphere());
    folder_.write("low.raw", samples.substr(0, samples.size() / 2));
    folder_.write("high.raw", samples.substr(samples.size() / 2));
    const auto volume = folder_.write("split.nhdr", "NRRD0004\ntype: float\ndimension: 3\nsizes: 16 16 16\n"
                                                    "endian: little\nencoding: raw\ndata file: LIST\n"
                                                    "low.raw\nhigh.raw\n");
    expectKept(volume, path("low.raw"));
    expectKept(volume, path("high.raw"));
}

TEST_F(CliOutput, NeverReplacesASliceOfAFolder) {
    std::filesystem::create_directory(path("series"));
    const auto slice = std::filesystem::path(test::sourceFolder()) / "tests/fuzz/seeds/tiff/bits.tif";
    for (const auto* name : {"series/1.tif", "series/2.tif"})
        std::filesystem::copy_file(slice, path(name));
    expectKept(path("series"), path("series/2.tif"));
}

// Outputs are written beside their place first.
TEST_F(CliOutput, NeverReplacesTheInputByAnUnfinishedOutput) {
    const auto volume = detachedSphere("detached.mhd", "a.ply.partial");
    const auto before = readText(path("a.ply.partial"));
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("a.ply")}, 2, "a.ply.partial' first, which is");
    std::filesystem::rename(sphereVolume(), path("sphere.isx.partial"));
    expectRefusal({"build", path("sphere.isx.partial"), "-o", path("sphere.isx")}, 2, "first, which is the input");
    EXPECT_EQ(readText(path("a.ply.partial")), before);
    EXPECT_TRUE(std::filesystem::exists(path("sphere.isx.partial")));
}

TEST_F(CliOutput, NeverTakesTheNameOfAPartOfAnIndex) {
    for (const char* name : {"a.isx.resume", "a.isx.partial", "a.isx.levels"}) {
        expectRefusal({"build", sphereVolume(), "-o", path(name)}, 2, "has the name of a part of the index 'a.isx'");
        EXPECT_FALSE(std::filesystem::exists(path(name)));
    }
}

// It may be what the page would replace, if it could be opened.
TEST_F(CliOutput, KeepsAPageWhereAVolumeCannotBeOpened) {
    const auto volume = detachedSphere("short.mhd", "page.md");
    folder_.write("page.md", "too short");
    expectRefusal({"report", sphereVolume(), volume, "--steps", "1", "-o", path("page.md")}, 3, "data ends early");
    EXPECT_EQ(readText(path("page.md")), "too short");
}

TEST_F(CliOutput, EndsQuietlyWhenNobodyReads) {
    const auto index = sphereIndex();
    ProcessOptions options;
    options.closesStandardOutput = true;
    for (const auto& arguments :
         {std::vector<std::string>{"info", index}, {"slide", index, "--from", "1", "--to", "9", "--steps", "5000"}}) {
        const auto result = run(arguments, options);
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        EXPECT_EQ(result.standardError, "");
    }
}

TEST_F(CliOutput, StillExportsWhenNobodyReads) {
    ProcessOptions options;
    options.closesStandardOutput = true;
    const auto result = run({"slide", sphereIndex(), "--path", "3,4,5", "--export", "out_%d.off"}, options);
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_TRUE(std::filesystem::exists(path("out_2.off")));
}

TEST_F(CliOutput, SaysWhenTheDiskBehindItIsFull) {
    ProcessOptions options;
    options.standardOutputFile = "/dev/full";
    const auto result = run({"info", sphereVolume()}, options);
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_EQ(result.standardError, "isoslider-cli: standard output: cannot write: No space left on device\n");
    for (const std::vector<std::string>& question :
         {std::vector<std::string>{"--help"}, {"--version"}, {"info", "--help"}, {"build", "-h"}}) {
        const auto answer = run(question, options);
        EXPECT_EQ(answer.exitCode, 4) << question[0];
        EXPECT_EQ(answer.standardError, result.standardError);
    }
}

TEST_F(CliOutput, NeedsAName) {
    const auto volume = sphereVolume();
    for (const std::vector<std::string>& command : {std::vector<std::string>{"build", volume},
                                                    {"extract", volume, "--isovalue", "5"},
                                                    {"resample", volume},
                                                    {"report", volume}}) {
        auto arguments = command;
        arguments.insert(arguments.end(), {"-o", ""});
        expectRefusal(arguments, 2, "the output has no name");
        arguments.pop_back();
        arguments.back() = "--output=";
        expectRefusal(arguments, 2);
    }
    expectRefusal({"report", volume, "--folder", ""}, 2, "the folder has no name");
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"sphere.mha"});
}

TEST_F(CliOutput, CountsOneThingInTheSingular) {
    const auto saidBy = [&](const std::vector<std::string>& arguments) {
        const auto result = run(arguments);
        return result.standardOutput + result.standardError;
    };
    const auto volume = sphereVolume(), index = path("a.isx");
    EXPECT_THAT(saidBy({"build", volume, "-o", index, "--skip-levels", "1"}), HasSubstr(", 1 skip level\n"));
    const auto same = folder_.write("same.mha", metaImage(4, "MET_UCHAR", std::string(64, 'a'))).string();
    EXPECT_THAT(saidBy({"build", same, "-o", path("same.isx")}), HasSubstr("metacells, 1 distinct value, "));
    EXPECT_THAT(saidBy({"topology", index, "--at", "5"}), HasSubstr("1 piece, 0 tunnels, "));
    std::string dot(64, '\0');
    dot[21] = 'a';
    const auto point = folder_.write("point.mha", metaImage(4, "MET_UCHAR", dot)).string();
    EXPECT_THAT(saidBy({"topology", point, "--between", "1", "200"}),
                HasSubstr("1 event: pieces come 0 times, go 1 time,"));
    EXPECT_THAT(saidBy({"extract", volume, "--isovalue", "5", "--lod-error", "1c"}), HasSubstr("within 1 cell, of"));
    EXPECT_THAT(saidBy({"extract", volume, "--isovalue", "5", "--component", "9"}), HasSubstr("has component 0 only"));
    const auto merged = edgesIndex("merged.isx", {"--lod-error", "1c"});
    EXPECT_THAT(saidBy({"stats", merged}), HasSubstr("error                 1 cell\n"));
    EXPECT_THAT(saidBy({"report", volume, "--steps", "1", "--index", "metacells", "-o", path("page.md")}),
                HasSubstr("page.md: 1 volume\n"));
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_THAT(saidBy({"check", folder_.write("flat.obj", corners + "f 1 1 2\n").string()}),
                HasSubstr("1 degenerate triangle\n"));
    EXPECT_THAT(saidBy({"check", folder_.write("twice.obj", corners + "f 1 2 3\nf 1 2 3\n").string()}),
                HasSubstr("1 duplicate triangle\n"));
    std::string damaged = readText(index);
    damaged[200] = static_cast<char>(~damaged[200]);
    folder_.write("damaged.isx", damaged + "x");
    EXPECT_THAT(saidBy({"validate", path("damaged.isx")}), HasSubstr(", and 1 more fault\n"));
}

TEST_F(CliOutput, IsTheSameInEveryLocale) {
    const auto index = sphereIndex();
    const auto plain = run({"extract", index, "--isovalue", "4.5", "-o", path("plain.obj")});
    for (const auto* locale : {"de_DE.UTF-8", "tr_TR.UTF-8", "C"}) {
        ProcessOptions options;
        options.environment = {{"LC_ALL", locale}, {"LANG", locale}};
        const auto json = run({"extract", index, "--isovalue", "4.5", "--json"}, options);
        EXPECT_EQ(json.standardOutput, run({"extract", index, "--isovalue", "4.5", "--json"}).standardOutput);
        const auto mesh = run({"extract", index, "--isovalue", "4.5", "-o", path("locale.obj")}, options);
        EXPECT_EQ(mesh.exitCode, plain.exitCode);
        EXPECT_TRUE(readText(path("plain.obj")) == readText(path("locale.obj"))) << locale;
    }
}

TEST_F(CliOutput, ShowsNoProgressBarWithoutATerminal) {
    const auto result = run({"build", sphereVolume(), "-o", path("a.isx")});
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_EQ(result.standardError, "");
}

TEST_F(CliOutput, KeepsStandardOutputEmptyOnFailure) {
    for (const auto* command : {"info", "stats", "check"})
        expectRefusal({command, path("missing.isx"), "--json"}, 4, "missing.isx");
    expectRefusal({"extract", path("missing.isx"), "--isovalue", "1", "--json"}, 4, "missing.isx");
    expectRefusal({"slide", path("missing.isx"), "--path", "1", "--json"}, 4, "missing.isx");
    expectRefusal({"build", path("missing.isx"), "-o", path("a.isx"), "--json"}, 4, "missing.isx");
}

} // namespace isoslider::test
