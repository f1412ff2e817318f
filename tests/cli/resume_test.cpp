// Builds that are killed and go on: the index has the bytes that it would have had (preprocess/resume/RESUME.md).

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <random>

#include <fmt/format.h>

#include "tests/cli/cli_fixture.h"
#include "tests/support/repetitions.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

struct BuildCase {
    const char* name;
    std::vector<std::string> options;
    const char* type; ///< of the samples
};

class CliResume : public CliTest, public testing::WithParamInterface<BuildCase> {
protected:
    /// Samples in layers, enough for several checkpoints.
    std::vector<std::string> volume() const {
        const bool isFloat = std::string_view(GetParam().type) == "f32";
        constexpr int kX = 40, kY = 36, kZ = 72;
        if (!fs::exists(folder_ / "a.raw")) {
            std::string bytes;
            std::mt19937 random(3);
            for (int i = 0; i < kX * kY * kZ; ++i) {
                const float sample = static_cast<float>(i % 977) + static_cast<float>(random() % 64);
                if (isFloat)
                    bytes.append(reinterpret_cast<const char*>(&sample), sizeof sample);
                else
                    bytes.push_back(static_cast<char>(static_cast<int>(sample) / 5));
            }
            folder_.write("a.raw", bytes);
        }
        return {path("a.raw"), "--raw-dims", fmt::format("{},{},{}", kX, kY, kZ), "--raw-type", GetParam().type};
    }
    std::vector<std::string> building(const std::string& name, const std::vector<std::string>& more) const {
        std::vector<std::string> words{"build", "-o", path(name), "--no-topology", "--checkpoint", "0"};
        for (const auto& part : {volume(), GetParam().options, more})
            words.insert(words.end(), part.begin(), part.end());
        return words;
    }
    std::string whole() const {
        EXPECT_EQ(run(building("whole.isx", {})).exitCode, 0);
        return readText(path("whole.isx"));
    }
    void expectOnly(const std::vector<std::string>& names) const { EXPECT_EQ(folder_.names(), names); }
    const std::vector<std::string> done_{"a.isx", "a.raw", "whole.isx"};
};

INSTANTIATE_TEST_SUITE_P(Kinds, CliResume,
                         testing::Values(BuildCase{"metacells", {"--index", "metacells"}, "u8"},
                                         BuildCase{"metacellsOfFloats", {"--index", "metacells"}, "f32"},
                                         BuildCase{"edges", {"--index", "edges"}, "u8"},
                                         BuildCase{"edgesOfFloats", {"--index", "edges"}, "f32"},
                                         BuildCase{"mergedEdges", {"--index", "edges", "--lod-error", "2%"}, "u8"}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(CliResume, StartsWhereThereIsNothing) {
    const std::string bytes = whole();
    const auto json = runJson(building("a.isx", {"--resume"}));
    EXPECT_EQ(json["resumed"], false);
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);
}

// Each call that changes the disk is a named step: the program ends in front of it.
TEST_P(CliResume, B089_GoesOnAfterAKillAtEachStep) {
#ifndef ISOSLIDER_HAS_FAILING_CALLS
    GTEST_SKIP() << "sanitizers want to come first themselves";
#else
    const std::string bytes = whole();
    int resumed = 0, kills = 0;
    const bool isLong = repetitions("ISOSLIDER_KILLS", 0) > 0;
    for (int at = 0;; at += isLong ? 1 : 1 + at / 3) {
        ProcessOptions killed;
        killed.environment = {{"LD_PRELOAD", test::builtFile("libisoslider_failing_calls.so")},
                              {"ISO_FAIL_BELOW", folder_.path().string()},
                              {"ISO_FAIL_CALLS", "write"},
                              {"ISO_FAIL_HOW", "kill"},
                              {"ISO_FAIL_AT", std::to_string(at)}};
        const auto first = run(building("a.isx", {}), killed);
        if (first.exitCode == 0)
            break;
        ASSERT_EQ(first.signal, SIGKILL) << first.standardError;
        ++kills;
        // Killed once more a while later, every second time.
        if (kills % 2 == 0) {
            const auto second = run(building("a.isx", {"--resume"}), killed);
            ASSERT_TRUE(second.signal == SIGKILL || second.exitCode == 0) << second.standardError;
        }
        if (!fs::exists(path("a.isx")) || fs::exists(path("a.isx.resume"))) {
            const auto json = runJson(building("a.isx", {"--resume", "--memory", "300M", "--threads", "1"}));
            resumed += json["resumed"] == true ? 1 : 0;
        }
        ASSERT_TRUE(readText(path("a.isx")) == bytes) << "step " << at;
        fs::remove(path("a.isx"));
        fs::remove(path("a.isx.resume.partial"));
    }
    EXPECT_GT(kills, 5);
    EXPECT_GT(resumed, std::string_view(GetParam().name) == "mergedEdges" ? -1 : 2);
#endif
}

TEST_P(CliResume, B089_GoesOnAfterAKillAtAnyMoment) {
    const auto begin = std::chrono::steady_clock::now();
    const std::string bytes = whole();
    const auto time = std::chrono::steady_clock::now() - begin;
    std::mt19937 random(std::getenv("ISOSLIDER_SEED") ? static_cast<unsigned>(std::atoi(std::getenv("ISOSLIDER_SEED")))
                                                      : 5u);
    const long wanted = repetitions("ISOSLIDER_KILLS", 15);
    long killed = 0;
    for (int round = 0; killed < wanted; ++round) {
        for (int inARow = 0; inARow < 4; ++inARow) {
            const auto moment = std::chrono::steady_clock::now() + time * (random() % 1000) / 800;
            ProcessOptions killing;
            killing.signalToSend = SIGKILL;
            killing.signalWhen = [&] { return std::chrono::steady_clock::now() >= moment; };
            const auto result = run(building("a.isx", {"--resume"}), killing);
            ASSERT_TRUE(result.signal == SIGKILL || result.exitCode == 0) << result.standardError;
            if (result.exitCode == 0)
                break;
            ++killed;
        }
        ASSERT_EQ(run(building("a.isx", {"--resume"})).exitCode, 0);
        ASSERT_TRUE(readText(path("a.isx")) == bytes) << "round " << round;
        fs::remove(path("a.isx"));
    }
    ASSERT_EQ(run(building("a.isx", {})).exitCode, 0);
    expectOnly(done_);
}

TEST_F(CliTest, ReplacesAnUnfinishedBuildOfTheOtherKind) {
    const auto volume = noiseVolume(28);
    for (const auto& [first, second] :
         {std::pair<std::string, std::string>{"edges", "metacells"}, {"metacells", "edges"}}) {
        ProcessOptions killed;
        killed.signalToSend = SIGKILL;
        killed.signalWhen = [&] { return fs::exists(path("a.isx.resume")); };
        const auto left = run(
            {"build", volume, "-o", path("a.isx"), "--index", first, "--checkpoint", "0", "--resume", "--no-topology"},
            killed);
        EXPECT_EQ(left.signal, SIGKILL);
        // As such a build leaves it that spilled what it sorts.
        folder_.write("a.isx.sort.partial", "records");
        EXPECT_EQ(run({"build", volume, "-o", path("a.isx"), "--index", second}).exitCode, 0);
        EXPECT_EQ(folder_.names(), (std::vector<std::string>{"a.isx", "noise.mha"})) << first;
        fs::remove(folder_ / "a.isx");
    }
}

// A sort that is larger than its budget, in many partitions: killed while it is written out, and while it is read.
TEST_F(CliTest, GoesOnWithASortOnDisk) {
#ifndef ISOSLIDER_HAS_FAILING_CALLS
    GTEST_SKIP() << "sanitizers want to come first themselves";
#else
    const std::string volume = noiseVolume(84);
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--lod-error", "20%"}}) {
        const auto building = [&](const std::string& name, const std::string& checkpoint) {
            std::vector<std::string> words{"build",         volume,         "-o",       path(name),
                                           "--index",       "edges",        "--memory", "64M",
                                           "--no-topology", "--checkpoint", checkpoint};
            words.insert(words.end(), more.begin(), more.end());
            return words;
        };
        ASSERT_EQ(run(building("whole.isx", "-0")).exitCode, 0);
        const std::string bytes = readText(path("whole.isx"));
        int resumed = 0, kills = 0;
        for (int at = 25;; at += at) {
            ProcessOptions killed;
            killed.environment = {{"LD_PRELOAD", test::builtFile("libisoslider_failing_calls.so")},
                                  {"ISO_FAIL_BELOW", folder_.path().string()},
                                  {"ISO_FAIL_CALLS", "write"},
                                  {"ISO_FAIL_HOW", "kill"},
                                  {"ISO_FAIL_AT", std::to_string(at)}};
            const auto first = run(building("a.isx", "0"), killed);
            if (first.exitCode == 0)
                break;
            ASSERT_EQ(first.signal, SIGKILL) << first.standardError;
            ++kills;
            auto resuming = building("a.isx", "0.1");
            resuming.emplace_back("--resume");
            resumed += runJson(resuming)["resumed"] == true ? 1 : 0;
            ASSERT_TRUE(readText(path("a.isx")) == bytes) << "step " << at;
            fs::remove(path("a.isx"));
        }
        EXPECT_GT(kills, 2);
        EXPECT_GT(resumed, 0);
        fs::remove(path("a.isx"));
        fs::remove(path("whole.isx"));
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"noise.mha"});
    }
#endif
}

class CliUnfinished : public CliResume {
protected:
    /// Kills builds until one leaves a state behind.
    void leaveUnfinished() const {
        for (int attempt = 0; attempt < 200 && !fs::exists(path("a.isx.resume")); ++attempt) {
            ProcessOptions killed;
            killed.signalToSend = SIGKILL;
            killed.signalWhen = [&] { return fs::exists(path("a.isx.resume")); };
            (void)run(building("a.isx", {}), killed);
            fs::remove(path("a.isx"));
        }
        ASSERT_TRUE(fs::exists(path("a.isx.resume")));
        ASSERT_TRUE(fs::exists(path("a.isx.partial")));
    }
};

INSTANTIATE_TEST_SUITE_P(Kinds, CliUnfinished,
                         testing::Values(BuildCase{"metacells", {"--index", "metacells"}, "u8"},
                                         BuildCase{"edges", {"--index", "edges"}, "f32"}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(CliUnfinished, IsGoneOnWithOnRequest) {
    const std::string bytes = whole();
    leaveUnfinished();
    EXPECT_EQ(runJson(building("a.isx", {"--resume"}))["resumed"], true);
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);
}

TEST_P(CliUnfinished, AddsTheTopologyThatAKillHasCutOff) {
    const auto withTopology = [&](const std::string& name, const std::vector<std::string>& more) {
        auto words = building(name, more);
        words.erase(std::find(words.begin(), words.end(), "--no-topology"));
        return words;
    };
    ASSERT_EQ(run(withTopology("whole.isx", {})).exitCode, 0);
    const std::string bytes = readText(path("whole.isx"));
    const auto isComplete = [&] { return readText(path("a.isx.resume")).starts_with("ISOBUILT"); };
    const auto leaveWithoutTopology = [&] {
        for (int attempt = 0; attempt < 200; ++attempt) {
            ProcessOptions killed;
            killed.signalToSend = SIGKILL;
            killed.signalWhen = isComplete;
            (void)run(withTopology("a.isx", {}), killed);
            if (isComplete())
                return;
            fs::remove(path("a.isx"));
        }
        FAIL() << "never killed in time";
    };
    leaveWithoutTopology();
    const auto json = runJson(withTopology("a.isx", {"--resume"}));
    EXPECT_EQ(json["resumed"], true);
    EXPECT_GT(json["topology_events"], 0);
    EXPECT_EQ(json["index_bytes"].get<std::uint64_t>() + json["topology_bytes"].get<std::uint64_t>(), bytes.size());
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);

    fs::remove(path("a.isx"));
    leaveWithoutTopology();
    EXPECT_EQ(runJson(withTopology("a.isx", {"--resume", "--redundancy", "3"}))["resumed"], false);
    expectOnly(done_);
    leaveWithoutTopology();
    fs::resize_file(path("a.isx"), 1000);
    EXPECT_EQ(runJson(withTopology("a.isx", {"--resume"}))["resumed"], false) << "it is not that index any more";
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);
}

TEST_P(CliUnfinished, IsReplacedByAPlainBuildThatStatesSo) {
    const std::string bytes = whole();
    leaveUnfinished();
    const auto result = run(building("a.isx", {}));
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_THAT(result.standardError, HasSubstr("an unfinished build is replaced; --resume would have gone on"));
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);
}

TEST_P(CliUnfinished, IsRefusedWhereItDoesNotFit) {
    const std::string bytes = whole();
    leaveUnfinished();
    expectRefusal(building("a.isx", {"--resume", "--redundancy", "3"}), 3, "begun with other options");
    auto other = building("a.isx", {"--resume"});
    std::string samples = readText(path("a.raw"));
    samples[0] = static_cast<char>(samples[0] + 1);
    folder_.write("a.raw", samples);
    expectRefusal(other, 3, "the volume has changed since");
    other[std::find(other.begin(), other.end(), "--raw-dims") - other.begin() + 1] = "36,40,72";
    expectRefusal(other, 3, "is of another volume");
    EXPECT_TRUE(fs::exists(path("a.isx.resume"))) << "stays as it is";
    EXPECT_TRUE(fs::exists(path("a.isx.partial")));
}

TEST_P(CliUnfinished, StartsAgainWhereItIsDamaged) {
    const std::string bytes = whole();
    leaveUnfinished();
    std::string state = readText(path("a.isx.resume"));
    state[state.size() / 2] = static_cast<char>(~state[state.size() / 2]);
    folder_.write("a.isx.resume", state);
    EXPECT_EQ(runJson(building("a.isx", {"--resume"}))["resumed"], false);
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);
    leaveUnfinished();
    fs::resize_file(path("a.isx.partial"), 10);
    EXPECT_EQ(runJson(building("b.isx", {"--resume"}))["resumed"], false) << "another index";
    fs::remove(path("b.isx"));
    EXPECT_EQ(runJson(building("a.isx", {"--resume"}))["resumed"], false);
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
}

TEST_P(CliUnfinished, AnInterruptLeavesNothingUnlessAsked) {
    const std::string bytes = whole();
    for (const bool resumes : {false, true}) {
        bool isInterrupted = false;
        for (int attempt = 0; attempt < 200 && !isInterrupted; ++attempt) {
            ProcessOptions interrupted;
            interrupted.signalToSend = SIGINT;
            interrupted.signalWhen = [&] { return fs::exists(path("a.isx.resume")); };
            isInterrupted =
                run(building("a.isx", resumes ? std::vector<std::string>{"--resume"} : std::vector<std::string>{}),
                    interrupted)
                    .exitCode == 130;
            fs::remove(path("a.isx"));
        }
        ASSERT_TRUE(isInterrupted);
        EXPECT_EQ(fs::exists(path("a.isx.resume")), resumes);
        EXPECT_EQ(fs::exists(path("a.isx.partial")), resumes);
        EXPECT_TRUE(resumes || folder_.names() == (std::vector<std::string>{"a.raw", "whole.isx"}));
    }
    EXPECT_EQ(runJson(building("a.isx", {"--resume"}))["resumed"], true);
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    expectOnly(done_);
}

} // namespace
} // namespace isoslider::test
