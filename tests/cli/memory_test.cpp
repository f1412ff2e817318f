// What a build takes of memory, measured on the real program.

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"
#include "tests/support/sanitizers.h"

namespace isoslider::test {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

enum class Field { Hills, Noise };

// Two hills with some noise and about 2000 values; or noise in which hardly a value occurs twice. Written plane by
// plane.
template <class Sample>
void writeField(const std::filesystem::path& path, int side, Field field) {
    std::ofstream file(path, std::ios::binary);
    std::mt19937 random(1);
    std::vector<Sample> plane(static_cast<std::size_t>(side * side));
    for (int z = 0; z < side; ++z) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const auto hill = [&](double cx, double cy, double cz) {
                    const double u = double(x) / side - cx, v = double(y) / side - cy, w = double(z) / side - cz;
                    return 1500.0 * std::exp(-8.0 * (u * u + v * v + w * w));
                };
                const double value = field == Field::Noise
                                         ? static_cast<double>(random()) - 2147483648.0
                                         : std::floor(hill(0.3, 0.4, 0.5) + hill(0.7, 0.6, 0.4) + random() % 40);
                plane[static_cast<std::size_t>(x + side * y)] = static_cast<Sample>(value);
            }
        file.write(reinterpret_cast<const char*>(plane.data()),
                   static_cast<std::streamsize>(plane.size() * sizeof(Sample)));
    }
}

class CliMemory : public CliTest {
protected:
    // With the least budget: at most a tenth above it, and 64 MiB for the program itself.
    static constexpr std::uint64_t kLimitBytes = (64 + 64 / 10 + 64) * kMiB;

    // What the program states, and what the system does. Builds of noise go on for half a minute.
    OrderedJson expectLimitKept(std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"-o", path("a.isx"), "--memory", "64M", "--json"});
        ProcessOptions options;
        options.timeout = std::chrono::minutes(4);
        const auto result = run(arguments, options);
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        EXPECT_LT(result.peakRssBytes, kLimitBytes);
        const auto json = OrderedJson::parse(result.standardOutput, nullptr, false);
        EXPECT_TRUE(json.is_object());
        if (json.is_object()) {
            EXPECT_LT(json["peak_rss_bytes"].get<std::uint64_t>(), kLimitBytes);
        }
        return json;
    }

    template <class Sample>
    void expectBudgetKept(const std::string& type, int side, Field field, const std::string& kind,
                          const std::vector<std::string>& more = {}) {
        SCOPED_TRACE(fmt::format("{} of {}, {}", kind, type, side));
        writeField<Sample>(path("volume.raw"), side, field);
        std::vector<std::string> arguments{
            "build", path("volume.raw"), "--raw-dims", fmt::format("{0},{0},{0}", side), "--raw-type",
            type,    "--index",          kind};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expectLimitKept(arguments);
    }

    void SetUp() override {
#if ISO_HAS_SANITIZER
        GTEST_SKIP() << "sanitizers take additional memory";
#endif
    }
};

// The records that are sorted take 160 MB of 16-bit samples, 320 MB of f64.
TEST_F(CliMemory, EdgesAreBuiltWithinTheBudgetWhateverTheType) {
    expectBudgetKept<std::int16_t>("i16", 160, Field::Hills, "edges");
    expectBudgetKept<std::int32_t>("i32", 160, Field::Hills, "edges");
    expectBudgetKept<double>("f64", 160, Field::Hills, "edges");
}

// Noise has an edge nearly everywhere, and what is looked at for the forecast is then largest.
TEST_F(CliMemory, EdgesOfNoiseAreBuiltWithinTheBudget) {
    expectBudgetKept<std::uint16_t>("u16", 256, Field::Noise, "edges", {"--no-topology"});
}

TEST_F(CliMemory, EdgesOfFloatingPointNoiseAreBuiltWithinTheBudget) {
    expectBudgetKept<double>("f64", 200, Field::Noise, "edges", {"--no-topology"});
}

// Distinct values take 60 MB, samples 60 MB as i32 and 120 MB as f64.
TEST_F(CliMemory, MetacellsAreBuiltWithinTheBudgetWhateverTheType) {
    expectBudgetKept<std::int16_t>("i16", 250, Field::Hills, "metacells");
    expectBudgetKept<std::int32_t>("i32", 250, Field::Noise, "metacells");
    expectBudgetKept<double>("f64", 250, Field::Noise, "metacells");
}

// Its events would take some 500 MB.
TEST_F(CliMemory, TopologyThatTakesMoreIsPutOffToTheDisk) {
    writeField<std::uint8_t>(path("volume.raw"), 128, Field::Noise);
    const auto json = expectLimitKept({"build", path("volume.raw"), "--raw-dims", "128,128,128", "--raw-type", "u8"});
    ASSERT_TRUE(json.is_object());
    EXPECT_GT(json["topology_events"], 100'000);
    EXPECT_FALSE(std::filesystem::exists(path("a.isx.topology.partial")));
    EXPECT_TRUE(runJson({"validate", path("a.isx"), "--full"})["sound"].get<bool>());
}

// However much it may: 8 bytes a sample, beside the program itself.
TEST_F(CliMemory, TopologyTakesEightBytesASampleWhateverTheBudget) {
    constexpr std::uint64_t kSide = 224, kBytes = 8 * kSide * kSide * kSide;
    writeField<std::uint16_t>(path("volume.raw"), kSide, Field::Noise);
    ProcessOptions patient; // twenty seconds beside another test
    patient.timeout = std::chrono::minutes(2);
    const auto result = run({"build", path("volume.raw"), "--raw-dims", "224,224,224", "--raw-type", "u16", "-o",
                             path("a.isx"), "--memory", "2G", "--json"},
                            patient);
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    EXPECT_LT(result.peakRssBytes, kBytes + kBytes / 10 + 64 * kMiB);
    EXPECT_GT(OrderedJson::parse(result.standardOutput)["topology_events"], 1'000'000);
}

// Where the disk cannot help, that shows before any of them is found.
TEST_F(CliMemory, TopologyThatTakesMoreIsCountedWithoutEvents) {
    writeField<std::uint8_t>(path("volume.raw"), 128, Field::Noise);
    std::filesystem::create_directory(path("a.isx.topology.partial")); // no file may have this name
    const auto json = expectLimitKept({"build", path("volume.raw"), "--raw-dims", "128,128,128", "--raw-type", "u8"});
    ASSERT_TRUE(json.is_object());
    EXPECT_FALSE(json.contains("topology_problem"));
    EXPECT_TRUE(json["topology_events"].is_null());
    EXPECT_THAT(json["topology_scratch_problem"], ::testing::HasSubstr("a.isx.topology.partial"));
    const auto checked = runJson({"validate", path("a.isx"), "--full"});
    EXPECT_TRUE(checked["sound"].get<bool>());
    EXPECT_TRUE(checked["topology_events"].is_null());
    const auto counts = runJson({"topology", path("a.isx"), "--at", "127.5"});
    EXPECT_FALSE(counts.contains("has_events")) << "there is memory for them now: they are added";
    EXPECT_GT(counts["components"], 1);
    EXPECT_EQ(runJson({"topology", path("a.isx"), "--events", "5"})["events"].size(), 5u);
    expectLimitKept({"build", path("volume.raw"), "--raw-dims", "128,128,128", "--raw-type", "u8", "--index", "edges"});
    const auto ofEdges = runJson({"topology", path("a.isx"), "--at", "127.5"});
    EXPECT_FALSE(ofEdges.contains("has_events"));
    EXPECT_EQ(ofEdges["components"], counts["components"]);
    EXPECT_EQ(runJson({"topology", path("a.isx"), "--events", "5"})["events"].size(), 5u);
}

// Three planes take more than there is.
TEST_F(CliMemory, TopologyOfPlanesThatTakeMoreIsLeftOutAndSaysWhatItWouldTake) {
    for (const int side : {1000, 1500}) {
        std::ofstream(path("volume.raw"), std::ios::binary)
            << std::string(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3, 'a');
        const auto json = expectLimitKept(
            {"build", path("volume.raw"), "--raw-dims", fmt::format("{0},{0},3", side), "--raw-type", "u8"});
        ASSERT_TRUE(json.is_object());
        EXPECT_THAT(json["topology_problem"], ::testing::ContainsRegex("takes about [0-9]+ MB of memory.*--memory"));
        EXPECT_FALSE(json.contains("topology_events"));
    }
}

TEST_F(CliMemory, TopologyThatFitsIsMadeWithinTheBudget) {
    writeField<std::uint8_t>(path("volume.raw"), 48, Field::Noise);
    const auto json = expectLimitKept({"build", path("volume.raw"), "--raw-dims", "48,48,48", "--raw-type", "u8"});
    ASSERT_TRUE(json.is_object());
    EXPECT_GT(json["topology_events"], 0);
}

constexpr int kTextSide = 140;

// A text file of f64, the last axis fastest: 21 MiB, of which as much is held as half of what reading may hold.
TEST_F(CliMemory, ACubeThatDoesNotFitIsReadInPasses) {
    std::string cube = "of equal numbers\n\n0 0 0 0\n";
    for (const char* step : {"1 0 0", "0 1 0", "0 0 1"})
        cube += fmt::format("{} {}\n", kTextSide, step);
    std::string samples(std::size_t{2} * kTextSide * kTextSide * kTextSide, ' ');
    for (std::size_t i = 0; i < samples.size(); i += 2)
        samples[i] = i % 4 == 0 ? '1' : '2';
    folder_.write("text.cube", cube + samples);
    ASSERT_TRUE(expectLimitKept({"build", path("text.cube"), "--no-topology"}).is_object());
}

// VTK holds what it reads, and a copy.
TEST_F(CliMemory, WhatCanOnlyBeReadWholeIsRefusedWithTheNumberNeeded) {
    const auto header =
        fmt::format("# vtk DataFile Version 3.0\nnumbers\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {0} {0} {0}\n"
                    "ORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA {1}\nSCALARS s float 1\nLOOKUP_TABLE default\n",
                    kTextSide, kTextSide * kTextSide * kTextSide);
    folder_.write("whole.vtk", header + std::string(std::size_t{4} * kTextSide * kTextSide * kTextSide, '\1'));
    const auto with = [&](const char* memory) {
        return std::vector<std::string>{"build",         path("whole.vtk"), "-o",  path("a.isx"),
                                        "--no-topology", "--memory",        memory};
    };
    expectRefusal(with("64M"), 4, "needs 42 MiB in memory, reading may hold half of the memory budget, 32 MiB");
    EXPECT_LT(run(with("64M")).peakRssBytes, kLimitBytes);
    EXPECT_EQ(run(with("128M")).exitCode, 0);
}

TEST_F(CliMemory, AQuarterOfTheMachineUnlessStated) {
    EXPECT_THAT(run({"build", "--help"}).standardOutput, ::testing::HasSubstr("a quarter of this machine's"));
}

// Some systems bound the address space, which costs nothing until it is used.
TEST_F(CliMemory, IndexesAreUsedInEightGigabytesOfAddressSpace) {
    writeField<std::int32_t>(path("volume.raw"), 64, Field::Noise);
    ProcessOptions options;
    options.addressSpaceBytes = std::uint64_t{8'000'000} * 1024;
    for (const std::string kind : {"edges", "metacells"}) {
        const auto index = path(kind + ".isx");
        for (const std::vector<std::string>& arguments :
             std::vector<std::vector<std::string>>{{"build", path("volume.raw"), "--raw-dims", "64,64,64", "--raw-type",
                                                    "i32", "-o", index, "--index", kind},
                                                   {"stats", index},
                                                   {"info", index},
                                                   {"slide", index, "--path", "0,1e9,-1e9,0"},
                                                   {"extract", index, "--isovalue", "0"}}) {
            SCOPED_TRACE(fmt::format("{} {}", arguments.front(), kind));
            const auto result = run(arguments, options);
            EXPECT_EQ(result.exitCode, 0) << result.standardError;
        }
    }
}

// Facts of an index are read, not slid on.
TEST_F(CliMemory, FactsOfAnIndexTakeLittleAddressSpace) {
    ProcessOptions options;
    options.addressSpaceBytes = 500 * kMiB;
    for (const char* command : {"stats", "info"})
        EXPECT_EQ(run({command, sphereIndex()}, options).exitCode, 0) << command;
}

} // namespace
} // namespace isoslider::test
