// Ctrl-C in commands that work for many seconds.

#include <algorithm>
#include <csignal>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"
#include "tests/support/sanitizers.h"

namespace isoslider::test {
namespace {

using std::chrono::milliseconds;

constexpr int kSide = kHasSanitizers ? 68 : 96; // of random samples: a million triangles, and some seconds
constexpr std::uint32_t kBigStl = kHasSanitizers ? 500'000 : 1'500'000;

class CliInterrupt : public CliTest {
protected:
    std::string roughVolume() const {
        std::string samples(static_cast<std::size_t>(kSide) * kSide * kSide, '\0');
        unsigned state = 7;
        for (char& sample : samples) {
            state = state * 1664525u + 1013904223u;
            sample = static_cast<char>(state >> 24);
        }
        return folder_.write("rough.raw", samples).string();
    }
    std::vector<std::string> extraction(const std::string& volume, const std::vector<std::string>& more) const {
        std::vector<std::string> words{"extract",    volume, "--raw-dims", fmt::format("{0},{0},{0}", kSide),
                                       "--raw-type", "u8",   "--isovalue", "127.5"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    /// A binary STL of triangles that lie apart, each with its three corners: much to weld and to check.
    std::string bigStl(std::uint32_t triangles) const {
        std::string bytes(84, ' ');
        std::memcpy(bytes.data() + 80, &triangles, sizeof triangles);
        for (std::uint32_t t = 0; t < triangles; ++t) {
            const auto at = static_cast<float>(t * 2654435761u >> 8);
            const float corners[12] = {0, 0, 1, at, 0, 0, at + 1, 0, 0, at, 1, static_cast<float>(t)};
            bytes.append(reinterpret_cast<const char*>(corners), sizeof corners);
            bytes.append(2, '\0');
        }
        return folder_.write("big.stl", bytes).string();
    }
    /// The processor time that the program takes when it is left alone.
    milliseconds timeOf(const std::vector<std::string>& arguments) const {
        const auto names = folder_.names();
        const auto result = run(arguments, {.timeout = std::chrono::seconds(200)});
        EXPECT_EQ(result.signal, 0);
        removeBut(names);
        return result.processorTime;
    }
    /// Interrupts the program after part / 9 of the work. A busy machine makes the same work take up to twice as long:
    /// when it is done before that moment, `whole` becomes the time that it took, and it is tried again.
    ProcessResult interrupt(const std::vector<std::string>& arguments, int part, milliseconds& whole) const {
        const auto names = folder_.names();
        for (int attempt = 0;; ++attempt) {
            ProcessOptions options;
            options.timeout = std::chrono::seconds(200);
            options.signalToSend = SIGINT;
            options.signalAtProcessorTime = part * whole / 9;
            const auto result = run(arguments, options);
            if (result.processorTimeAtSignal.count() > 0 || attempt == 3)
                return result;
            whole = result.processorTime;
            removeBut(names);
        }
    }
    void removeBut(const std::vector<std::string>& names) const {
        for (const std::string& name : folder_.names())
            if (std::find(names.begin(), names.end(), name) == names.end())
                std::filesystem::remove(folder_ / name);
    }
    /// Interrupts the program at several moments of its work and expects that it soon ends each time. One second is
    /// what is promised. All is counted in processor time, which other programs and a slow disk change little.
    void expectInterruptible(const std::vector<std::string>& arguments) const {
        milliseconds whole = timeOf(arguments);
        const milliseconds soon =
            std::max(milliseconds(1000) * std::max(std::thread::hardware_concurrency(), 1u), whole / 5);
        ASSERT_GT(whole, milliseconds(500)) << "too fast to be interrupted";
        const auto names = folder_.names();
        for (int part = 1; part < 8; part += 2) {
            const auto result = interrupt(arguments, part, whole);
            const milliseconds sent = result.processorTimeAtSignal;
            SCOPED_TRACE(fmt::format("{} ms after the start, of {}", sent.count(), whole.count()));
            ASSERT_GT(sent.count(), 0) << "done before the signal, four times";
            EXPECT_LT(result.processorTime, sent + soon);
            if (part > 4 && result.exitCode == 0) { // all but done when the signal came
                removeBut(names);
                continue;
            }
            EXPECT_EQ(result.exitCode, 130) << result.standardError;
            EXPECT_EQ(result.standardOutput, "");
            EXPECT_EQ(result.standardError, "isoslider-cli: interrupted\n");
            EXPECT_EQ(folder_.names(), names);
        }
    }
};

TEST_F(CliInterrupt, EndsExtraction) { expectInterruptible(extraction(roughVolume(), {"-o", path("a.stl")})); }

TEST_F(CliInterrupt, EndsExtractionToTheFormatOfOpenMesh) {
    expectInterruptible(extraction(roughVolume(), {"-o", path("a.om"), "--no-check"}));
}

class CliInterruptKinds : public CliInterrupt, public testing::WithParamInterface<const char*> {};
// The topology comes last: by then the index is there, and whole.
TEST_F(CliInterrupt, OfABuildSaysWhetherThereIsAnIndex) {
    const std::string index = path("rough.isx");
    const std::vector<std::string> arguments{
        "build", roughVolume(), "--raw-dims", fmt::format("{0},{0},{0}", kSide), "--raw-type", "u8", "-o", index};
    milliseconds whole = timeOf(arguments);
    for (const int part : {1, 6, 7}) {
        const auto result = interrupt(arguments, part, whole);
        if (result.exitCode == 0)
            continue; // all but done when the signal came
        EXPECT_EQ(result.exitCode, 130);
        EXPECT_EQ(result.standardError,
                  std::filesystem::exists(index)
                      ? fmt::format("isoslider-cli: interrupted; '{}' is whole, but has no topology\n", index)
                      : "isoslider-cli: interrupted\n");
        std::filesystem::remove(index);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, CliInterruptKinds, testing::Values("edges", "metacells"));

TEST_P(CliInterruptKinds, EndASlideThatExports) {
    constexpr int kIndexed = kSide * 4 / 5; // of the samples of a larger volume
    const std::string index = path("rough.isx");
    const auto built = run({"build", roughVolume(), "--raw-dims", fmt::format("{0},{0},{0}", kIndexed), "--raw-type",
                            "u8", "--allow-trailing", "--index", GetParam(), "-o", index},
                           {.timeout = std::chrono::seconds(200)});
    ASSERT_EQ(built.exitCode, 0) << built.standardError;
    expectInterruptible({"slide", index, "--path", "127.5", "--export", path("a_%d.stl"), "--json"});
}

TEST_F(CliInterrupt, EndsACheck) { expectInterruptible({"check", bigStl(kBigStl)}); }

} // namespace
} // namespace isoslider::test
