#include <regex>
#include <set>

#include "tests/cli/cli_fixture.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {

using ::testing::HasSubstr;

class CliUsage : public CliTest {};

TEST_F(CliUsage, ShowsHelpAndVersionOnStandardOutput) {
    const auto help = run({"--help"});
    EXPECT_EQ(help.exitCode, 0);
    for (const auto* command : {"info", "build", "stats", "extract", "slide", "check", "resample", "validate"}) {
        EXPECT_THAT(help.standardOutput, HasSubstr(std::string("\n  ") + command + " "));
        EXPECT_EQ(run({command, "--help"}).exitCode, 0);
    }
    const auto version = run({"--version"});
    EXPECT_EQ(version.exitCode, 0);
    EXPECT_THAT(version.standardOutput, ::testing::StartsWith("isoslider-cli "));
}

TEST_F(CliUsage, SaysNothingWhenAskedToBeQuiet) {
    const auto volume = sphereVolume();
    for (const std::vector<std::string>& words : {std::vector<std::string>{"info", volume, "--quiet"},
                                                  {"build", volume, "-o", path("a.isx"), "-q"},
                                                  {"validate", path("a.isx"), "-q"}}) {
        const auto result = run(words);
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_EQ(result.standardOutput + result.standardError, "");
    }
    EXPECT_EQ(run({"info", path("none.mha"), "-q"}).exitCode, 4);
    EXPECT_NE(run({"info", path("none.mha"), "-q"}).standardError, "") << "failures are stated";
    EXPECT_EQ(runJson({"info", volume, "-q"})["dims"], OrderedJson({16, 16, 16}));
}

TEST_F(CliUsage, TakesNamesThatBeginWithADash) {
    ProcessOptions here;
    here.workingFolder = folder_.path();
    folder_.write("-a.mha", readText(sphereVolume()));
    EXPECT_EQ(run({"info", "--", "-a.mha"}, here).exitCode, 0);
    EXPECT_EQ(run({"build", "-o", "./-a.isx", "--", "-a.mha"}, here).exitCode, 0);
    EXPECT_EQ(run({"validate", "--", "-a.isx"}, here).exitCode, 0);
    EXPECT_EQ(run({"validate", "./-a.isx"}, here).exitCode, 0);
}

// The completion asks the program itself, so that it knows each command and each option.
TEST_F(CliUsage, IsCompletedByTheShell) {
    const auto complete = [&](const std::string& words, int at) {
        const std::string script = "PATH=\"$(dirname \"$1\"):$PATH\"; source \"$2\"; COMP_WORDS=(" + words +
                                   "); COMP_CWORD=" + std::to_string(at) +
                                   "; _isoslider_cli; printf '%s\\n' \"${COMPREPLY[@]}\"";
        return runProcess("/bin/bash",
                          {"-c", script, "bash", test::builtFile("isoslider-cli"),
                           std::string(test::sourceFolder()) + "/packaging/completions/isoslider-cli"},
                          {.workingFolder = folder_.path()})
            .standardOutput;
    };
    EXPECT_EQ(complete("isoslider-cli val", 1), "validate\n");
    EXPECT_THAT(complete("isoslider-cli ''", 1), HasSubstr("topology\n"));
    EXPECT_EQ(complete("isoslider-cli validate --fu", 2), "--full\n");
    EXPECT_EQ(complete("isoslider-cli build x -o y --res", 5), "--resume\n--resample\n");
    EXPECT_EQ(complete("isoslider-cli build --index m", 3), "metacells\n");
    folder_.write("head.mha", "");
    EXPECT_EQ(complete("isoslider-cli info he", 2), "head.mha\n");
}

// A command's options stand below its heading, those of many below separate headings.
TEST_F(CliUsage, IsDescribedByItsManualPage) {
    std::string page = readText(std::filesystem::path(test::sourceFolder()) / "packaging/desktop/isoslider-cli.1");
    for (std::size_t at = 0; (at = page.find("\\-", at)) != std::string::npos; ++at)
        page.erase(at, 1);
    const auto section = [&](const std::string& heading) {
        const std::size_t begin = page.find("\n.SS " + heading);
        EXPECT_NE(begin, std::string::npos) << heading;
        return begin == std::string::npos ? "" : page.substr(begin, page.find("\n.S", begin + 5) - begin);
    };
    // "  --name", "  -n,--name"
    const auto optionsOf = [](const std::string& help) {
        std::set<std::string> names;
        const std::regex option("\n  (-[a-z],)?(--[a-z-]+)");
        for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at)
            names.insert((*at)[2]);
        return names;
    };
    const std::string help = run({"--help"}).standardOutput;
    const std::string commands = help.substr(help.find("Subcommands:"));
    const std::regex line("\n  ([a-z]+) "), bold("\\\\fB(--[a-z-]+)\\\\fR");
    int count = 0;
    for (std::sregex_iterator at(commands.begin(), commands.end(), line), end; at != end; ++at, ++count) {
        const std::string command = (*at)[1], own = section(command + " ");
        const std::string described = own + section("Of every command") + section("Of commands that read a volume");
        const auto options = optionsOf(run({command, "--help"}).standardOutput);
        EXPECT_GT(options.size(), 2u) << command;
        for (const std::string& option : options)
            EXPECT_THAT(described, HasSubstr("\\fB" + option + "\\fR")) << command;
        for (std::sregex_iterator stated(own.begin(), own.end(), bold); stated != end; ++stated)
            EXPECT_TRUE(options.contains((*stated)[1])) << command << " has no " << (*stated)[1];
    }
    EXPECT_EQ(count, 10);
}

// What the shell would offer is written by a compadd and a _describe that stand for its own.
TEST_F(CliUsage, IsCompletedByZsh) {
    constexpr char kShell[] = "/usr/bin/zsh";
    if (!std::filesystem::exists(kShell))
        GTEST_SKIP() << "zsh is not installed";
    const auto complete = [&](const std::string& words, int at) {
        const std::string script = "path=(${1:h} $path)\n"
                                   "compadd() { [[ $1 == -- ]] && shift; print -l -- ${(M)@:#${words[CURRENT]}*} }\n"
                                   "_describe() { print -l -- ${(M)${(P)2}:#${words[CURRENT]}*} }\n"
                                   "_files() { print files }\n"
                                   "complete() { local -a words; local CURRENT=$2; words=(" +
                                   words + "); source $1 }\ncomplete $2 " + std::to_string(at);
        const auto result = runProcess(kShell,
                                       {"-f", "-c", script, "zsh", test::builtFile("isoslider-cli"),
                                        std::string(test::sourceFolder()) + "/packaging/completions/_isoslider-cli"},
                                       {.workingFolder = folder_.path()});
        EXPECT_EQ(result.standardError, "");
        return result.standardOutput;
    };
    EXPECT_EQ(complete("isoslider-cli val", 2), "validate:Whether an index is sound, and where it is not\n");
    EXPECT_THAT(complete("isoslider-cli ''", 2), HasSubstr("topology:"));
    EXPECT_EQ(complete("isoslider-cli validate --fu", 3), "--full\n");
    EXPECT_EQ(complete("isoslider-cli build x -o y --res", 6), "--resume\n--resample\n");
    EXPECT_EQ(complete("isoslider-cli build --index m", 4), "metacells\n");
    EXPECT_EQ(complete("isoslider-cli extract - --format o", 5), "obj\noff\nom\n");
    EXPECT_EQ(complete("isoslider-cli info he", 3), "files\n");
}

TEST_F(CliUsage, RefusesAnOutputThatIsTheInput) {
    const auto volume = sphereVolume(), index = sphereIndex();
    std::filesystem::create_directory(folder_ / "series");
    std::filesystem::create_symlink(volume, folder_ / "link.isx");
    std::filesystem::create_symlink(index, folder_ / "link.ply");
    const auto before = readText(volume), indexBefore = readText(index);
    const std::string saying = "is the input; choose another output";
    expectRefusal({"build", volume, "-o", volume}, 2, saying);
    expectRefusal({"build", volume, "-o", path("link.isx")}, 2, saying);
    expectRefusal({"build", volume, "-o", path("./series/../sphere.mha")}, 2, saying);
    expectRefusal({"build", path("series"), "-o", path("series")}, 2, saying);
    expectRefusal({"build", path("series"), "-o", path("series/")}, 2, saying);
    expectRefusal({"build", volume, "-o", path("series")}, 4, "is a directory");
    expectRefusal({"extract", index, "--isovalue", "5", "-o", path("link.ply")}, 2, saying);
    expectRefusal({"resample", volume, "-o", volume}, 2, saying);
    expectRefusal({"report", volume, "-o", volume}, 2);
    EXPECT_EQ(readText(volume), before);
    EXPECT_EQ(readText(index), indexBefore);
}

TEST_F(CliUsage, NeedsTheNameOfAnInput) {
    for (const auto* command : {"info", "check", "stats", "topology", "validate", "report"})
        expectRefusal({command, ""}, 2, "the input has no name");
    expectRefusal({"extract", "", "--isovalue", "5"}, 2, "the input has no name");
    expectRefusal({"slide", "", "--path", "5"}, 2, "the input has no name");
    expectRefusal({"build", "", "-o", "a.isx"}, 2, "the input has no name");
    expectRefusal({"resample", "", "-o", "a.mha"}, 2, "the input has no name");
    expectRefusal({"report", sphereVolume(), ""}, 2, "the input has no name");
    expectRefusal({"validate", "a.isx", "--against", ""}, 2, "the volume has no name");
}

TEST_F(CliUsage, RefusesOptionsOfVolumesForAnIndex) {
    const auto index = sphereIndex(), volume = path("sphere.mha");
    for (const std::vector<std::string>& option : {std::vector<std::string>{"--frame", "0"},
                                                   {"--field", "nope"},
                                                   {"--component", "0"},
                                                   {"--resample", "4,4,4"},
                                                   {"--raw-dims", "3,3,3", "--raw-type", "u8"},
                                                   {"--allow-trailing"},
                                                   {"--allow-external"}})
        for (const std::vector<std::string>& command : {std::vector<std::string>{"info", index},
                                                        {"extract", index, "--isovalue", "5"},
                                                        {"topology", index, "--at", "5"}}) {
            auto arguments = command;
            arguments.insert(arguments.end(), option.begin(), option.end());
            expectRefusal(arguments, 2, index + ": " + option[0] + " cannot apply to an index");
        }
    expectRefusal({"validate", index, "--frame", "0"}, 2, "--frame requires --against");
    EXPECT_EQ(run({"validate", index, "--against", volume, "--frame", "0"}).exitCode, 0);
    EXPECT_EQ(run({"info", volume, "--frame", "0", "--component", "0"}).exitCode, 0);
}

// A name states nothing of what is read as headerless samples.
TEST_F(CliUsage, ReadsHeaderlessSamplesUnderTheNameOfAnIndex) {
    rawSphere("raw.isx");
    EXPECT_EQ(run({"info", path("raw.isx"), "--raw-dims", "16,16,16", "--raw-type", "f32"}).exitCode, 0);
    expectRefusal({"info", path("raw.isx"), "--raw-dims", "99,16,16", "--raw-type", "f32"}, 3, "has 16384 bytes");
}

TEST_F(CliUsage, RefusesChoicesInHeaderlessSamples) {
    const auto raw = rawSphere();
    for (const std::vector<std::string>& option : {std::vector<std::string>{"--frame", "7"},
                                                   {"--field", "nope"},
                                                   {"--component", "9"},
                                                   {"--resample", "4,4,4"}}) {
        std::vector<std::string> arguments{"info", raw, "--raw-dims", "16,16,16", "--raw-type", "f32"};
        arguments.insert(arguments.end(), option.begin(), option.end());
        expectRefusal(arguments, 2, option[0]);
    }
}

TEST_F(CliUsage, RefusesWordsItDoesNotKnow) {
    expectRefusal({}, 2, "command is required");
    expectRefusal({"slice"}, 2, "'slice' is not a command");
    expectRefusal({"slice", "--json"}, 2, "'slice' is not a command");
    expectRefusal({"slice", "a.mha", "-o", "b.isx"}, 2, "'slice' is not a command");
    expectRefusal({"info"}, 2, "required");
    expectRefusal({"info", sphereVolume(), "--colour"}, 2, "--colour");
    expectRefusal({"info", sphereVolume(), "second"}, 2, "second");
    expectRefusal({"--json"}, 2);
    // Named although something else is missing as well.
    expectRefusal({"--colour"}, 2, "'--colour'");
    expectRefusal({"info", "--colour"}, 2, "'--colour'");
    expectRefusal({"extract", sphereVolume(), "--isovalu", "5"}, 2, "'--isovalu'");
    expectRefusal({"extract", sphereVolume(), "--iso=5"}, 2, "'--iso'");
    expectRefusal({"build", sphereVolume(), "-x"}, 2, "'-x'");
    expectRefusal({"--colour", "info", sphereVolume()}, 2, "'--colour'");
}

TEST_F(CliUsage, RefusesLaterOptionsByName) {
    const auto volume = sphereVolume();
    expectRefusal({"build", volume, "-o", "a.isx", "--index", "cells"}, 2, "known: edges, metacells, auto");
    expectRefusal({"build", volume, "-o", "a.isx", "--checkpoint", "-1"}, 2, "below zero");
    EXPECT_EQ(run({"build", volume, "-o", "b.isx", "--lod-error", "0%"}).exitCode, 0);
}

TEST_F(CliUsage, RefusesTextThatIsNoFiniteNumber) {
    const auto volume = sphereVolume();
    for (const auto* text : {"nan", "NaN", "inf", "-inf", "1e999", "", "1,5", "0x10", " 5", "5 ", "five", "--"})
        expectRefusal({"extract", volume, "--isovalue", text}, 2);
}

TEST_F(CliUsage, TakesNumbersInEveryUsualForm) {
    const auto volume = sphereVolume();
    for (const auto* text : {"5", "-5", "+5", "5.", "-.5", "5e0", "1E-300", "-0"})
        EXPECT_EQ(run({"extract", volume, "--isovalue", text}).exitCode, 0) << text;
}

TEST_F(CliUsage, RefusesSizesThatAreNone) {
    const auto volume = sphereVolume();
    for (const auto* text : {"12parsecs", "", "-1", "1.5G", "M", "512 M", "99999999999999999999", "16777216T"})
        expectRefusal({"build", volume, "-o", "a.isx", "--memory", text}, 2, "at least 64 MiB");
    expectRefusal({"build", volume, "-o", "a.isx", "--memory", "1M"}, 2, "at least 64 MiB");
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"sphere.mha"});
}

TEST_F(CliUsage, RefusesNumbersOutOfRange) {
    const auto volume = sphereVolume();
    expectRefusal({"build", volume, "-o", "a.isx", "--skip-levels", "0"}, 2, "1 to 8");
    expectRefusal({"build", volume, "-o", "a.isx", "--skip-levels", "9"}, 2, "1 to 8");
    expectRefusal({"build", volume, "-o", "a.isx", "--threads", "0"}, 2, "--threads");
    expectRefusal({"build", volume, "-o", "a.isx", "--redundancy", "-1"}, 2, "--redundancy");
    expectRefusal({"build", volume, "-o", "a.isx", "--redundancy", "0"}, 2, "above zero");
    expectRefusal({"slide", "a.isx", "--from", "0", "--to", "1", "--steps", "0"}, 2, "--steps");
}

} // namespace isoslider::test
