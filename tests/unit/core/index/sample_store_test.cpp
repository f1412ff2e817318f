// Damaged chunk groups and chunks: refused when they are needed, never a wrong sample.

#include "core/index/sample_store.h"

#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_writer.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/index_chunks.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

class SampleStoreFile : public testing::Test {
protected:
    void SetUp() override {
        grid_ = test::hillsVolume({150, 130, 70}); // 10 x 9 x 5 chunks: two groups
        preprocess::BuildOptions options;
        options.kind = IndexKind::Metacells;
        ASSERT_THAT(test::buildIndexOf(grid_, folder_ / "good.isx", options), IsOk());
        bytes_ = test::readText(folder_ / "good.isx");
        auto reader = IndexReader::open(folder_ / "good.isx");
        ASSERT_THAT(reader, IsOk());
        meta_ = reader.value()->meta();
    }

    std::filesystem::path write(const std::string& bytes) { return folder_.write("damaged.isx", bytes); }

    std::string forged(const IndexMeta& meta) const { return test::forgedIndex(bytes_, meta); }

    // Reads every chunk; the error of the first that cannot be read.
    Status readAll(const std::filesystem::path& path) {
        auto reader = IndexReader::open(path);
        if (!reader.isOk())
            return reader.error();
        const SampleStore store(*reader.value());
        std::vector<std::uint16_t> chunk(SampleStore::kChunkSamples);
        const std::span<std::uint16_t, SampleStore::kChunkSamples> out(chunk.data(), chunk.size());
        std::uint64_t bytesRead = 0;
        for (const ChunkIndex c : firstIds<ChunkIndex>(store.chunks().chunkCount()))
            ISO_TRY(store.read<std::uint16_t>(c, out, bytesRead));
        return {};
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const ScalarGrid> grid_;
    std::string bytes_;
    IndexMeta meta_;
};

TEST_F(SampleStoreFile, HasGroupsOneAfterTheOther) {
    ASSERT_EQ(meta_.chunkGroups.size(), 2u);
    EXPECT_EQ(meta_.chunkGroups[0].offset, kPreambleBytes);
    EXPECT_EQ(meta_.chunkGroups[1].offset,
              meta_.chunkGroups[0].offset + meta_.chunkGroups[0].chunkBytes + kGroupChunks * kGroupEntryBytes);
    EXPECT_EQ(meta_.info.chunkBytes, meta_.chunkGroups[0].chunkBytes + meta_.chunkGroups[1].chunkBytes);
    EXPECT_THAT(readAll(folder_ / "good.isx"), IsOk());
}

TEST_F(SampleStoreFile, EveryDamagedByteIsFoundWhereItLies) {
    std::mt19937 random(3);
    const std::uint64_t tableAt = meta_.chunkGroups[0].offset + meta_.chunkGroups[0].chunkBytes;
    for (int round = 0; round < 200; ++round) {
        std::string damaged = bytes_;
        const bool inTable = round % 4 == 0;
        const std::uint64_t at = inTable ? tableAt + random() % (kGroupChunks * kGroupEntryBytes)
                                         : meta_.chunkGroups[0].offset + random() % meta_.chunkGroups[0].chunkBytes;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
        const Status read = readAll(write(damaged));
        ASSERT_THAT(read, HasError(ErrorCode::Corruption)) << "byte " << at;
        EXPECT_EQ(read.error().path, (folder_ / "damaged.isx").string());
        EXPECT_LE(read.error().offset.value(), at);
    }
}

TEST_F(SampleStoreFile, SwappedChunksAndGroupsAreFound) {
    IndexMeta meta = meta_;
    std::swap(meta.chunkGroups[0], meta.chunkGroups[1]);
    EXPECT_THAT(readAll(write(forged(meta))), HasError(ErrorCode::Corruption));
    const auto reader = IndexReader::open(folder_ / "good.isx");
    ASSERT_THAT(reader, IsOk());
    const SampleStore store(*reader.value());
    std::uint64_t bytesRead = 0;
    const ChunkPlace first = store.find(ChunkIndex(10), bytesRead).value();
    for (ChunkIndex other(11); other < ChunkIndex(40); ++other) {
        const ChunkPlace second = store.find(other, bytesRead).value();
        if (second.bytes != first.bytes)
            continue;
        std::string swapped = bytes_;
        for (std::size_t i = 0; i < first.bytes; ++i)
            std::swap(swapped[first.offset + i], swapped[second.offset + i]);
        EXPECT_THAT(readAll(write(swapped)), HasError(ErrorCode::Corruption));
    }
}

TEST_F(SampleStoreFile, ForgedDirectoriesAreRefusedOrRead) {
    std::mt19937_64 random(2);
    for (int round = 0; round < 200; ++round) {
        IndexMeta meta = meta_;
        ChunkGroupEntry& group = meta.chunkGroups[random() % 2];
        std::uint64_t& value = random() % 2 ? group.offset : group.chunkBytes;
        const std::uint64_t choices[] = {
            0, 1, value + 1, value - 1, random() % bytes_.size(), ~std::uint64_t{0}, ~std::uint64_t{0} - value};
        value = choices[random() % std::size(choices)];
        EXPECT_THAT(readAll(write(forged(meta))), HasError(ErrorCode::Corruption)) << round;
    }
    IndexMeta fewer = meta_;
    fewer.chunkGroups.pop_back();
    EXPECT_THAT(IndexReader::open(write(forged(fewer))), HasError(ErrorCode::Corruption));
    IndexMeta another = meta_;
    another.info.kind = IndexKind::Edges;
    EXPECT_NO_THROW(
        static_cast<void>(extract::SlideEngine::open(write(forged(another))).value()->slideTo(500.0).isOk()))
        << "bricks taken for points, samples for normals";
    another.chunkGroups.clear();
    EXPECT_THAT(IndexReader::open(write(forged(another))), HasError(ErrorCode::Corruption)) << "edges have chunks too";
    another.info.kind = IndexKind::BrickList;
    EXPECT_THAT(IndexReader::open(write(forged(another))), HasError(ErrorCode::Corruption)) << "is never a file";
}

// Only a forger writes such a list: everything has its right checksum.
TEST(ForgedBrickList, RecordsWithoutOrWithSeveralEntriesAreNotBelieved) {
    const test::TemporaryFolder folder;
    const auto grid = test::hillsVolume({8, 8, 8});
    preprocess::BuildOptions options;
    options.kind = IndexKind::Metacells;
    ASSERT_THAT(test::buildIndexOf(grid, folder / "good.isx", options), IsOk());
    const auto good = IndexReader::open(folder / "good.isx");
    ASSERT_THAT(good, IsOk());
    for (const int mask : {0b10, 0, 0b1010}) {
        auto writer = IndexWriter::create(folder / "forged.isx", 7);
        ASSERT_THAT(writer, IsOk());
        ASSERT_THAT(test::copyChunks(*good.value(), *writer.value()), IsOk());
        std::vector<PointRecord<std::uint16_t>> records;
        for (const std::uint16_t key : {std::uint16_t{100}, std::uint16_t{900}}) {
            PointRecord<std::uint16_t> record;
            record.key = key;
            record.setId(PointId());
            record.edgeMask = static_cast<std::uint8_t>(mask);
            for (auto& far : record.farKeys)
                far = static_cast<std::uint16_t>(1000 - key);
            records.push_back(record);
        }
        PageEntry entry;
        entry.firstKey = 100;
        entry.lastKey = 900;
        entry.points = 2;
        entry.edges = static_cast<std::uint32_t>(2 * std::popcount(static_cast<unsigned>(mask)));
        const auto page = encodePage<std::uint16_t>(records, PageOrder::Value, FarEnds::Keys, good.value()->grid());
        ASSERT_THAT(writer.value()->addPage(kLevel0, entry, page), IsOk());
        IndexMeta meta = good.value()->meta();
        meta.info.levels.resize(1);
        ASSERT_THAT(writer.value()->finish(meta), IsOk());
        const auto engine = extract::SlideEngine::open(folder / "forged.isx");
        ASSERT_THAT(engine, IsOk());
        EXPECT_THAT(engine.value()->slideTo(500.0), IsOk());
        if (mask != 0b10) { // one entry is as good as any
            EXPECT_TRUE(test::isSameSurface(engine.value()->mesh().value(), extract::extractFull(*grid, 500.0).value()))
                << "found from the samples";
        }
    }
}

TEST_F(SampleStoreFile, NoDamagedChunkEverGivesAWrongSurface) {
    std::mt19937 random(12);
    int refused = 0, moved = 0;
    for (int round = 0; round < 12; ++round) {
        std::string damaged = bytes_;
        const ChunkGroupEntry& group = meta_.chunkGroups[round % 2];
        damaged[group.offset + random() % group.chunkBytes] ^= 0x10;
        extract::SlideOptions options;
        options.cacheBytes = round % 3 == 0 ? 0 : std::uint64_t{1} << (19 + round % 5);
        auto engine = extract::SlideEngine::open(write(damaged), options);
        ASSERT_THAT(engine, IsOk()) << "opening does not read samples";
        for (int step = 0; step < 8; ++step) {
            const double isovalue = 5.0 + random() % 1000;
            const auto outcome = engine.value()->slideTo(isovalue);
            if (outcome.isOk()) {
                ++moved;
                ASSERT_TRUE(test::isSameSurface(engine.value()->mesh().value(),
                                                extract::extractFull(*grid_, isovalue).value()));
            } else {
                ++refused;
                ASSERT_EQ(outcome.error().code, ErrorCode::Corruption);
                EXPECT_TRUE(engine.value()->mesh().value().triangles.empty()) << "a failed move leaves no surface";
            }
        }
    }
    EXPECT_GT(refused, 0);
    EXPECT_GT(moved, 0);
}

} // namespace
} // namespace isoslider::index
