// Damaged index files: refused when they are opened, or when a move needs the damaged page.

#include <random>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/index_reader.h"
#include "core/index/index_writer.h"
#include "core/index/validation/index_validation.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

class IndexFile : public testing::Test {
protected:
    void SetUp() override {
        grid_ = test::hillsVolume({33, 20, 18});
        preprocess::BuildOptions options;
        options.redundancyThreshold = 0.2;
        ASSERT_THAT(test::buildIndexOf(grid_, folder_ / "good.isx", options), IsOk());
        bytes_ = test::readText(folder_ / "good.isx");
        auto reader = IndexReader::open(folder_ / "good.isx");
        ASSERT_THAT(reader, IsOk());
        meta_ = reader.value()->meta();
    }

    std::filesystem::path write(const std::string& bytes) { return folder_.write("damaged.isx", bytes); }

    // Where a full sweep of a damaged index ends.
    Result<extract::SlideStats> sweep(const std::filesystem::path& path) {
        auto engine = extract::SlideEngine::open(path);
        if (!engine.isOk())
            return std::move(engine).error();
        Result<extract::SlideStats> last = engine.value()->slideTo(meta_.info.min);
        for (int step = 1; step <= 40 && last.isOk(); ++step)
            last = engine.value()->slideTo(meta_.info.min + (meta_.info.max - meta_.info.min) * step / 40.0);
        return last;
    }

    // Whether it slides all the same, since its samples state what its pages do; and is named.
    void expectRightAndNamed(const std::filesystem::path& path) const {
        auto engine = extract::SlideEngine::open(path);
        ASSERT_THAT(engine, IsOk());
        for (int step = 0; step <= 20; ++step) {
            const double isovalue = meta_.info.min + (meta_.info.max - meta_.info.min) * (step * 7 % 21) / 20.0;
            ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
            ASSERT_TRUE(
                test::isSameSurface(engine.value()->mesh().value(), extract::extractFull(*grid_, isovalue).value()));
        }
        ValidationOptions full;
        full.isFull = true;
        const auto report = validateIndex(path, full);
        ASSERT_THAT(report, IsOk());
        EXPECT_FALSE(report.value().isSound());
    }

    std::string forged(const IndexMeta& meta) const { return test::forgedIndex(bytes_, meta); }

    test::TemporaryFolder folder_;
    std::shared_ptr<const ScalarGrid> grid_;
    std::string bytes_;
    IndexMeta meta_;
};

TEST_F(IndexFile, OpensAndSweepsWhole) {
    EXPECT_GE(meta_.levels.size(), 3u);
    EXPECT_GE(meta_.levels[0].pages.size(), 2u);
    EXPECT_THAT(sweep(folder_ / "good.isx"), IsOk());
}

TEST_F(IndexFile, IsRefusedAtEveryTruncation) {
    const std::size_t metaOffset = bytes_.size() - encodeMeta(meta_).size();
    for (std::size_t length = 0; length < bytes_.size(); length += length < 80 || length + 40 > bytes_.size() ? 1
                                                                   : length > metaOffset                      ? 97
                                                                                                              : 1009) {
        const auto opened = IndexReader::open(write(bytes_.substr(0, length)));
        ASSERT_THAT(opened, HasError(length < 12 ? ErrorCode::InvalidArgument : ErrorCode::Corruption)) << length;
        ASSERT_EQ(opened.error().path, (folder_ / "damaged.isx").string());
    }
}

TEST_F(IndexFile, IsRefusedWithTrailingBytes) {
    EXPECT_THAT(IndexReader::open(write(bytes_ + '\0')), HasError(ErrorCode::Corruption));
    EXPECT_THAT(IndexReader::open(write(bytes_ + bytes_)), HasError(ErrorCode::Corruption));
}

TEST_F(IndexFile, IsRefusedWithAnyFlippedHeaderBit) {
    for (std::size_t bit = 0; bit < 8 * kPreambleBytes; ++bit) {
        std::string damaged = bytes_;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        ASSERT_FALSE(IndexReader::open(write(damaged)).isOk()) << "bit " << bit;
    }
}

TEST_F(IndexFile, IsRefusedWithFlippedMetaBits) {
    const std::size_t metaBytes = encodeMeta(meta_).size();
    std::mt19937 random(9);
    for (int round = 0; round < 300; ++round) {
        std::string damaged = bytes_;
        const std::size_t at = bytes_.size() - 1 - random() % metaBytes;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
        ASSERT_THAT(IndexReader::open(write(damaged)), HasError(ErrorCode::Corruption)) << "byte " << at;
    }
}

// Opening does not read pages; what a move finds damaged, it goes around.
TEST_F(IndexFile, NoDamagedPageEverGivesAWrongSurface) {
    std::mt19937 random(12);
    for (const LevelDirectory& level : meta_.levels)
        for (const PageEntry& page : level.pages) {
            std::string damaged = bytes_;
            const std::size_t at = page.offset + random() % page.bytes;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
            ASSERT_NO_FATAL_FAILURE(expectRightAndNamed(write(damaged))) << "page at " << page.offset;
        }
}

TEST_F(IndexFile, B083_SwappedPagesAreFound) {
    // Two pages of equal length, as only the checksum's dependence on the place can distinguish them.
    IndexMeta meta = meta_;
    auto& pages = meta.levels[0].pages;
    ASSERT_GE(pages.size(), 2u);
    std::swap(pages[0].offset, pages[1].offset);
    std::swap(pages[0].bytes, pages[1].bytes);
    expectRightAndNamed(write(forged(meta)));
    std::swap(pages[0].checksum, pages[1].checksum); // now only the counts and the keys are wrong
    expectRightAndNamed(write(forged(meta)));
}

TEST_F(IndexFile, B083_APageOfAnotherIndexIsFound) {
    ASSERT_THAT(test::buildIndexOf(test::noiseVolume({33, 20, 18}, 4), folder_ / "other.isx"), IsOk());
    const auto other = IndexReader::open(folder_ / "other.isx");
    ASSERT_THAT(other, IsOk());
    const PageEntry& theirs = other.value()->meta().levels[0].pages[0];
    const PageEntry& ours = meta_.levels[0].pages[0];
    std::string mixed = bytes_;
    const std::string otherBytes = test::readText(folder_ / "other.isx");
    mixed.replace(ours.offset, std::min(ours.bytes, theirs.bytes),
                  otherBytes.substr(theirs.offset, std::min(ours.bytes, theirs.bytes)));
    expectRightAndNamed(write(mixed));
}

// Right checksums around wrong entries: any answer is good but a crash, a hang or an exception.
TEST_F(IndexFile, B084_ForgedDirectoriesNeverCrash) {
    std::mt19937_64 random(2);
    const auto forge = [&](std::uint64_t& value) {
        const std::uint64_t choices[] = {
            0, 1, value + 1, value - 1, random() % 2000, ~std::uint64_t{0}, ~std::uint64_t{0} - 1};
        value = choices[random() % std::size(choices)];
    };
    for (int round = 0; round < 150; ++round) {
        IndexMeta meta = meta_;
        for (int changes = 0; changes < 3; ++changes) {
            LevelDirectory& level = meta.levels[random() % meta.levels.size()];
            const bool takesBlock = !level.blocks.empty() && random() % 2;
            if (takesBlock) {
                BlockEntry& block = level.blocks[random() % level.blocks.size()];
                forge(random() % 2 ? block.firstKey : block.lastKey);
            } else if (!level.pages.empty()) {
                PageEntry& page = level.pages[random() % level.pages.size()];
                forge(random() % 2 ? page.firstKey : page.lastKey);
                if (random() % 4 == 0)
                    std::swap(page, level.pages[random() % level.pages.size()]);
            }
        }
        EXPECT_NO_THROW(static_cast<void>(sweep(write(forged(meta))).isOk())) << "round " << round;
    }
}

// A million empty blocks: more levels could be merged above them than any real index has.
TEST_F(IndexFile, B085_AForgedTopLevelOfManyBlocksNeverCrashes) {
    const auto grid = test::makeVolume<float>(ScalarType::F32, test::cubeGeometry(6), [](auto x, auto y, auto z) {
        return 1.0 + 1.0 * x + 0.1 * y + 0.01 * z;
    });
    ASSERT_THAT(test::buildIndexOf(grid, folder_ / "float.isx"), IsOk());
    bytes_ = test::readText(folder_ / "float.isx");
    IndexMeta meta = IndexReader::open(folder_ / "float.isx").value()->meta();
    meta.levels.resize(8);
    meta.info.levels.resize(8);
    LevelDirectory& top = meta.levels.back();
    top = {};
    for (std::uint64_t i = 0; i < (1u << 20); ++i)
        top.blocks.push_back({0x40000000 + i, 0x40000000 + i, 0, 0});
    const auto engine = extract::SlideEngine::open(write(forged(meta)));
    if (!engine.isOk())
        return;
    for (int round = 0; round < 6; ++round)
        EXPECT_NO_THROW(static_cast<void>(engine.value()->slideTo(round % 2 ? -1e38 : -1.0).isOk()));
}

TEST_F(IndexFile, AHalfWrittenIndexCannotBeOpened) {
    auto writer = IndexWriter::create(folder_ / "new.isx", 42);
    ASSERT_THAT(writer, IsOk());
    const std::vector<std::byte> page(std::size_t{3} << 20, std::byte{7}); // more than is held back
    ASSERT_THAT(writer.value()->addPage(kLevel0, {}, page), IsOk());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "new.isx"));
    // What a crash would leave.
    std::filesystem::copy_file(partialPath(folder_ / "new.isx"), folder_ / "left.isx");
    EXPECT_EQ(std::filesystem::file_size(folder_ / "left.isx"), kPreambleBytes + page.size());
    EXPECT_THAT(IndexReader::open(folder_ / "left.isx"), HasError(ErrorCode::InvalidArgument));
    writer.value().reset();
    EXPECT_FALSE(std::filesystem::exists(partialPath(folder_ / "new.isx"))) << "given up, gone";
}

TEST_F(IndexFile, RefusesWhatIsNoIndex) {
    EXPECT_THAT(IndexReader::open(folder_ / "none.isx"), HasError(ErrorCode::NotFound));
    EXPECT_THAT(IndexReader::open(folder_.path()), HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(IndexReader::open(folder_.write("empty.isx", "")), HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(IndexReader::open(folder_.write("text.isx", std::string(5000, 'x'))),
                HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(IndexReader::open(folder_.write("zeros.isx", std::string(5000, '\0'))),
                HasError(ErrorCode::InvalidArgument));
    EXPECT_THAT(extract::SlideEngine::open(folder_ / "none.isx"), HasError(ErrorCode::NotFound));
}

} // namespace
} // namespace isoslider::index
