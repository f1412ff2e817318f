// An index kept between runs counts for the bytes that it was built from and for no others.
#include <chrono>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume_io/volume_reader.h"
#include "preprocess/build_index.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"
#include "ui/model/session/dataset.h"
#include "ui/model/session/index_cache.h"

namespace isoslider::model {
namespace {

namespace fs = std::filesystem;
using test::HasError;
using test::IsOk;

class IndexCacheTest : public ::testing::Test {
protected:
    IndexCacheTest() { fs::create_directory(folder_ / "volumes"); }

    /// 6^3 bytes that rise along x, in a file beside the header.
    fs::path writeVolume(const std::string& name = "volumes/head.mhd", const std::string& data = "skull.raw") {
        std::string samples;
        for (int i = 0; i < 6 * 6 * 6; ++i)
            samples += static_cast<char>(10 * (i % 6));
        const fs::path path = folder_.write(
            name, "ObjectType = Image\nNDims = 3\nDimSize = 6 6 6\nElementType = MET_UCHAR\nElementDataFile = " + data +
                      "\n");
        folder_.write((fs::path(name).parent_path() / data).string(), samples);
        return path;
    }
    /// As a session does it: what of the volume is in the cache, and, if nothing is, its index, built and recorded.
    LoadedDataset open(const fs::path& path) {
        OpenRequest request;
        request.path = path;
        auto loaded = loadDataset(request, cache_, {}, 1u << 20, {});
        EXPECT_THAT(loaded, IsOk());
        const Dataset& dataset = loaded.value().dataset;
        if (loaded.value().grid) {
            fs::create_directories(cache_.folder());
            const auto source = io::openVolume(path);
            preprocess::BuildOptions build;
            build.kind = kind_;
            EXPECT_THAT(preprocess::buildIndex(*source.value(), dataset.indexPath, build, {}), IsOk());
            EXPECT_THAT(IndexCache::record(dataset.indexPath, *dataset.stamp, "", {}), IsOk());
        }
        return std::move(loaded).value();
    }
    bool opensFromCache(const fs::path& path) { return open(path).engine != nullptr; }
    /// One byte is another; the modification time states that nothing happened.
    static void changeOneByte(const fs::path& path) {
        const auto time = fs::last_write_time(path);
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(100);
        file.put('\x7f');
        file.close();
        fs::last_write_time(path, time);
    }

    test::TemporaryFolder folder_;
    IndexCache cache_{folder_ / "cache"};
    index::IndexKind kind_ = index::IndexKind::Metacells;
};

TEST_F(IndexCacheTest, NamesAreOfThePlaceAndTheReading) {
    const fs::path volume = "/volumes/head.raw";
    EXPECT_EQ(cache_.pathForFile(volume), cache_.pathForFile(volume));
    EXPECT_EQ(cache_.pathForFile(volume).parent_path(), cache_.folder());
    EXPECT_EQ(cache_.pathForFile(volume).extension(), ".isx");
    EXPECT_NE(cache_.pathForFile(volume), cache_.pathForFile("/others/head.raw"));
    EXPECT_NE(cache_.pathForFile(volume, "u8"), cache_.pathForFile(volume, "u16"));
    EXPECT_NE(cache_.pathForSample("shell"), cache_.pathForSample("bluntfin"));
}

TEST_F(IndexCacheTest, AnUnchangedVolumeOpensFromItsIndex) {
    const auto path = writeVolume();
    EXPECT_FALSE(opensFromCache(path));
    EXPECT_TRUE(opensFromCache(path));
}

TEST_F(IndexCacheTest, AnIndexOfEdgesIsBuiltAnewAsItsCellsDoNotMerge) {
    kind_ = index::IndexKind::Edges; // as an earlier version may have built
    const auto path = writeVolume();
    open(path);
    EXPECT_FALSE(opensFromCache(path));
    kind_ = index::IndexKind::Metacells;
    open(path);
    EXPECT_TRUE(opensFromCache(path));
}

TEST_F(IndexCacheTest, B087_OneByteChangedWithItsTimeKeptIsStale) {
    const auto path = writeVolume();
    open(path);
    changeOneByte(folder_ / "volumes/skull.raw"); // a data file of another name than the header's
    const auto loaded = open(path);
    EXPECT_EQ(loaded.engine, nullptr);
    EXPECT_THAT(loaded.dataset.notes, testing::Contains(testing::HasSubstr("changed since its index was built")));
    EXPECT_EQ(loaded.dataset.max, 127.0) << "the samples shown are the present ones";
    EXPECT_EQ(open(path).dataset.max, 127.0) << "and so is the index that replaced the stale one";
}

TEST_F(IndexCacheTest, B087_AFileThatWasOnlyTouchedIsAccepted) {
    const auto path = writeVolume();
    open(path);
    fs::last_write_time(folder_ / "volumes/skull.raw", fs::file_time_type::clock::now() + std::chrono::hours(2));
    EXPECT_TRUE(opensFromCache(path));
}

TEST_F(IndexCacheTest, B087_AVolumeThatMovedBringsItsIndexAlong) {
    const auto path = writeVolume();
    const fs::path index = open(path).dataset.indexPath;
    std::ofstream(index.string() + ".levels") << "ISOLEVEL";
    fs::rename(folder_ / "volumes", folder_ / "archive");
    EXPECT_TRUE(opensFromCache(folder_ / "archive/head.mhd"));
    EXPECT_EQ(cache_.usage().indexes, 1u);
    EXPECT_EQ(std::distance(fs::directory_iterator(cache_.folder()), {}), 4)
        << "an index, its lazy levels, its record, its last use";
    EXPECT_FALSE(fs::exists(index.string() + ".levels"));
    writeVolume("archive/head.mhd");
    changeOneByte(folder_ / "archive/skull.raw");
    fs::rename(folder_ / "archive", folder_ / "volumes");
    EXPECT_FALSE(opensFromCache(path)) << "moved and changed";
}

TEST_F(IndexCacheTest, B087_ACopyDoesNotTakeTheIndexAway) {
    const auto path = writeVolume();
    open(path);
    fs::copy(folder_ / "volumes", folder_ / "copies");
    EXPECT_FALSE(opensFromCache(folder_ / "copies/head.mhd"));
    EXPECT_TRUE(opensFromCache(path));
    EXPECT_TRUE(opensFromCache(folder_ / "copies/head.mhd"));
}

TEST_F(IndexCacheTest, B087_ADeletedVolumeIsSaidToBeMissingAndItsIndexStillOpens) {
    const auto path = writeVolume();
    const auto indexPath = open(path).dataset.indexPath;
    fs::remove_all(folder_ / "volumes");
    OpenRequest request;
    request.path = path;
    EXPECT_THAT(loadDataset(request, cache_, {}, 1u << 20, {}), HasError(ErrorCode::NotFound));
    EXPECT_TRUE(opensFromCache(indexPath));
}

TEST_F(IndexCacheTest, BytesOfASettledFileAreNotReadAgain) {
    const fs::path volume = fs::path(test::sourceFolder()) / "resources/samples/bluntfinq.bin";
    const auto stamp = VolumeStamp::of(volume);
    ASSERT_THAT(stamp, IsOk());
    fs::create_directories(cache_.folder());
    const auto index = cache_.pathForFile(volume, "x");
    std::ofstream(index) << "an index";
    auto text = stamp.value().toText(); // of no bytes: whoever reads them finds others
    std::ofstream(index.string() + ".source") << "x\n" << text;
    EXPECT_EQ(cache_.find(stamp.value(), "x", {}), IndexCache::Finding::Fresh);
    const auto unsettled = text.replace(text.find("\"settled\": true"), 15, "\"settled\": false");
    std::ofstream(index.string() + ".source") << "x\n" << unsettled;
    EXPECT_EQ(cache_.find(stamp.value(), "x", {}), IndexCache::Finding::Stale);
}

TEST_F(IndexCacheTest, WhatIsNoRecordCountsForNothing) {
    const auto path = writeVolume();
    const auto index = open(path).dataset.indexPath;
    const auto stamp = VolumeStamp::of(path, {folder_ / "volumes/skull.raw"}).value();
    const auto record = test::readText(index.string() + ".source");
    EXPECT_EQ(cache_.find(stamp, "", {}), IndexCache::Finding::Fresh);
    for (const std::string& text : {std::string(), std::string("\n"), std::string("\n{"), "other layout" + record,
                                    record.substr(0, record.size() / 2), "\n" + std::string(100'000, '[')}) {
        std::ofstream(index.string() + ".source") << text;
        EXPECT_EQ(cache_.find(stamp, "", {}), IndexCache::Finding::None) << text.substr(0, 60);
    }
    for (const auto& [from, to] : {std::pair("\"size\": ", "\"size\": \""), std::pair("\"xxh3\"", "\"hash\""),
                                   std::pair("\"path\": \"", "\"path\": \"%g0")}) {
        std::string text = record;
        text.replace(text.find(from), std::string(from).size(), to);
        std::ofstream(index.string() + ".source") << text;
        EXPECT_EQ(cache_.find(stamp, "", {}), IndexCache::Finding::None) << from;
    }
}

TEST_F(IndexCacheTest, AStampKnowsPathsOfAnyBytes) {
    const auto path = folder_.write("100 % \xff\n\"\xc3\xa9.raw", "samples");
    const auto stamp = VolumeStamp::of(path);
    ASSERT_THAT(stamp, IsOk());
    const auto again = VolumeStamp::fromText(stamp.value().toText());
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(again->volume(), stamp.value().volume());
    EXPECT_TRUE(again->couldBe(stamp.value()));
}

TEST_F(IndexCacheTest, AFolderIsKnownByAllItsFiles) {
    fs::create_directories(folder_ / "series/deeper");
    folder_.write("series/1.dcm", "one");
    folder_.write("series/deeper/2.dcm", "two");
    const auto before = VolumeStamp::of(folder_ / "series").value();
    EXPECT_TRUE(before.couldBe(VolumeStamp::of(folder_ / "series").value()));
    folder_.write("series/deeper/3.dcm", "three");
    EXPECT_FALSE(before.couldBe(VolumeStamp::of(folder_ / "series").value()));
}

TEST_F(IndexCacheTest, WhatChangedWhileTheIndexWasBuiltIsNotRecorded) {
    const auto path = writeVolume();
    const auto stamp = VolumeStamp::of(path, {folder_ / "volumes/skull.raw"}).value();
    std::ofstream(folder_ / "volumes/skull.raw", std::ios::app) << "more";
    EXPECT_THAT(IndexCache::record(folder_ / "a.isx", stamp, "", {}), HasError(ErrorCode::InvalidArgument));
    EXPECT_FALSE(fs::exists(folder_ / "a.isx.source"));
}

// Entries of a cache that is too large.
class FullIndexCache : public ::testing::Test {
protected:
    FullIndexCache() { fs::create_directory(cache_.folder()); }
    void write(const std::string& name, std::size_t size, std::chrono::hours age) {
        const auto path = folder_.write("cache/" + name, std::string(size, 'x'));
        fs::last_write_time(path, fs::file_time_type::clock::now() - age);
    }
    bool has(const std::string& name) const { return fs::exists(cache_.folder() / name); }

    test::TemporaryFolder folder_;
    IndexCache cache_{folder_ / "cache"};
};

TEST_F(FullIndexCache, LosesWhatWasNotUsedForLongest) {
    write("a.isx", 1000, std::chrono::hours(50));
    write("a.isx.source", 10, std::chrono::hours(50));
    write("a.isx.used", 1, std::chrono::hours(1)); // the oldest, but used since
    write("b.isx", 2000, std::chrono::hours(40));
    write("b.isx.source", 10, std::chrono::hours(40));
    write("c.isx", 3000, std::chrono::hours(30));
    write("notes.txt", 5000, std::chrono::hours(90)); // somebody's own
    EXPECT_EQ(cache_.usage().indexes, 3u);
    EXPECT_EQ(cache_.usage().bytes, 6021u);
    EXPECT_EQ(cache_.trim({}).bytes, 6021u) << "without a limit everything stays";
    cache_.setLimit(6021);
    EXPECT_EQ(cache_.trim({}).indexes, 3u);
    const IndexCache copy = cache_;
    copy.setLimit(6020);
    const auto left = cache_.trim({});
    EXPECT_EQ(left.indexes, 2u);
    EXPECT_EQ(left.bytes, 4011u);
    EXPECT_FALSE(has("b.isx"));
    EXPECT_FALSE(has("b.isx.source"));
    EXPECT_TRUE(has("a.isx"));
    EXPECT_TRUE(has("c.isx"));
    EXPECT_TRUE(has("notes.txt"));
}

TEST_F(FullIndexCache, KeepsWhatIsInUse) {
    write("a.isx", 1000, std::chrono::hours(50));
    write("b.isx", 2000, std::chrono::hours(1));
    const auto left = cache_.clear(cache_.folder() / "a.isx");
    EXPECT_EQ(left.bytes, 1000u);
    EXPECT_TRUE(has("a.isx"));
    EXPECT_FALSE(has("b.isx"));
}

TEST_F(FullIndexCache, KeepsWhatIsBeingBuilt) {
    write("a.isx.partial", 1000, std::chrono::hours(0));
    write("b.isx.partial", 2000, std::chrono::hours(1)); // given up
    write("b.isx.resume", 20, std::chrono::hours(1));
    write("c.isx", 3000, std::chrono::hours(0));
    EXPECT_EQ(cache_.clear({}).bytes, 1000u);
    EXPECT_TRUE(has("a.isx.partial"));
    EXPECT_FALSE(has("b.isx.resume"));
}

TEST_F(FullIndexCache, OfNoFolderIsEmpty) {
    const IndexCache none(folder_ / "nowhere");
    EXPECT_EQ(none.usage().indexes, 0u);
    EXPECT_EQ(none.clear({}).bytes, 0u);
}

TEST_F(IndexCacheTest, AVolumeThatIsOpenedCountsAsUsed) {
    const auto first = writeVolume();
    const auto second = writeVolume("volumes/hand.mhd", "hand.raw");
    open(first);
    open(second);
    for (const auto& entry : fs::directory_iterator(cache_.folder()))
        fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::hours(9));
    ASSERT_TRUE(opensFromCache(first));
    cache_.setLimit(cache_.usage().bytes - 1);
    EXPECT_EQ(cache_.trim({}).indexes, 1u);
    EXPECT_TRUE(fs::exists(cache_.pathForFile(first)));
    EXPECT_FALSE(fs::exists(cache_.pathForFile(second)));
}

} // namespace
} // namespace isoslider::model
