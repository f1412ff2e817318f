#include <csignal>
#include <fstream>

#include <unistd.h>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

using ::testing::ElementsAre;

class CliBuild : public CliTest {};

TEST_F(CliBuild, UsesNoMoreThreadsThanThereAreCores) {
    for (const auto* kind : {"metacells", "edges"}) {
        const auto result =
            run({"build", sphereVolume(), "-o", path("a.isx"), "--threads", "1024", "--index", kind, "-q"});
        EXPECT_EQ(result.exitCode, 0);
        EXPECT_EQ(result.standardError, "") << "none of TBB";
    }
}

TEST_F(CliBuild, ReportsWhatItBuilt) {
    const auto volume = sphereVolume();
    const auto json =
        runJson({"build", volume, "-o", path("a.isx"), "--memory", "64M", "--threads", "2", "--index", "edges"});
    EXPECT_THAT(keysOf(json),
                ElementsAre("seconds", "peak_rss_bytes", "forecast_bytes", "index_bytes", "forecast_topology_bytes",
                            "forecast_temporary_bytes", "temporary_bytes", "distinct_values", "levels", "kind",
                            "resumed", "topology_events", "topology_bytes", "topology_seconds"));
    EXPECT_NEAR(json["forecast_bytes"].get<double>(), json["index_bytes"].get<double>(),
                0.15 * json["index_bytes"].get<double>());
    EXPECT_LE(json["temporary_bytes"], json["forecast_temporary_bytes"]);
    EXPECT_THAT(run({"build", volume, "-o", path("b.isx")}).standardOutput, ::testing::HasSubstr("\nforecast: "));
    EXPECT_GT(json["topology_bytes"], 0);
    EXPECT_EQ(json["index_bytes"].get<std::uint64_t>() + json["topology_bytes"].get<std::uint64_t>(),
              std::filesystem::file_size(path("a.isx")))
        << "topology lies behind it";
    EXPECT_EQ(json["topology_events"], runJson({"topology", path("a.isx")})["event_count"]);
    const auto bare = runJson({"build", volume, "-o", path("a.isx"), "--no-topology", "--index", "edges"});
    EXPECT_FALSE(bare.contains("topology_events"));
    EXPECT_EQ(bare["index_bytes"], std::filesystem::file_size(path("a.isx")));
    EXPECT_EQ(json["distinct_values"], runJson({"info", volume})["distinct_values"]);
    ASSERT_FALSE(json["levels"].empty());
    EXPECT_EQ(json["levels"][0]["blocks"], json["distinct_values"]);
    EXPECT_EQ(json["kind"], "edges");
    EXPECT_THAT(folder_.names(), ElementsAre("a.isx", "b.isx", "sphere.mha"));
}

// The size of the program that starts another one is no part of that one's memory.
TEST_F(CliBuild, ReportsItsOwnPeakMemory) {
    const std::string ballast(std::size_t{768} << 20, 'x');
    const auto volume = sphereVolume();
    const auto built = runJson({"build", volume, "-o", path("a.isx")});
    EXPECT_GT(built["peak_rss_bytes"], 1 << 20);
    EXPECT_LT(built["peak_rss_bytes"], ballast.size() / 2);
    EXPECT_LT(runJson({"slide", path("a.isx"), "--path", "5,6"})["peak_rss_bytes"], ballast.size() / 2);
}

TEST_F(CliBuild, BuildsTheKindAskedFor) {
    const auto volume = sphereVolume();
    EXPECT_EQ(runJson({"build", volume, "-o", path("auto.isx")})["kind"], "metacells");
    for (const std::string kind : {"edges", "metacells"}) {
        const auto index = path(kind + ".isx");
        EXPECT_EQ(runJson({"build", volume, "-o", index, "--index", kind})["kind"], kind);
        EXPECT_EQ(runJson({"stats", index})["kind"], kind);
    }
    EXPECT_LT(std::filesystem::file_size(path("metacells.isx")), std::filesystem::file_size(path("edges.isx")));
    const auto slide = [&](const char* index) {
        auto json = runJson({"slide", path(index), "--path", "5,5.5,3"});
        std::vector<std::uint64_t> facts;
        for (const auto& step : json["steps"])
            for (const char* key : {"edges_added", "edges_removed", "active_edges", "triangles"})
                facts.push_back(step[key]);
        return facts;
    };
    EXPECT_EQ(slide("edges.isx"), slide("metacells.isx"));
    EXPECT_THAT(run({"stats", path("metacells.isx")}).standardOutput, ::testing::HasSubstr("bricks        entries"));
}

TEST_F(CliBuild, WritesTheSameBytesForAnyThreadsAndMemory) {
    // All samples different; and few values, many of whose events are at one isovalue.
    std::string ties(40 * 40 * 40, '\0');
    std::mt19937 random(7);
    std::generate(ties.begin(), ties.end(), [&] { return static_cast<char>(random() % 200); });
    const auto tied = folder_.write("ties.mha", metaImage(40, "MET_UCHAR", ties)).string();
    for (const auto& volume : {noiseVolume(24), tied}) {
        ASSERT_EQ(run({"build", volume, "-o", path("a.isx"), "--threads", "1", "--memory", "256M"}).exitCode, 0);
        ASSERT_EQ(run({"build", volume, "-o", path("b.isx"), "--threads", "3", "--memory", "2G"}).exitCode, 0);
        EXPECT_TRUE(readText(path("a.isx")) == readText(path("b.isx"))) << volume;
    }
}

TEST_F(CliBuild, WritesTheLevelsAskedFor) {
    const auto json = runJson({"build", sphereVolume(), "-o", path("a.isx"), "--skip-levels", "2", "--index", "edges"});
    EXPECT_EQ(json["levels"].size(), 2U);
}

TEST_F(CliBuild, ReplacesAnEarlierIndex) {
    folder_.write("a.isx", "an earlier file");
    ASSERT_EQ(run({"build", sphereVolume(), "-o", path("a.isx")}).exitCode, 0);
    EXPECT_EQ(run({"info", path("a.isx")}).exitCode, 0);
}

TEST_F(CliBuild, RefusesOutputsBeforeWork) {
    const auto volume = sphereVolume();
    expectRefusal({"build", volume}, 2, "--output");
    expectRefusal({"build", volume, "-o", volume}, 2, "is the input");
    std::filesystem::create_symlink(volume, path("link.isx"));
    expectRefusal({"build", volume, "-o", path("link.isx")}, 2, "is the input");
    expectRefusal({"build", volume, "-o", folder_.path().string()}, 4, "directory");
    expectRefusal({"build", volume, "-o", path("missing/a.isx")}, 4, "folder");
    expectRefusal({"build", volume, "-o", volume + "/a.isx"}, 4, "folder");
    EXPECT_EQ(run({"info", volume}).exitCode, 0) << "the volume is as it was";
}

TEST_F(CliBuild, RefusesAFolderThatMayNotBeWrittenTo) {
    if (::geteuid() == 0)
        GTEST_SKIP() << "root may write everywhere";
    std::filesystem::create_directory(path("locked"));
    std::filesystem::permissions(path("locked"), std::filesystem::perms::owner_read);
    expectRefusal({"build", sphereVolume(), "-o", path("locked/a.isx")}, 4);
}

TEST_F(CliBuild, LeavesNothingWhenTheInputIsRefused) {
    const auto whole = readText(sphereVolume());
    folder_.write("cut.mha", whole.substr(0, whole.size() / 2));
    expectRefusal({"build", path("cut.mha"), "-o", path("a.isx"), "--json"}, 3, "cut.mha");
    expectRefusal({"build", path("missing.mha"), "-o", path("a.isx")}, 4, "missing.mha");
    expectRefusal({"build", sphereIndex("b.isx"), "-o", path("a.isx")}, 3, "is an index");
    EXPECT_THAT(folder_.names(), ElementsAre("b.isx", "cut.mha", "sphere.mha"));
}

class CliInterruptedBuild : public CliBuild, public ::testing::WithParamInterface<int> {};

TEST_P(CliInterruptedBuild, LeavesNothingBehind) {
    const auto volume = noiseVolume(112);
    ProcessOptions options;
    options.timeout = std::chrono::seconds(50);
    options.signalToSend = GetParam();
    options.signalWhen = [this] { return folder_.names().size() > 1; };
    const auto result = run({"build", volume, "-o", path("a.isx"), "--memory", "64M"}, options);
    EXPECT_EQ(result.exitCode, 130) << result.standardError;
    EXPECT_EQ(result.standardError, "isoslider-cli: interrupted\n");
    EXPECT_THAT(folder_.names(), ElementsAre("noise.mha"));
}

class CliChangedVolume : public CliBuild, public ::testing::WithParamInterface<std::string> {};

INSTANTIATE_TEST_SUITE_P(Kinds, CliChangedVolume, ::testing::Values("edges", "metacells"));

TEST_P(CliChangedVolume, IsRefused) {
    const auto volume = noiseVolume(GetParam() == "edges" ? 112 : 240);
    ProcessOptions options;
    options.timeout = std::chrono::seconds(50);
    options.signalToSend = SIGCONT; // does nothing
    options.signalWhen = [&] {
        if (folder_.names().size() == 1)
            return false;
        std::fstream file(volume, std::ios::in | std::ios::out | std::ios::binary); // in place
        file.seekp(std::int64_t{1} << 20);
        file << std::string(100'000, 'x');
        return true;
    };
    const auto result = run({"build", volume, "-o", path("a.isx"), "--index", GetParam()}, options);
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_EQ(result.standardError, "isoslider-cli: " + volume + ": changed while it was read\n");
    EXPECT_THAT(folder_.names(), ElementsAre("noise.mha"));
}

INSTANTIATE_TEST_SUITE_P(Signals, CliInterruptedBuild, ::testing::Values(SIGINT, SIGTERM));

class CliUninterruptedBuild : public CliBuild, public ::testing::WithParamInterface<int> {};

TEST_P(CliUninterruptedBuild, GoesOnAtASignalThatWasIgnoredAtItsStart) {
    const auto volume = noiseVolume(64);
    ProcessOptions options;
    options.timeout = std::chrono::seconds(50);
    options.ignoredSignals = {GetParam()};
    options.signalToSend = GetParam();
    options.signalWhen = [this] { return folder_.names().size() > 1; };
    const auto result = run({"build", volume, "-o", path("a.isx"), "--memory", "64M", "--no-topology"}, options);
    EXPECT_EQ(result.exitCode, 0) << result.standardError;
    EXPECT_EQ(result.signal, 0);
    EXPECT_THAT(folder_.names(), ElementsAre("a.isx", "noise.mha"));
}

INSTANTIATE_TEST_SUITE_P(Signals, CliUninterruptedBuild, ::testing::Values(SIGINT, SIGTERM, SIGHUP));

class CliStats : public CliTest {};

TEST_F(CliStats, TellsOfTheIndexAndItsLevels) {
    const auto json = runJson({"stats", edgesIndex()});
    EXPECT_THAT(keysOf(json), ElementsAre("source_name", "kind", "dims", "scalar_type", "distinct_values",
                                          "average_active_edges", "average_change", "redundancy", "index_bytes",
                                          "bytes_per_voxel", "sample_bytes", "levels"));
    EXPECT_EQ(json["source_name"], "sphere.mha");
    EXPECT_THAT(keysOf(json["levels"][0]),
                ElementsAre("level", "blocks", "points", "edges", "activated_edges", "bytes", "redundant_removed"));
    EXPECT_EQ(json["levels"][0]["points"], 16 * 16 * 16);
    // Every edge comes and goes once; those through the middle have equal ends and are never active.
    EXPECT_EQ(json["levels"][0]["edges"], 2 * (3 * 16 * 16 * 15 - 3 * 16 * 16));
    EXPECT_GT(json["average_active_edges"], 0.0);
    EXPECT_GT(json["sample_bytes"], 1000);
}

TEST_F(CliStats, ShowsBothTables) {
    const auto text = run({"stats", edgesIndex()}).standardOutput;
    EXPECT_THAT(text, ::testing::HasSubstr("Table 1"));
    EXPECT_THAT(text, ::testing::HasSubstr("Table 2"));
    EXPECT_THAT(text, ::testing::HasSubstr("  samples               "));
    EXPECT_THAT(text, ::testing::HasSubstr("16x16x16"));
}

TEST_F(CliStats, TellWithinWhichErrorCellsAreMerged) {
    const auto index = edgesIndex("merged.isx", {"--lod-error", "0.3c"});
    EXPECT_EQ(runJson({"stats", index})["lod_error"], "0.3c");
    EXPECT_THAT(run({"stats", index}).standardOutput, ::testing::HasSubstr("error                 0.3 cells\n"));
}

TEST_F(CliStats, RefusesWhatIsNoIndex) {
    expectRefusal({"stats", sphereVolume()}, 3, "sphere.mha");
    expectRefusal({"stats", path("missing.isx")}, 4, "missing.isx");
    expectRefusal({"stats", folder_.path().string()}, 3);
}

} // namespace isoslider::test
