// B080 to B086 without a disk: every bit, every length, every part of an index damaged in turn, and indexes
// whose checksums are right around numbers that are not.

#include <sys/resource.h>

#include <cstdlib>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "core/index/sample_store.h"
#include "tests/property/surface_comparison.h"
#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/memory_file_system.h"
#include "tests/support/repetitions.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

std::uint64_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
}

/// A piece of the file under one checksum, and how it is read.
struct Part {
    std::uint64_t offset = 0, bytes = 0;
    std::function<Status()> read;
};

class IndexDamage : public testing::TestWithParam<IndexKind> {
protected:
    void SetUp() override {
        bytes_ = good_ = bytesOf(grid_);
        auto opened = open();
        ASSERT_THAT(opened, IsOk());
        reader_ = std::move(opened).value();
        meta_ = reader_->meta();
        metaOffset_ = decodePreamble(std::as_bytes(std::span(good_)), good_.size(), "x").value().metaOffset;
        findParts();
    }

    static std::string bytesOf(const std::shared_ptr<const ScalarGrid>& grid, double redundancyThreshold = 0.2) {
        const test::TemporaryFolder folder;
        preprocess::BuildOptions options;
        options.kind = GetParam();
        options.redundancyThreshold = redundancyThreshold;
        EXPECT_THAT(test::buildIndexOf(grid, folder / "a.isx", options), IsOk());
        return test::readText(folder / "a.isx");
    }
    /// What bytes_ are now.
    Result<std::unique_ptr<IndexReader>> open() { return IndexReader::open("damaged.isx", files_); }

    void findParts() {
        for (const auto& level : meta_.levels)
            for (const PageEntry& page : level.pages)
                parts_.push_back({page.offset, page.bytes, [this, page] { return reader_->readPage(page, buffer_); }});
        for (const ChunkGroupEntry& group : meta_.chunkGroups) // the only one: the grid has fewer than 256 chunks
            findChunks(group);
    }
    void findChunks(const ChunkGroupEntry& group) {
        const SampleStore store(*reader_);
        std::uint64_t ignored = 0;
        const auto place = [](SampleStore& fresh, ChunkIndex chunk) {
            std::uint64_t read = 0;
            return fresh.find(chunk, read);
        };
        const std::uint64_t chunks = store.chunks().chunkCount();
        parts_.push_back({group.offset + group.chunkBytes, chunks * kGroupEntryBytes, [this, place] {
                              SampleStore fresh(*reader_);
                              const auto found = place(fresh, ChunkIndex());
                              return found.isOk() ? Status() : Status(found.error());
                          }});
        for (const ChunkIndex chunk : firstIds<ChunkIndex>(chunks)) {
            const ChunkPlace at = store.find(chunk, ignored).value();
            parts_.push_back({at.offset, at.bytes, [this, chunk] {
                                  SampleStore fresh(*reader_);
                                  std::uint64_t read = 0;
                                  return fresh.read<std::uint8_t>(chunk, samples_, read);
                              }});
        }
    }
    /// Of parts that hold one of these bytes, how many can be read all the same.
    int readableParts(std::uint64_t begin, std::uint64_t end) {
        int readable = 0;
        for (const Part& part : parts_)
            readable += part.offset < end && begin < part.offset + part.bytes && part.read().isOk() ? 1 : 0;
        return readable;
    }

    enum class Verdict { Refused, Right, Wrong };
    /// Of an index file given to the engine: opened, and moved over all values both ways.
    Verdict verdictOn(const std::string& bytes) {
        static const std::vector<double> stops = {3.0, 7.0, 5.5, 0.5, 6.0, 1.0};
        auto engine = extract::SlideEngine::open(folder_.write("damaged.isx", bytes));
        if (!engine.isOk())
            return Verdict::Refused;
        for (const double stop : stops) {
            if (!engine.value()->slideTo(stop).isOk())
                return Verdict::Refused;
            if (!test::isSameSurface(engine.value()->mesh().value(), extract::extractFull(*grid_, stop).value()))
                return Verdict::Wrong;
        }
        return Verdict::Right;
    }
    Verdict verdictOnForged(const IndexMeta& meta) { return verdictOn(test::forgedIndex(good_, meta)); }

    std::shared_ptr<const ScalarGrid> grid_ = test::noiseVolume({33, 20, 18}, 8, 9);
    std::string good_, bytes_; ///< bytes_ are what reader_ reads; each test gives them back
    test::MemoryFileSystem files_{bytes_};
    std::unique_ptr<IndexReader> reader_;
    IndexMeta meta_;
    std::uint64_t metaOffset_ = 0;
    std::vector<Part> parts_;
    std::vector<std::byte> buffer_;
    std::array<std::uint8_t, SampleStore::kChunkSamples> samples_{};
    test::TemporaryFolder folder_;
};

TEST_P(IndexDamage, EveryByteIsUnderOneChecksum) {
    std::vector<int> covered(good_.size(), 0);
    const auto cover = [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t at = begin; at < end; ++at)
            ++covered[at];
    };
    cover(0, kPreambleBytes);
    cover(metaOffset_, good_.size());
    for (const Part& part : parts_) {
        EXPECT_THAT(part.read(), IsOk()) << part.offset;
        cover(part.offset, part.offset + part.bytes);
    }
    EXPECT_EQ(std::count(covered.begin(), covered.end(), 1), static_cast<std::ptrdiff_t>(good_.size()));
    EXPECT_GE(parts_.size(), 3u);
}

TEST_P(IndexDamage, B080_EachBitOfHeaderAndDirectoryIsFoundOnOpening) {
    for (std::uint64_t bit = 0; bit < 8 * good_.size(); ++bit) {
        if (bit == 8 * kPreambleBytes)
            bit = 8 * metaOffset_;
        const auto flip = [&] { bytes_[bit / 8] = static_cast<char>(bytes_[bit / 8] ^ 1 << bit % 8); };
        flip();
        ASSERT_FALSE(open().isOk()) << "bit " << bit;
        flip();
    }
}

TEST_P(IndexDamage, B080_FlippedBitsOfPartsAreFoundWhenTheyAreRead) {
    const long flips = test::repetitions("ISOSLIDER_FLIPS", 200'000 / test::kSparser);
    std::mt19937_64 random(80);
    std::vector<std::uint64_t> ends;
    std::uint64_t total = 0;
    for (const Part& part : parts_)
        ends.push_back(total += part.bytes);
    for (long i = 0; i < flips; ++i) {
        const std::uint64_t at = random() % total;
        const Part& part =
            parts_[static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), at) - ends.begin())];
        char& byte = bytes_[part.offset + random() % part.bytes];
        const auto flip = static_cast<char>(1 << random() % 8);
        byte = static_cast<char>(byte ^ flip);
        ASSERT_THAT(part.read(), HasError(ErrorCode::Corruption)) << &byte - bytes_.data();
        byte = static_cast<char>(byte ^ flip);
    }
}

TEST_P(IndexDamage, B081_EachLengthButItsOwnIsFoundOnOpening) {
    for (std::size_t length = 0; length < good_.size(); ++length) {
        bytes_.resize(good_.size() - 1 - length);
        ASSERT_FALSE(open().isOk()) << bytes_.size();
    }
    bytes_ = good_ + '\0';
    EXPECT_FALSE(open().isOk());
}

TEST_P(IndexDamage, B082_LostPagesAreFoundWherePartsAreRead) {
    for (const std::size_t page : {std::size_t{512}, std::size_t{4096}, std::size_t{65536}})
        for (std::size_t begin = 0; begin < good_.size(); begin += page) {
            const std::size_t end = std::min(begin + page, good_.size());
            std::fill(bytes_.begin() + static_cast<std::ptrdiff_t>(begin),
                      bytes_.begin() + static_cast<std::ptrdiff_t>(end), '\0');
            const bool isHeader = begin < kPreambleBytes || end > metaOffset_;
            ASSERT_EQ(open().isOk(), !isHeader) << page << " at " << begin;
            for (const Part& part : parts_)
                if (part.offset < end && begin < part.offset + part.bytes &&
                    bytes_.compare(part.offset, part.bytes, good_, part.offset, part.bytes) != 0) {
                    ASSERT_THAT(part.read(), HasError(ErrorCode::Corruption)) << page << " at " << begin;
                }
            bytes_ = good_;
        }
}

TEST_P(IndexDamage, B083_PartsOfOtherPlacesAndOtherIndexesAreFound) {
    // Each in the place of each other, as far as it goes; and from an index of other samples, or of the same
    // ones built otherwise, what lies at the same place there.
    const std::string others[] = {bytesOf(test::noiseVolume({33, 20, 18}, 9, 9)), bytesOf(grid_, 0.9)};
    for (const Part& part : parts_) {
        const auto put = [&](const std::string& from, std::uint64_t offset, std::uint64_t bytes) {
            bytes_.replace(part.offset, bytes, from, offset, bytes);
            if (bytes_ != good_) {
                EXPECT_THAT(part.read(), HasError(ErrorCode::Corruption)) << part.offset << " from " << offset;
            }
            bytes_.replace(part.offset, part.bytes, good_, part.offset, part.bytes);
        };
        for (const Part& other : parts_)
            put(good_, other.offset, std::min(part.bytes, other.bytes));
        for (const std::string& other : others)
            if (other.size() > part.offset)
                put(other, part.offset, std::min<std::uint64_t>(part.bytes, other.size() - part.offset));
    }
}

TEST_P(IndexDamage, B083_TheSameBytesElsewhereHaveAnotherChecksum) {
    const std::vector<std::byte> page(100, std::byte{7});
    EXPECT_NE(pageChecksum(page, 1, 64), pageChecksum(page, 2, 64)) << "of another index";
    EXPECT_NE(pageChecksum(page, 1, 64), pageChecksum(page, 1, 164)) << "at another place";
}

TEST_P(IndexDamage, B084_PlacesOutsideTheFileOrInItsHeaderAreRefusedOnOpening) {
    const std::uint64_t places[] = {0,
                                    1,
                                    kPreambleBytes - 1,
                                    metaOffset_ + 1,
                                    good_.size(),
                                    good_.size() + 1,
                                    std::uint64_t{1} << 63,
                                    ~std::uint64_t{0},
                                    ~std::uint64_t{0} - 100};
    const auto expectRefused = [&](auto&& change) {
        IndexMeta meta = meta_;
        change(meta);
        bytes_ = test::forgedIndex(good_, meta);
        EXPECT_THAT(open(), HasError(ErrorCode::Corruption));
        bytes_ = good_;
    };
    for (const std::uint64_t place : places) {
        SCOPED_TRACE(place);
        for (std::size_t level = 0; level < meta_.levels.size(); ++level)
            for (const std::size_t page : {std::size_t{0}, meta_.levels[level].pages.size() - 1})
                if (page < meta_.levels[level].pages.size())
                    expectRefused([&](IndexMeta& meta) { meta.levels[level].pages[page].offset = place; });
        if (!meta_.chunkGroups.empty())
            expectRefused([&](IndexMeta& meta) { meta.chunkGroups[0].offset = place; });
    }
    // Sizes that reach out of it.
    expectRefused([&](IndexMeta& meta) { meta.levels[0].pages[0].bytes = ~std::uint32_t{0}; });
    expectRefused([&](IndexMeta& meta) {
        meta.levels[0].pages[0].bytes = static_cast<std::uint32_t>(metaOffset_ - meta.levels[0].pages[0].offset) + 1;
    });
    if (!meta_.chunkGroups.empty())
        for (const std::uint64_t bytes : places)
            if (bytes > meta_.chunkGroups[0].chunkBytes)
                expectRefused([&](IndexMeta& meta) { meta.chunkGroups[0].chunkBytes = bytes; });
}

TEST_P(IndexDamage, B084_BlocksThatReachBackOrBeyondAreRefusedOnOpening) {
    const auto level =
        std::find_if(meta_.levels.begin() + 1, meta_.levels.end(), [](const auto& l) { return l.blocks.size() > 1; });
    if (level == meta_.levels.end())
        GTEST_SKIP() << "one block";
    const auto number = static_cast<std::size_t>(level - meta_.levels.begin());
    const auto expectRefused = [&](auto&& change) {
        IndexMeta meta = meta_;
        change(meta.levels[number].blocks[1], meta.levels[number].blocks[0]);
        bytes_ = test::forgedIndex(good_, meta);
        EXPECT_THAT(open(), HasError(ErrorCode::Corruption));
        bytes_ = good_;
    };
    expectRefused([](BlockEntry& block, const BlockEntry&) { block.firstPage = 0; }); // a circle
    expectRefused([](BlockEntry& block, const BlockEntry& before) { block = before; });
    expectRefused([](BlockEntry& block, const BlockEntry&) { block.firstPage = ~std::uint64_t{0}; });
    expectRefused([](BlockEntry& block, const BlockEntry&) { block.pageCount = std::uint64_t{1} << 63; });
    expectRefused([](BlockEntry& block, const BlockEntry&) { block.pageCount = ~std::uint64_t{0}; });
    expectRefused([](BlockEntry& block, const BlockEntry& before) { block.firstKey = before.lastKey; });
    expectRefused([](BlockEntry& block, const BlockEntry&) { std::swap(block.firstKey, ++block.lastKey); });
}

TEST_P(IndexDamage, B084_PagesThatOverlapNeverGiveAWrongSurface) {
    // Each with the place, size and checksum of each other, also across levels: the checksum is that of the
    // place.
    std::vector<std::pair<std::size_t, std::size_t>> pages;
    for (std::size_t level = 0; level < meta_.levels.size(); ++level)
        for (std::size_t page = 0; page < meta_.levels[level].pages.size(); ++page)
            pages.emplace_back(level, page);
    for (const auto& [level, page] : pages)
        for (const auto& [otherLevel, otherPage] : pages) {
            if (std::pair(level, page) == std::pair(otherLevel, otherPage))
                continue;
            IndexMeta meta = meta_;
            PageEntry& entry = meta.levels[level].pages[page];
            const PageEntry& other = meta_.levels[otherLevel].pages[otherPage];
            entry.offset = other.offset;
            entry.bytes = other.bytes;
            entry.checksum = other.checksum;
            EXPECT_NE(verdictOnForged(meta), Verdict::Wrong)
                << level << '/' << page << " is " << otherLevel << '/' << otherPage;
        }
}

TEST_P(IndexDamage, B085_HugeNumbersAnywhereInTheDirectoryTakeNoMemory) {
    const auto encoded = encodeMeta(meta_);
    const std::string meta(reinterpret_cast<const char*>(encoded.data()), encoded.size());
    Preamble preamble = decodePreamble(std::as_bytes(std::span(good_)), good_.size(), "x").value();
    const std::uint64_t rssBefore = peakRssBytes();
    int refused = 0;
    for (const std::uint64_t huge :
         {std::uint64_t{1} << 31, std::uint64_t{1} << 40, std::uint64_t{1} << 63, ~std::uint64_t{0}})
        for (std::size_t at = 0; at + sizeof huge <= meta.size(); ++at) {
            bytes_.replace(metaOffset_, meta.size(), meta);
            std::memcpy(bytes_.data() + metaOffset_ + at, &huge, sizeof huge);
            preamble.metaChecksum = metaChecksum(std::as_bytes(std::span(bytes_)).subspan(metaOffset_));
            const auto head = encodePreamble(preamble);
            std::copy_n(reinterpret_cast<const char*>(head.data()), head.size(), bytes_.begin());
            refused += open().isOk() ? 0 : 1;
        }
    EXPECT_GT(refused, 100);
#if ISO_HAS_SANITIZER
    constexpr std::uint64_t kMost = std::uint64_t{400} << 20; // it keeps what has been freed, up to 256 MB
#else
    constexpr std::uint64_t kMost = std::uint64_t{64} << 20;
#endif
    EXPECT_LT(peakRssBytes() - rssBefore, kMost);
    bytes_ = good_;
}

TEST_P(IndexDamage, B085_HugeCountsInPagesAreRefused) {
    const BrickGrid grid(meta_.info.geometry.dims);
    for (const PageEntry& page : meta_.levels[0].pages)
        for (const std::size_t field : {0, 4}) // points, edges
            for (const std::uint32_t huge : {0x7fffffffu, 0x80000000u, 0xffffffffu}) {
                if (GetParam() != IndexKind::Edges)
                    continue; // its pages have other codecs, tested in skip_levels_test
                ASSERT_THAT(reader_->readPage(page, buffer_), IsOk());
                std::memcpy(buffer_.data() + field, &huge, sizeof huge);
                DecodedPage<std::uint16_t> decoded;
                EXPECT_THAT(decodePage(std::span<const std::byte>(buffer_), grid, decoded, "x"),
                            HasError(ErrorCode::Corruption));
                EXPECT_LT(decoded.memoryBytes(), std::size_t{1} << 24);
            }
}

TEST_P(IndexDamage, B085_IdsPastTheGridAreRefused) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        IndexMeta meta = meta_;
        meta.info.geometry.dims[axis] -= 9; // a brick less
        EXPECT_EQ(verdictOnForged(meta), Verdict::Refused) << axis;
    }
}

TEST_P(IndexDamage, B085_MoreLevelsThanThereCanBeAreRefused) {
    for (const std::size_t levels : {0, 9, 1000}) {
        IndexMeta meta = meta_;
        meta.levels.resize(levels);
        meta.info.levels.resize(levels);
        bytes_ = test::forgedIndex(good_, meta);
        EXPECT_THAT(open(), HasError(ErrorCode::Corruption)) << levels;
    }
    bytes_ = good_;
}

TEST_P(IndexDamage, B086_ChangesThatDoNotFitWhatIsActiveAreErrors) {
    // All checksums are right. Twice the same pages: what is active is activated again.
    IndexMeta twice = meta_;
    auto& pages = twice.levels[0].pages;
    pages.insert(pages.end(), pages.begin(), pages.end());
    EXPECT_EQ(verdictOnForged(twice), Verdict::Refused);
    // A page less, but not the last: an edge that never became active is deactivated at its other end.
    for (std::size_t page = 0; page + 1 < meta_.levels[0].pages.size(); ++page) {
        IndexMeta fewer = meta_;
        fewer.levels.resize(1);
        fewer.info.levels.resize(1);
        fewer.levels[0].pages.erase(fewer.levels[0].pages.begin() + static_cast<std::ptrdiff_t>(page));
        auto engine = extract::SlideEngine::open(folder_.write("damaged.isx", test::forgedIndex(good_, fewer)));
        ASSERT_THAT(engine, IsOk());
        bool isRefused = false;
        for (double isovalue = -0.5; isovalue < 10.0 && !isRefused; ++isovalue)
            isRefused = !engine.value()->slideTo(isovalue).isOk();
        EXPECT_TRUE(isRefused) << "without page " << page;
        EXPECT_TRUE(engine.value()->mesh().value().triangles.empty()) << "a failed move leaves no surface";
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, IndexDamage, testing::Values(IndexKind::Edges, IndexKind::Metacells),
                         [](const auto& kind) { return std::string(indexKindName(kind.param)); });

} // namespace
} // namespace isoslider::index
