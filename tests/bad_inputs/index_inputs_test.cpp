// B076 to B096: index files, and builds of them. Where a case takes thousands of variants they are tried in this
// process; what users see of a refusal is asked of the program.

#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <random>
#include <thread>

#include <fmt/format.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/format/index_format.h"
#include "core/index/index_reader.h"
#include "preprocess/build_index.h"
#include "tests/bad_inputs/bad_input_fixture.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/repetitions.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_paths.h"

namespace isoslider::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BadIndex : public BadInputTest {
protected:
    static std::string bytesOf(index::IndexKind kind) {
        const TemporaryFolder folder;
        preprocess::BuildOptions options;
        options.kind = kind;
        options.redundancyThreshold = 0.2;
        EXPECT_THAT(buildIndexOf(volume(), folder / "a.isx", options), IsOk());
        return readText(folder / "a.isx");
    }
    static std::shared_ptr<const ScalarGrid> volume() {
        static const auto grid = test::noiseVolume({19, 18, 17}, 8);
        return grid;
    }

    enum class Verdict { Refused, Right, Wrong };
    /// Opens and slides; whatever the bytes are, a surface that is handed out must be the right one.
    Verdict verdictOn(const std::string& bytes) const {
        static const std::vector<double> stops = {3.0, 17.5, 9.0, 0.5};
        static const auto fresh = [] {
            std::vector<extract::SurfaceMesh> meshes;
            for (const double isovalue : stops)
                meshes.push_back(extract::extractFull(*volume(), isovalue).value());
            return meshes;
        }();
        auto engine = extract::SlideEngine::open(folder_.write("damaged.isx", bytes));
        if (!engine.isOk())
            return Verdict::Refused;
        for (std::size_t i = 0; i < stops.size(); ++i) {
            if (!engine.value()->slideTo(stops[i]).isOk())
                return Verdict::Refused;
            if (!isSameSurface(engine.value()->mesh().value(), fresh[i]))
                return Verdict::Wrong;
        }
        return Verdict::Right;
    }
    static constexpr index::IndexKind kKinds[] = {index::IndexKind::Edges, index::IndexKind::Metacells};
};

TEST_F(BadIndex, B076_NoIndexAtAll) {
    const std::string good = bytesOf(index::IndexKind::Edges);
    std::string random(70000, '\0');
    std::mt19937 engine(1);
    for (char& c : random)
        c = static_cast<char>(engine());
    const std::pair<const char*, std::string> files[] = {
        {"empty.isx", ""}, {"one.isx", "I"}, {"random.isx", random}, {"text.isx", "Dear reader,\nthis is a letter.\n"}};
    for (const auto& [name, bytes] : files) {
        folder_.write(name, bytes);
        expectRefusedSoon({"stats", path(name)}, "not an ISOSLIDER index");
        expectRefusedSoon({"extract", path(name), "--isovalue", "1"}, "not an ISOSLIDER index");
        expectRefusedSoon({"slide", path(name), "--path", "1"}, "not an ISOSLIDER index");
    }
    // What begins like one is one, cut off: another refusal, that states how long it should be.
    for (const std::size_t bytes : {std::size_t{12}, std::size_t{63}, std::size_t{64}}) {
        folder_.write("head.isx", good.substr(0, bytes));
        for (const auto& words :
             {std::vector<std::string>{"stats"}, {"info"}, {"extract", "--isovalue", "1"}, {"slide", "--path", "1"}}) {
            auto command = joined({words[0], path("head.isx")}, {words.begin() + 1, words.end()});
            expectRefusedSoon(command, bytes < 64 ? "index ends inside its header"
                                                  : fmt::format("should have {} bytes", good.size()));
        }
    }
}

TEST_F(BadIndex, B077_LaterMajorVersion) {
    for (const auto kind : kKinds) {
        std::string bytes = bytesOf(kind);
        bytes[12] = static_cast<char>(index::kFormatMajor + 5);
        folder_.write("later.isx", bytes);
        const auto result = run({"stats", path("later.isx")});
        expectRefusedSoon({"stats", path("later.isx")}, fmt::format("format version {}", index::kFormatMajor + 5));
        EXPECT_THAT(result.standardError, HasSubstr(fmt::format("this program reads version {}", index::kFormatMajor)));
        EXPECT_THAT(result.standardError, HasSubstr("build it again"));
        for (const auto& words :
             {std::vector<std::string>{"info"}, {"extract", "--isovalue", "1"}, {"slide", "--path", "1"}})
            expectRefusedSoon(joined({words[0], path("later.isx")}, {words.begin() + 1, words.end()}),
                              fmt::format("format version {}", index::kFormatMajor + 5));
        EXPECT_THAT(result.standardError, ::testing::Not(HasSubstr("corrupt")));
    }
}

TEST_F(BadIndex, B078_LaterMinorVersionWithMore) {
    for (const auto kind : kKinds) {
        const std::string bytes = bytesOf(kind);
        index::Preamble preamble = index::decodePreamble(std::as_bytes(std::span(bytes)), bytes.size(), "x").value();
        // What minor 1 to 3 add: a unit of length, what resampling lost, and whether places are a patient's.
        const std::string noneOfThem(4 + 4 + 1, '\0');
        const std::string meta = bytes.substr(preamble.metaOffset) + noneOfThem + "a section of the future";
        preamble.metaBytes = meta.size();
        preamble.metaChecksum = index::metaChecksum(std::as_bytes(std::span(meta)));
        preamble.fileBytes = preamble.metaOffset + meta.size();
        const auto written = [&](std::uint16_t minor) {
            preamble.minor = minor;
            const auto head = index::encodePreamble(preamble);
            return std::string(reinterpret_cast<const char*>(head.data()), head.size()) +
                   bytes.substr(head.size(), preamble.metaOffset - head.size()) + meta;
        };
        EXPECT_EQ(verdictOn(written(index::kFormatMinor + 1)), Verdict::Right);
        EXPECT_EQ(verdictOn(written(index::kFormatMinor)), Verdict::Refused) << "the same bytes are none of its own";
    }
}

TEST_F(BadIndex, B079_EarlierMajorVersions) {
    for (const auto* name : {"golden_v1.isx", "golden_v2.isx", "golden_v3.isx", "golden_v4.isx", "golden_v5.isx"})
        for (const auto& words :
             {std::vector<std::string>{"stats"}, {"info"}, {"extract", "--isovalue", "1"}, {"slide", "--path", "1"}})
            expectRefusedSoon(joined({words[0], std::string(test::sourceFolder()) + "/tests/data/" + name},
                                     {words.begin() + 1, words.end()}),
                              "build it again");
    for (const auto* name : {"golden_v4_metacells.isx", "golden_v5_metacells.isx"}) // whose samples are kept as today
        expectAcceptedSoon({"stats", std::string(test::sourceFolder()) + "/tests/data/" + name});
}

TEST_F(BadIndex, B080_NoFlippedBitGivesAWrongSurface) {
    for (const auto kind : kKinds) {
        const std::string good = bytesOf(kind);
        ASSERT_EQ(verdictOn(good), Verdict::Right);
        const index::Preamble preamble =
            index::decodePreamble(std::as_bytes(std::span(good)), good.size(), "x").value();
        std::mt19937_64 random(3);
        // What each bit does to header, directory and pages is asked in index_damage_test; here, whether a
        // surface that is handed out all the same is the right one.
        int found = 0;
        for (int flip = 0; flip < 600; flip += test::kSparser) {
            const std::uint64_t bit = random() % (8 * good.size());
            std::string bytes = good;
            bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ 1 << bit % 8);
            const Verdict verdict = verdictOn(bytes);
            ASSERT_NE(verdict, Verdict::Wrong) << "bit " << bit;
            found += verdict == Verdict::Refused ? 1 : 0;
            if (bit / 8 < 64 || bit / 8 >= preamble.metaOffset) {
                ASSERT_EQ(verdict, Verdict::Refused) << "bit " << bit;
            }
        }
        EXPECT_GT(found, 100 / static_cast<int>(test::kSparser));
    }
}

TEST_F(BadIndex, B081_NoTruncationGivesASurface) {
    for (const auto kind : kKinds) {
        const std::string good = bytesOf(kind);
        for (std::size_t size = 0; size < good.size(); size += size < 80 || good.size() - size < 80 ? 1 : 509)
            ASSERT_EQ(verdictOn(good.substr(0, size)), Verdict::Refused) << size;
    }
}

TEST_F(BadIndex, B082_LostWrites) {
    for (const auto kind : kKinds) {
        const std::string good = bytesOf(kind);
        for (const std::size_t page : {512, 4096, 65536})
            for (std::size_t at = 0; at < good.size(); at += page * test::kSparser) {
                std::string bytes = good;
                std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), std::min(page, good.size() - at), '\0');
                ASSERT_NE(verdictOn(bytes), Verdict::Wrong) << page << " at " << at;
            }
        EXPECT_EQ(verdictOn(std::string(good.size(), '\0')), Verdict::Refused);
    }
}

// B083 to B085: index_file_test, index_damage_test. B091: build_failures_test. B092: memory_failures_test.

TEST_F(BadIndex, B086_EdgesThatAreActiveAlready) {
    // Level 0's pages listed twice: every change is applied again. All checksums are right.
    const std::string good = bytesOf(index::IndexKind::Edges);
    folder_.write("good.isx", good);
    const auto reader = index::IndexReader::open(path("good.isx"));
    ASSERT_THAT(reader, IsOk());
    index::IndexMeta meta = reader.value()->meta();
    auto& pages = meta.levels[0].pages;
    pages.insert(pages.end(), pages.begin(), pages.end());
    EXPECT_EQ(verdictOn(forgedIndex(good, meta)), Verdict::Refused);
}

TEST_F(BadIndex, B088_NoPlaceToWrite) {
    const std::string bytes = bytesOf(index::IndexKind::Metacells);
    folder_.write("a.isx", bytes);
    fs::permissions(path("a.isx"), fs::perms::owner_read | fs::perms::group_read);
    expectAcceptedSoon({"stats", path("a.isx")});
    const auto volume = sphereVolume();
    expectRefusedSoon({"build", volume, "-o", "/proc/a.isx"}, "/proc/a.isx", 4);
    expectRefusedSoon({"build", volume, "-o", path("none/a.isx")}, "folder", 4);
}

TEST_F(BadIndex, B089_KilledAtAnyMoment) {
    const auto volume = BadInputTest::noiseVolume(kHasSanitizers ? 28 : 44);
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(run({"build", volume, "-o", path("whole.isx")}).exitCode, 0);
    const auto whole = std::chrono::steady_clock::now() - begin;
    const std::string bytes = readText(path("whole.isx"));
    ASSERT_EQ(run({"build", volume, "-o", path("a.isx"), "--no-topology"}).exitCode, 0);
    const std::size_t indexBytes = fs::file_size(path("a.isx"));
    fs::remove(path("a.isx"));
    ASSERT_LT(indexBytes, bytes.size());
    std::mt19937 random(7);
    int absent = 0;
    const long wanted = repetitions("ISOSLIDER_KILLS", 20);
    for (long killed = 0; killed < wanted;) {
        const auto moment = std::chrono::steady_clock::now() + whole * (random() % 1000) / 900;
        ProcessOptions options;
        options.signalToSend = SIGKILL;
        options.signalWhen = [&] { return std::chrono::steady_clock::now() >= moment; };
        killed += run({"build", volume, "-o", path("a.isx")}, options).signal == SIGKILL ? 1 : 0;
        if (fs::exists(path("a.isx"))) {
            // Topology is added once the index is there.
            ASSERT_TRUE(readText(path("a.isx")).substr(0, indexBytes) == bytes.substr(0, indexBytes));
            ASSERT_EQ(run({"extract", path("a.isx"), "--isovalue", "1"}).exitCode, 0);
            fs::remove(path("a.isx"));
        } else {
            ++absent;
        }
    }
    EXPECT_GT(absent, 0);
    ASSERT_EQ(run({"build", volume, "-o", path("a.isx")}).exitCode, 0) << "what a killed build left is in nobody's way";
    EXPECT_TRUE(readText(path("a.isx")) == bytes);
    EXPECT_THAT(folder_.names(), ::testing::ElementsAre("a.isx", "noise.mha", "whole.isx")) << "and is gone";
}

TEST_F(BadIndex, B093_SmallBudget) {
#if ISO_HAS_SANITIZER
    GTEST_SKIP() << "address space says nothing under a sanitizer";
#endif
    // Budgets are of what a build takes beside the program itself.
    const std::uint64_t itself = run({"info", sphereVolume()}).peakRssBytes;
    ProcessOptions options;
    options.timeout = std::chrono::minutes(2);
    options.addressSpaceBytes = std::uint64_t{64 + 256} << 20;
    const auto expectWithin = [&](const std::vector<std::string>& words) {
        const auto result = run(joined(words, {"-o", path("a.isx"), "--memory", "64M"}), options);
        EXPECT_EQ(result.exitCode, 0) << result.standardError;
        EXPECT_LE(result.peakRssBytes - itself, (std::uint64_t{64} << 20) * 11 / 10);
        EXPECT_EQ(folder_.names().size(), 3u);
        fs::remove(path("a.isx"));
    };
    {
        std::ofstream file(path("a.raw"), std::ios::binary);
        std::string plane(512 * 512, '\0');
        for (int z = 0; z < 512; ++z) {
            for (std::size_t i = 0; i < plane.size(); ++i)
                plane[i] = static_cast<char>((i % 512 * 3 + i / 512 * z / 64 + (i * 2654435761u >> 27)) / 8);
            file << plane;
        }
    }
    expectWithin({"build", path("a.raw"), "--raw-dims", "512,512,512", "--raw-type", "u8", "--index", "metacells"});
    fs::remove(path("a.raw"));
    // Topology is analysed afterwards, and in noise exceeds a budget as small as this before it gives up.
    expectWithin({"build", BadInputTest::noiseVolume(96), "--index", "edges", "--no-topology"});
}

TEST_F(BadIndex, B094_BudgetsThatAreNone) {
    const auto volume = sphereVolume();
    expectRefusedSoon({"build", volume, "-o", path("a.isx"), "--memory", "1M"}, "64 MiB", 2);
    for (const auto* text : {"-5", "12parsecs", "", "0", "1e999", "99999999999999999999G"})
        expectRefusedSoon({"build", volume, "-o", path("a.isx"), "--memory", text}, "--memory", 2);
    for (const auto* text : {"67108863", "65535K", "63M", "1"}) // less than the least
        expectRefusedSoon({"build", volume, "-o", path("a.isx"), "--memory", text}, "64 MiB", 2);
    EXPECT_FALSE(fs::exists(path("a.isx")));
}

TEST_F(BadIndex, B095_TwoBuildsOfOneIndex) {
    const auto volume = BadInputTest::noiseVolume(kHasSanitizers ? 64 : 96);
    for (const bool hasEarlier : {false, true}) {
        if (hasEarlier) {
            ASSERT_EQ(run({"build", sphereVolume(), "-o", path("a.isx")}).exitCode, 0);
        }
        const std::string earlier = hasEarlier ? readText(path("a.isx")) : "";
        std::optional<ProcessResult> second, viewer;
        ProcessOptions stopped;
        stopped.timeout = std::chrono::minutes(5); // the first one stands still while the others run
        stopped.signalToSend = SIGSTOP;
        stopped.signalWhen = [&] {
            // The first to come makes the file for a moment before it begins; it may go between two questions.
            std::error_code none;
            const auto size = fs::file_size(path("a.isx.partial"), none);
            return !none && size > 0;
        };
        stopped.whileStopped = [&] {
            ASSERT_TRUE(fs::exists(path("a.isx.partial"))) << "still being written";
            viewer = run({"extract", path("a.isx"), "--isovalue", "5", "--json"});
            second = run({"build", volume, "-o", path("a.isx")});
            EXPECT_EQ(hasEarlier, fs::exists(path("a.isx")));
            EXPECT_TRUE(!hasEarlier || readText(path("a.isx")) == earlier);
        };
        const auto first = run({"build", volume, "-o", path("a.isx"), "--index", "edges", "--no-topology"}, stopped);
        ASSERT_TRUE(second);
        EXPECT_EQ(first.exitCode, 0) << first.standardError;
        EXPECT_EQ(second->exitCode, 3) << second->standardError;
        EXPECT_THAT(second->standardError, HasSubstr("is being written by another program"));
        EXPECT_EQ(viewer->exitCode, hasEarlier ? 0 : 4) << "the earlier one, or none";
        EXPECT_EQ(viewer->standardOutput.find("\"euler\":2") != std::string::npos, hasEarlier)
            << viewer->standardOutput;
        const auto stats = runJson({"stats", path("a.isx")});
        EXPECT_EQ(stats["kind"], "edges") << "the first one's";
        EXPECT_EQ(stats["source_name"], "noise.mha");
        fs::remove(path("a.isx"));
    }
}

TEST_F(BadIndex, B096_FileThatShrinksWhileItIsRead) {
    for (const auto kind : kKinds) {
        const std::string good = bytesOf(kind);
        for (const std::size_t left : {std::size_t{0}, std::size_t{64}, good.size() / 2}) {
            folder_.write("a.isx", good);
            auto engine = extract::SlideEngine::open(path("a.isx"));
            ASSERT_THAT(engine, IsOk());
            fs::resize_file(path("a.isx"), left);
            const auto moved = engine.value()->slideTo(9.0);
            if (left <= 64) {
                EXPECT_FALSE(moved.isOk()) << left;
            } else if (moved.isOk()) { // what it needs lay before the end
                EXPECT_TRUE(
                    isSameSurface(engine.value()->mesh().value(), extract::extractFull(*volume(), 9.0).value()));
            }
        }
    }
}

} // namespace
} // namespace isoslider::test
