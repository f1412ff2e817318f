// "-" in place of a file's name, and what is left when it goes wrong.

#include <csignal>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/cli/scratch_folder.h"
#include "tests/cli/cli_fixture.h"
#include "tests/support/result_matchers.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class CliStreams : public CliTest {
protected:
    CliStreams() { fs::create_directory(folder_ / "scratch"); }

    ProcessOptions from(const std::string& input) const {
        ProcessOptions options;
        options.standardInputFile = input;
        options.environment = {{"TMPDIR", path("scratch")}};
        return options;
    }
    std::string outputOf(const std::vector<std::string>& arguments, const std::string& input) const {
        const auto result = run(arguments, from(input));
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        EXPECT_EQ(result.standardError, "");
        return result.standardOutput;
    }
    void expectRefusal(std::vector<std::string> arguments, const std::string& input, int exitCode,
                       const std::string& line) const {
        const auto result = run(arguments, from(input));
        EXPECT_EQ(result.exitCode, exitCode) << line;
        EXPECT_EQ(result.standardOutput, "");
        EXPECT_EQ(result.standardError, "isoslider-cli: " + line + "\n");
    }
    /// Runs a line of the shell, in which "$cli" is the program.
    ProcessResult shell(const std::string& line) const {
        ProcessOptions options;
        options.workingFolder = folder_.path();
        options.environment = {{"TMPDIR", path("scratch")}, {"cli", test::builtFile("isoslider-cli")}};
        return runProcess("/bin/bash", {"-o", "pipefail", "-c", line}, options);
    }
    std::vector<std::string> left() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_ / "scratch"))
            names.push_back(entry.path().filename().string());
        return names;
    }
    void TearDown() override { EXPECT_THAT(left(), IsEmpty()); }
};

TEST_F(CliStreams, ReadsVolumesAndIndexesByTheirContent) {
    const auto volume = sphereVolume(), index = sphereIndex(), raw = rawSphere();
    EXPECT_EQ(outputOf({"info", "-"}, volume), outputOf({"info", volume}, ""));
    EXPECT_EQ(outputOf({"info", "-"}, index), outputOf({"info", index}, ""));
    EXPECT_EQ(outputOf({"info", "-", "--raw-dims", "16,16,16", "--raw-type", "f32"}, raw),
              outputOf({"info", raw, "--raw-dims", "16,16,16", "--raw-type", "f32"}, ""));
    EXPECT_THAT(outputOf({"validate", "-", "--full"}, index), StartsWith("standard input: sound, "));
    EXPECT_THAT(outputOf({"stats", "-"}, index), HasSubstr("16x16x16"));
    EXPECT_EQ(outputOf({"topology", "-", "--at", "5"}, volume), outputOf({"topology", volume, "--at", "5"}, ""));
    const auto piped = shell("cat sphere.mha | \"$cli\" info --json - | cat");
    EXPECT_EQ(piped.standardOutput, outputOf({"info", volume, "--json"}, ""));
}

TEST_F(CliStreams, BuildsAnIndexOfStandardInput) {
    const auto volume = sphereVolume();
    EXPECT_THAT(outputOf({"build", "-", "-o", path("piped.isx")}, volume), HasSubstr("piped.isx: "));
    EXPECT_EQ(run({"validate", path("piped.isx"), "--full", "--against", volume}).exitCode, 0);
    EXPECT_EQ(folder_.names(), (std::vector<std::string>{"piped.isx", "scratch", "sphere.mha"}));
    expectRefusal({"build", "-", "-o", path("none/a.isx")}, volume, 4,
                  path("none/a.isx") + ": its folder does not exist");
}

TEST_F(CliStreams, WritesMeshesToStandardOutput) {
    const auto volume = sphereVolume();
    for (const std::string format : {"ply", "obj", "stl", "off", "om"}) {
        EXPECT_EQ(run({"extract", volume, "--isovalue", "5", "-o", path("a." + format)}).exitCode, 0);
        const auto result = run({"extract", volume, "--isovalue", "5", "-o", "-", "--format", format}, from(""));
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_TRUE(result.standardOutput == readText(path("a." + format))) << format;
        EXPECT_THAT(result.standardError, EndsWith("written to            standard output\n"));
        EXPECT_EQ(outputOf({"check", "-"}, path("a." + format)), outputOf({"check", path("a." + format)}, ""));
    }
    const auto piped = shell("\"$cli\" extract - --isovalue 5 -q -o - --format ply <sphere.mha | \"$cli\" check -");
    EXPECT_EQ(piped.exitCode, 0);
    EXPECT_EQ(piped.standardError, "");
    EXPECT_THAT(piped.standardOutput, StartsWith("manifold              yes"));
}

TEST_F(CliStreams, RefusesWhatItCannotKnowOrNeverEnds) {
    const std::string endless = "/dev/zero";
    expectRefusal({"info", "-"}, endless, 3,
                  "standard input: is of no volume format that is known by name or content; raw samples need dims "
                  "and type, other formats --input-format");
    expectRefusal({"validate", "-"}, endless, 3, "standard input: is not an ISOSLIDER index");
    expectRefusal({"info", "-", "--raw-dims", "4,4,4", "--raw-type", "u8"}, endless, 3,
                  "standard input: has 65 bytes; dims, type and skipped bytes ask for 64 (trailing bytes have to be "
                  "allowed)");
    const auto cut = run({"info", "-", "--raw-dims", "4,4,4", "--raw-type", "u8", "--allow-trailing"}, from(endless));
    EXPECT_EQ(cut.exitCode, 0) << cut.standardError;
    const auto huge = run({"info", "-", "--raw-dims", "2097152,2097152,2097152", "--raw-type", "f64"}, from(endless));
    EXPECT_EQ(huge.exitCode, 3);
    EXPECT_THAT(huge.standardError, StartsWith("isoslider-cli: standard input: "));
}

TEST_F(CliStreams, RefusesAnOutputBeforeItReadsALongInput) {
    const std::string endless = "/dev/zero"; // 64 GB would take minutes
    const std::vector<std::string> raw{"--raw-dims", "4096,4096,4096", "--raw-type", "u8"};
    const auto refusal = [&](std::vector<std::string> arguments, int exitCode) {
        arguments.insert(arguments.end(), raw.begin(), raw.end());
        const auto result = run(arguments, from(endless));
        EXPECT_EQ(result.exitCode, exitCode) << result.standardError;
        return result.standardError;
    };
    EXPECT_THAT(refusal({"extract", "-", "--isovalue", "5", "-o", path("none/a.ply")}, 4), HasSubstr("none"));
    EXPECT_THAT(refusal({"extract", "-", "--isovalue", "5", "-o", path("a.vtk")}, 2), HasSubstr("a.vtk"));
    EXPECT_THAT(refusal({"resample", "-", "-o", path("a.vtk")}, 2), HasSubstr("volumes are written as .mha"));
    EXPECT_THAT(refusal({"resample", "-", "-o", path("none/a.mha")}, 4), HasSubstr("none"));
    EXPECT_EQ(refusal({"build", "-", "-o", path("a.isx"), "--resume"}, 2),
              "isoslider-cli: build - --resume: standard input cannot be read again; save it to a file\n");
}

TEST_F(CliStreams, RefusesWhatMakesNoSense) {
    const auto volume = sphereVolume(), index = sphereIndex();
    expectRefusal({"info", "-"}, "", 3, "standard input: is empty");
    expectRefusal({"build", "-", "-o", path("b.isx")}, index, 3,
                  "standard input: is an index; this command reads one from its file, and only volumes from here");
    expectRefusal({"build", volume, "-o", "-"}, "", 2,
                  "-o -: an index is written to and fro, which standard output cannot; give a file");
    expectRefusal({"slide", "-", "--path", "5"}, index, 2,
                  "slide -: an index is read to and fro, which standard input cannot; save it to a file");
    expectRefusal({"report", volume, "-"}, volume, 2,
                  "report -: volumes are read several times, which standard input cannot; save it to a file");
    expectRefusal({"extract", "-", "--isovalue", "5", "-o", "-"}, volume, 2,
                  "-o - needs --format: ply, obj, stl, off or om");
    expectRefusal({"extract", "-", "--isovalue", "5", "-o", "-", "--format", "vtk"}, volume, 2,
                  "--format: 'vtk' is not a format; known: ply, obj, stl, off, om");
    expectRefusal({"extract", "-", "--isovalue", "5", "--json", "-o", "-", "--format", "ply"}, volume, 2,
                  "--json needs standard output for itself; give -o the name of a file");
    expectRefusal({"extract", volume, "--isovalue", "5", "-o", path("a.ply"), "--format", "ply"}, "", 2,
                  "--format is for standard output (-o -); a file's suffix states its format");
    expectRefusal({"info", volume, "--input-format", "nrrd"}, "", 2,
                  "--input-format is for standard input (-); a file's name and content state its format");
    const auto wrong = run({"info", "-", "--input-format", "nrrd"}, from(volume));
    EXPECT_EQ(wrong.exitCode, 3);
    EXPECT_THAT(wrong.standardError, StartsWith("isoslider-cli: standard input: is not NRRD"));
}

TEST_F(CliStreams, KeepsDetachedHeadersFromReadingElsewhere) {
    auto header = readText(sphereVolume());
    header.replace(header.find("LOCAL"), std::string::npos, "sphere.mha\n");
    expectRefusal({"info", "-"}, folder_.write("d.mhd", header).string(), 3,
                  "standard input: ElementDataFile: there is no file 'sphere.mha' beside the header");
}

TEST_F(CliStreams, EndsWithOneLineWhenTheReaderGoesAway) {
    auto options = from("");
    options.closesStandardOutput = true;
    const std::vector<std::string> words{"extract", sphereVolume(), "--isovalue", "5", "-q", "-o",
                                         "-",       "--format",     "ply"};
    const auto result = run(words, options);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.exitCode, 4);
    EXPECT_EQ(result.standardError, "isoslider-cli: standard output: was closed before all was written\n");
    options = from("");
    options.standardOutputFile = "/dev/full";
    EXPECT_EQ(run(words, options).standardError,
              "isoslider-cli: standard output: cannot write: No space left on device\n");
    EXPECT_EQ(shell("\"$cli\" extract sphere.mha --isovalue 5 -q -o - --format ply >&-").exitCode, 4);
    // No file takes the place of a closed stream, and gets its words.
    EXPECT_EQ(shell("\"$cli\" build sphere.mha -o c.isx <&- >&- 2>&-").exitCode, 4);
    EXPECT_EQ(run({"validate", path("c.isx"), "--full"}).exitCode, 0);
}

TEST_F(CliStreams, StopsWhileItWaitsForInput) {
    const std::string silent = path("silent");
    ASSERT_EQ(::mkfifo(silent.c_str(), 0600), 0);
    const int writer = ::open(silent.c_str(), O_RDWR);
    auto options = from(silent);
    options.signalToSend = SIGINT;
    options.signalWhen = [&] { return !left().empty(); };
    const auto result = run({"info", "-"}, options);
    ::close(writer);
    EXPECT_EQ(result.exitCode, 130);
    EXPECT_EQ(result.standardError, "isoslider-cli: interrupted\n");
}

// Stopped meanwhile, the program finds both signals at once, and has no time to end by itself.
TEST_F(CliStreams, RemovesScratchFoldersAtTheSecondInterrupt) {
    noiseVolume(40);
    const auto result = shell("\"$cli\" report noise.mha --steps 50 >/dev/null & pid=$!\n"
                              "until compgen -G 'scratch/*/*' >/dev/null; do sleep 0.01; done\n"
                              "kill -STOP $pid; kill -HUP $pid; kill -TERM $pid; kill -CONT $pid; wait $pid");
    EXPECT_EQ(result.exitCode, 130) << result.standardError;
    EXPECT_EQ(result.standardError, "") << "there was no time for a line";
}

TEST(ScratchFolder, GoesWithAllThatIsInIt) {
    const TemporaryFolder folder;
    {
        cli::ScratchFolder first, second;
        ASSERT_THAT(first.make(folder.path(), "a"), IsOk());
        ASSERT_THAT(second.make(folder.path(), "b"), IsOk());
        std::ofstream(first.path() / "file") << "x";
        EXPECT_EQ(folder.names().size(), 2u);
        cli::removeScratchFolders();
        EXPECT_THAT(folder.names(), IsEmpty());
        ASSERT_THAT(second.make(folder.path(), "c"), IsOk());
    }
    EXPECT_THAT(folder.names(), IsEmpty());
    EXPECT_THAT(cli::ScratchFolder().make(folder / "none", "a"), HasError(ErrorCode::NotFound));
}

} // namespace isoslider::test
