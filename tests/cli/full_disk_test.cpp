// A disk that is full, and one that fills up while the program writes: one line, no half file, and what was there
// stays.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/cli/cli_fixture.h"
#include "tests/support/small_disk.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {

namespace fs = std::filesystem;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Words = std::vector<std::string>;

class CliFullDisk : public CliTest {
protected:
    void SetUp() override {
        if (!disk_.problem().empty())
            GTEST_SKIP() << disk_.problem();
    }

    static void expectOneLine(const ProcessResult& result) {
        EXPECT_EQ(result.signal, 0);
        EXPECT_EQ(result.exitCode, 4);
        EXPECT_EQ(result.standardOutput, "");
        EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1);
        EXPECT_THAT(result.standardError, AnyOf(HasSubstr("No space left on device"), HasSubstr("free")));
    }
    /// Runs the program and fills the disk as soon as `name` is there: forecasts have found room by then.
    ProcessResult runUntilFull(const Words& words, const std::string& name) const {
        ProcessOptions options;
        options.signalToSend = SIGSTOP;
        options.signalWhen = [&] {
            std::error_code gone; // it may be published between two looks
            const auto size = fs::file_size(disk_ / name, gone);
            return !gone && size > 0;
        };
        bool hasFilled = false;
        options.whileStopped = [&] {
            disk_.fill();
            hasFilled = true;
        };
        const auto result = run(words, options);
        EXPECT_TRUE(hasFilled) << "it was too fast";
        return result;
    }
    std::string on(const std::string& name) const { return (disk_ / name).string(); }
    void writeOld(const std::string& name) const { std::ofstream(disk_ / name) << "old"; }

    SmallDisk disk_{folder_ / "disk", 48};
};

TEST_F(CliFullDisk, KeepsTheOldFileOfAMesh) {
    const auto volume = noiseVolume(24), index = sphereIndex();
    for (const std::string name : {"a.ply", "a.obj", "a.stl", "a.off", "a.om"}) {
        writeOld(name);
        disk_.fill(200'000);
        expectOneLine(run({"extract", volume, "--isovalue", "7000", "-o", on(name)}));
        EXPECT_THAT(disk_.names(), ElementsAre(name));
        EXPECT_EQ(readText(disk_ / name), "old");
        fs::remove(disk_ / name);
    }
    disk_.fill(100'000);
    const auto slid = run({"slide", index, "--path", "3,5,7,4,6", "--export", on("out_%d.ply"), "--json"});
    expectOneLine(slid);
    for (const std::string& name : disk_.names()) // those before are whole
        EXPECT_EQ(run({"check", on(name)}).exitCode, 0) << name;
}

TEST_F(CliFullDisk, KeepsTheOldIndexOfABuild) {
    const auto volume = noiseVolume(48);
    for (const std::string kind : {"edges", "metacells"}) {
        writeOld("a.isx");
        disk_.fill(100'000);
        expectOneLine(run({"build", volume, "-o", on("a.isx"), "--index", kind})); // by the forecast
        EXPECT_EQ(readText(disk_ / "a.isx"), "old");
        disk_.free();
        expectOneLine(runUntilFull({"build", volume, "-o", on("a.isx"), "--index", kind}, "a.isx.partial"));
        EXPECT_THAT(disk_.names(), ElementsAre("a.isx")) << kind;
        EXPECT_EQ(readText(disk_ / "a.isx"), "old");
        disk_.free();
    }
}

TEST_F(CliFullDisk, GoesOnWithABuildOnceThereIsRoom) {
    const auto volume = noiseVolume(48);
    const Words words{"build", volume,          "-o",       on("a.isx"),    "--index",
                      "edges", "--no-topology", "--resume", "--checkpoint", "0"};
    expectOneLine(runUntilFull(words, "a.isx.partial"));
    EXPECT_FALSE(fs::exists(disk_ / "a.isx"));
    const auto kept = disk_.names();
    expectOneLine(run(words)); // still full
    EXPECT_FALSE(fs::exists(disk_ / "a.isx"));
    disk_.free();
    EXPECT_EQ(run(words).exitCode, 0);
    EXPECT_THAT(disk_.names(), ElementsAre("a.isx"));
    EXPECT_EQ(run({"build", volume, "-o", path("whole.isx"), "--index", "edges", "--no-topology"}).exitCode, 0);
    EXPECT_TRUE(readText(disk_ / "a.isx") == readText(path("whole.isx")));
}

TEST_F(CliFullDisk, AnswersTopologyThatCannotBeStored) {
    const auto volume = sphereVolume();
    ASSERT_EQ(run({"build", volume, "-o", on("a.isx"), "--no-topology"}).exitCode, 0);
    const auto before = readText(disk_ / "a.isx");
    disk_.fill();
    const auto result = run({"topology", on("a.isx"), "--at", "5"});
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    EXPECT_EQ(result.standardOutput, run({"topology", volume, "--at", "5"}).standardOutput);
    disk_.free();
    EXPECT_EQ(run({"validate", on("a.isx"), "--full"}).exitCode, 0);
    EXPECT_EQ(readText(disk_ / "a.isx").substr(0, before.size()), before);
}

TEST_F(CliFullDisk, LeavesNothingOfStandardStreams) {
    const auto volume = noiseVolume(32);
    disk_.fill(60'000);
    ProcessOptions options;
    options.environment = {{"TMPDIR", on("")}, {"cli", test::builtFile("isoslider-cli")}, {"volume", volume}};
    options.standardInputFile = volume;
    const auto known = run({"info", "-"}, options);
    expectOneLine(known);
    EXPECT_THAT(known.standardError, HasSubstr("standard input: needs 128.2 KiB while it is read, and "));
    const auto piped = runProcess("/bin/bash", {"-c", "cat \"$volume\" | \"$cli\" info -"}, options);
    expectOneLine(piped);
    EXPECT_THAT(piped.standardError, HasSubstr("standard input: does not fit: "));
    const auto mesh = run({"extract", volume, "--isovalue", "9000", "-q", "-o", "-", "--format", "ply"}, options);
    expectOneLine(mesh);
    EXPECT_THAT(mesh.standardError, HasSubstr("standard output: cannot write: No space left on device"));
    EXPECT_THAT(disk_.names(), IsEmpty());
}

TEST_F(CliFullDisk, KeepsTheOldPageOfAReport) {
    writeOld("page.md");
    disk_.fill();
    expectOneLine(run({"report", sphereVolume(), "-o", on("page.md"), "--steps", "1", "--index", "metacells"}));
    EXPECT_THAT(disk_.names(), ElementsAre("page.md"));
    EXPECT_EQ(readText(disk_ / "page.md"), "old");
    ProcessOptions options;
    options.environment = {{"TMPDIR", on("")}};
    expectOneLine(run({"report", sphereVolume(), "--steps", "1"}, options));
    EXPECT_THAT(disk_.names(), ElementsAre("page.md"));
}

} // namespace isoslider::test
