#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

class CliOutput : public CliTest {};

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
