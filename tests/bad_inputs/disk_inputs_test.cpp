// B088, B089, B091 and B096: disks that are full, read-only, faulty or gone, and programs killed at each
// step, all of them asked of the real program, whose system calls fail when told to
// (tests/support/failing_calls.cpp).

#include <sys/resource.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "tests/bad_inputs/bad_input_fixture.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class BadDisk : public BadInputTest {
protected:
    void SetUp() override {
#ifndef ISOSLIDER_HAS_FAILING_CALLS
        GTEST_SKIP() << "sanitizers want to be loaded first themselves";
#endif
        volume_ = sphereVolume();
    }
    ProcessResult runFailing(const std::vector<std::string>& arguments, const char* calls, const std::string& how,
                             long at = 0) const {
        ProcessOptions options;
#ifdef ISOSLIDER_HAS_FAILING_CALLS
        options.environment = {{"LD_PRELOAD", test::builtFile("libisoslider_failing_calls.so")},
                               {"ISO_FAIL_BELOW", folder_.path().string()},
                               {"ISO_FAIL_CALLS", calls},
                               {"ISO_FAIL_HOW", how},
                               {"ISO_FAIL_AT", std::to_string(at)}};
#endif
        return run(arguments, options);
    }
    std::vector<std::string> build(const char* kind) const {
        return {"build", volume_, "-o", path("a.isx"), "--index", kind, "--threads", "1"};
    }
    /// What a build without faults writes.
    std::string wholeIndex(const char* kind) const {
        EXPECT_EQ(run({"build", volume_, "-o", path("whole.isx"), "--index", kind}).exitCode, 0);
        const std::string bytes = readText(path("whole.isx"));
        fs::remove(path("whole.isx"));
        return bytes;
    }
    /// The same without topology: what a build writes first.
    std::string bareIndex(const char* kind) const {
        EXPECT_EQ(run({"build", volume_, "-o", path("bare.isx"), "--index", kind, "--no-topology"}).exitCode, 0);
        const std::string bytes = readText(path("bare.isx"));
        fs::remove(path("bare.isx"));
        return bytes;
    }
    /// Exit 4 and a line, an earlier a.isx as it was, and nothing beside it.
    void expectCleanFailure(const ProcessResult& result, const std::string& earlier) const {
        EXPECT_EQ(result.exitCode, 4) << result.signal << ' ' << result.standardError;
        EXPECT_EQ(result.standardOutput, "");
        EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1)
            << result.standardError;
        EXPECT_THAT(folder_.names(), ElementsAre("a.isx", "sphere.mha"));
        EXPECT_TRUE(readText(path("a.isx")) == earlier);
    }

    std::string volume_;
};

TEST_F(BadDisk, B088_ADiskThatTakesNoMore) {
    // FAT32 takes 4 GiB a file and states EFBIG; a medium may turn read-only, a server may go.
    const std::string whole = wholeIndex("edges");
    for (const int error : {EFBIG, EROFS, EACCES, EPERM, EDQUOT, ESTALE, ETIMEDOUT})
        for (const long at : {0, 2}) {
            folder_.write("a.isx", "an earlier file");
            const auto result = runFailing(build("edges"), "write", fmt::format("errno {}", error), at);
            expectCleanFailure(result, "an earlier file");
            EXPECT_THAT(result.standardError, HasSubstr("a.isx")) << error;
        }
    // A limit that the shell has set (ulimit -f) comes with a signal.
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{20'000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const auto limited = run(build("edges"));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    expectCleanFailure(limited, "an earlier file");
    EXPECT_THAT(limited.standardError, HasSubstr("File too large"));
}

TEST_F(BadDisk, B088_WhatCannotBeWrittenIsRefusedBeforeTheVolumeIsRead) {
    // Of this one the header can be read within a second, but not the samples.
    const std::string large = folder_.write("large.mha", metaImage(1600, "MET_UCHAR", "")).string();
    fs::resize_file(large, fs::file_size(large) + std::uint64_t{1600} * 1600 * 1600);
    for (const std::string& output :
         {std::string("/proc/a"), path("none/a"), path("sphere.mha/a"), path(std::string(246, 'x'))}) {
        expectRefusedSoon({"build", large, "-o", output + ".isx"}, output, 4);
        expectRefusedSoon({"resample", large, "-o", output + ".mha", "--size", "4,4,4"}, output, 4);
        expectRefusedSoon({"extract", large, "--isovalue", "1", "-o", output + ".ply"}, output, 4);
    }
    EXPECT_THAT(folder_.names(), ElementsAre("large.mha", "sphere.mha"));
}

TEST_F(BadDisk, B089_KilledAtEachStep) {
    for (const auto* kind : {"edges", "metacells"}) {
        const std::string whole = wholeIndex(kind), bare = bareIndex(kind);
        int withEarlier = 0, withLater = 0;
        for (long step = 0;; ++step) {
            ASSERT_LT(step, 500);
            folder_.write("a.isx", "an earlier file");
            const auto result = runFailing(build(kind), "write", "kill", step);
            const std::string there = readText(path("a.isx"));
            if (result.signal == 0) {
                EXPECT_EQ(result.exitCode, 0) << result.standardError;
                EXPECT_TRUE(there == whole);
                break;
            }
            EXPECT_EQ(result.signal, SIGKILL);
            const bool isLater = there != "an earlier file"; // topology, or a part of it, lies behind the index
            ASSERT_TRUE(!isLater || there.starts_with(bare)) << step;
            if (isLater) {
                EXPECT_EQ(run({"extract", path("a.isx"), "--isovalue", "5"}).exitCode, 0) << step;
                EXPECT_EQ(run({"topology", path("a.isx"), "--at", "5"}).exitCode, 0);
            }
            (isLater ? withLater : withEarlier)++;
        }
        EXPECT_GT(withEarlier, 3) << kind;
        EXPECT_GT(withLater, 0) << kind;
        EXPECT_THAT(folder_.names(), ElementsAre("a.isx", "sphere.mha")) << "what killed builds left is gone";
    }
}

TEST_F(BadDisk, B091_EachCallFailsInTurn) {
    for (const auto* kind : {"edges", "metacells"}) {
        const std::string whole = wholeIndex(kind), bare = bareIndex(kind);
        for (const int error : {EIO, ENOSPC})
            for (long call = 0;; ++call) {
                ASSERT_LT(call, 500);
                folder_.write("a.isx", "an earlier file");
                const auto result = runFailing(build(kind), "write", fmt::format("errno {}", error), call);
                if (result.exitCode == 0 && readText(path("a.isx")) == whole)
                    break;
                if (readText(path("a.isx")).starts_with(bare)) { // it has its name; what followed failed
                    EXPECT_EQ(result.exitCode, 4);
                    continue;
                }
                SCOPED_TRACE(fmt::format("{}, call {}, error {}", kind, call, error));
                expectCleanFailure(result, "an earlier file");
                EXPECT_THAT(result.standardError, HasSubstr(std::strerror(error)));
            }
    }
}

TEST_F(BadDisk, B091_TheDiskIsFullAtAnyPlace) {
    const int places = std::getenv("ISOSLIDER_LONG_TESTS") != nullptr ? 200 : 40;
    for (const auto* kind : {"edges", "metacells"}) {
        const auto withTopology = static_cast<long>(wholeIndex(kind).size());
        const std::string index = bareIndex(kind);
        const auto whole = static_cast<long>(index.size());
        ASSERT_LT(whole, withTopology);
        for (int place = 0; place < 10; ++place) { // behind the index
            const auto result =
                runFailing(build(kind), "write", "full", whole + 100 + (withTopology - whole - 100) * place / 10);
            SCOPED_TRACE(fmt::format("{}, topology, {} of 10", kind, place));
            EXPECT_EQ(result.exitCode, 4);
            EXPECT_THAT(result.standardError, HasSubstr("No space left"));
            EXPECT_THAT(result.standardError, HasSubstr("the index is complete"));
            EXPECT_TRUE(readText(path("a.isx")) == index) << "nothing half-written is left behind it";
        }
        for (int place = 0; place < places; ++place) {
            folder_.write("a.isx", "an earlier file");
            const auto result = runFailing(build(kind), "write", "full", whole * place / places);
            SCOPED_TRACE(fmt::format("{}, {} of {}", kind, place, places));
            expectCleanFailure(result, "an earlier file");
            EXPECT_THAT(result.standardError, HasSubstr("No space left"));
        }
        fs::remove(path("a.isx"));
        const auto mesh =
            runFailing({"extract", volume_, "--isovalue", "5", "-o", path("a.isx.ply")}, "write", "full", 1000);
        EXPECT_EQ(mesh.exitCode, 4) << mesh.standardError;
        EXPECT_THAT(folder_.names(), ElementsAre("sphere.mha"));
    }
}

TEST_F(BadDisk, B091_ShortAndInterruptedCallsAreGoneOnWith) {
    for (const auto* kind : {"edges", "metacells"}) {
        const std::string whole = wholeIndex(kind);
        for (const auto* calls : {"write", "read"})
            for (const auto* how : {"short", "interrupted"}) {
                SCOPED_TRACE(fmt::format("{}: {} {}", kind, calls, how));
                const auto built = runFailing(build(kind), calls, how);
                EXPECT_EQ(built.exitCode, 0) << built.standardError;
                EXPECT_TRUE(readText(path("a.isx")) == whole);
                const auto slid =
                    runFailing({"slide", path("a.isx"), "--path", "5,3,7", "--export", path("s_%d.off")}, calls, how);
                EXPECT_EQ(slid.exitCode, 0) << slid.standardError;
            }
    }
}

TEST_F(BadDisk, B096_ADiskThatGoesWhileItIsRead) {
    for (const auto* kind : {"edges", "metacells"})
        ASSERT_EQ(run({"build", volume_, "-o", path(std::string(kind) + ".isx"), "--index", kind}).exitCode, 0);
    for (const auto& words : {std::vector<std::string>{"info", volume_},
                              {"extract", volume_, "--isovalue", "5"},
                              build("edges"),
                              {"slide", path("edges.isx"), "--path", "5,3,7"},
                              {"slide", path("metacells.isx"), "--path", "5,3,7"},
                              {"stats", path("metacells.isx")}}) {
        int failures = 0;
        for (long call = 0; call < 200; ++call) {
            SCOPED_TRACE(fmt::format("{}, read {}", fmt::join(words, " "), call));
            const auto result = runFailing(words, "read", fmt::format("errno {}", EIO), call);
            ASSERT_EQ(result.signal, 0);
            if (result.exitCode == 0)
                break;
            ++failures;
            EXPECT_EQ(result.exitCode, 4) << result.standardError;
            EXPECT_EQ(std::count(result.standardError.begin(), result.standardError.end(), '\n'), 1)
                << result.standardError;
            if (fs::exists(path("a.isx"))) {
                EXPECT_THAT(result.standardError, HasSubstr("the index is complete"));
                fs::remove(path("a.isx"));
            }
        }
        EXPECT_GT(failures, 0) << words[0];
        EXPECT_LT(failures, 200) << words[0];
        fs::remove(path("a.isx"));
    }
}

TEST_F(BadDisk, B096_AClockThatRunsBackwards) {
    const std::string whole = wholeIndex("edges");
    const auto built = runFailing(build("edges"), "", "clock");
    EXPECT_EQ(built.exitCode, 0) << built.standardError;
    EXPECT_TRUE(readText(path("a.isx")) == whole);
    const auto slid = runFailing({"slide", path("a.isx"), "--path", "5,3,7", "--json"}, "", "clock");
    EXPECT_EQ(slid.exitCode, 0) << slid.standardError;
    const auto steps = OrderedJson::parse(slid.standardOutput)["steps"];
    EXPECT_EQ(steps.size(), 3u);
    for (const auto& step : steps)
        EXPECT_GE(step["update_ms"], 0.0);
}

} // namespace
} // namespace isoslider::test
