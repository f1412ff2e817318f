#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

using ::testing::HasSubstr;
using ::testing::Not;

class CliUsage : public CliTest {};

TEST_F(CliUsage, ShowsHelpAndVersionOnStandardOutput) {
    const auto help = run({"--help"});
    EXPECT_EQ(help.exitCode, 0);
    for (const auto* command : {"info", "build", "stats", "extract", "slide", "check", "resample"}) {
        EXPECT_THAT(help.standardOutput, HasSubstr(std::string("\n  ") + command + " "));
        EXPECT_EQ(run({command, "--help"}).exitCode, 0);
    }
    const auto version = run({"--version"});
    EXPECT_EQ(version.exitCode, 0);
    EXPECT_THAT(version.standardOutput, ::testing::StartsWith("isoslider-cli "));
}

TEST_F(CliUsage, RefusesWordsItDoesNotKnow) {
    expectRefusal({}, 2, "command is required");
    expectRefusal({"slice"}, 2);
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

TEST_F(CliUsage, RefusesLaterCommandsByNameAndDoesNotListThem) {
    const auto help = run({"--help"}).standardOutput;
    for (const auto* command : {"validate"}) {
        expectRefusal({command}, 2, "not available in this version");
        expectRefusal({command, "x.isx", "--json", "--at", "5"}, 2, "not available in this version");
        EXPECT_THAT(help, Not(HasSubstr(command)));
    }
}

TEST_F(CliUsage, RefusesLaterOptionsByName) {
    const auto volume = sphereVolume();
    expectRefusal({"build", volume, "-o", "a.isx", "--index", "cells"}, 2, "known: edges, metacells, auto");
    expectRefusal({"build", volume, "-o", "a.isx", "--resume"}, 2, "not available in this version");
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
