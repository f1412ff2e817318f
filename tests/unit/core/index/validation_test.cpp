// Whether a fault of any kind is found in an index, and said to be where it is. Damage is what disks and forgers do:
// the latter make all checksums right.

#include <bit>
#include <functional>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/extract/slide_engine.h"
#include "core/index/format/block_codec.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/index_appendix.h"
#include "core/index/index_reader.h"
#include "core/index/index_writer.h"
#include "core/index/sample_store.h"
#include "core/index/validation/index_validation.h"
#include "core/index/validation/level_checks.h"
#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/memory_file_system.h"
#include "tests/support/page_records.h"
#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;

using SmallRecord = PointRecord<std::uint32_t>;

/// What a forger changes.
struct Forgery {
    preprocess::BuildOptions options; ///< of the index that is forged
    std::function<FarEnds(int level, std::size_t page, FarEnds farEnds)> farEnds; ///< that a page states
    std::function<void(int level, std::size_t page, std::vector<SmallRecord>& records)> records;
    std::function<void(std::uint64_t chunk, std::vector<float>& samples)> samples;
    std::function<void(std::uint64_t chunk, std::vector<std::byte>& bytes)> encoded;
    std::function<void(IndexMeta& meta)> meta;
};

class Validation : public testing::TestWithParam<IndexKind> {
protected:
    static std::shared_ptr<const ScalarGrid> volume(unsigned seed = 5) {
        GridGeometry geometry;
        geometry.dims = {35, 20, 18};
        geometry.spacing = {1.0, 0.5, 2.0};
        return test::makeVolume<float>(ScalarType::F32, geometry, [seed](auto x, auto y, auto z) {
            if (x == 17 && y == 9 && z == 3)
                return std::numeric_limits<float>::quiet_NaN();
            return static_cast<float>(std::sin(0.31 * static_cast<double>(x + seed)) * 8.0 +
                                      static_cast<double>((x * 7 + y * 13 + z * 29 + x * y * z) % 23));
        });
    }
    std::filesystem::path build(const preprocess::BuildOptions& changes = {},
                                const std::shared_ptr<const ScalarGrid>& grid = volume()) const {
        preprocess::BuildOptions options = changes;
        options.kind = GetParam();
        options.redundancyThreshold = 0.3;
        EXPECT_THAT(test::buildIndexOf(grid, folder_ / "a.isx", options), IsOk());
        return folder_ / "a.isx";
    }
    static ComparedVolume comparedWith(const std::shared_ptr<const ScalarGrid>& grid) {
        ComparedVolume compared;
        compared.geometry = grid->geometry();
        compared.type = grid->type();
        compared.read = [source = std::shared_ptr<io::VolumeSource>(io::makeMemorySource(grid))](
                            std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
            return source->readSlab(zBegin, zEnd, out);
        };
        return compared;
    }
    static std::vector<std::string> faultsOf(const std::filesystem::path& path, bool isFull,
                                             const std::shared_ptr<const ScalarGrid>& against = nullptr) {
        ValidationOptions options;
        options.isFull = isFull;
        if (against)
            options.volume = comparedWith(against);
        const auto report = validateIndex(path, options);
        EXPECT_THAT(report, IsOk());
        std::vector<std::string> lines;
        if (!report.isOk())
            return {report.error().line()};
        for (const IndexFault& fault : report.value().faults)
            lines.push_back(fault.line());
        EXPECT_EQ(report.value().isSound(), lines.empty());
        return lines;
    }

    /// The index written again as a forger would, with each checksum right; faults that a full validation finds.
    std::vector<std::string> faultsOfForgery(const Forgery& forgery,
                                             const std::shared_ptr<const ScalarGrid>& against = nullptr) const {
        const auto path = build(forgery.options);
        const auto reader = IndexReader::open(path).value();
        EXPECT_THAT(faultsOf(path, true), testing::IsEmpty());
        auto writer = IndexWriter::create(folder_ / "forged.isx", 99).value();
        writeChunks(*reader, *writer, forgery);
        IndexMeta meta = reader->meta();
        for (std::size_t level = 0; level < meta.levels.size(); ++level)
            writeLevel(*reader, *writer, static_cast<int>(level), forgery);
        EXPECT_THAT(writer->finish(meta), IsOk());
        if (forgery.meta) {
            const auto written = IndexReader::open(folder_ / "forged.isx").value();
            meta = written->meta();
            forgery.meta(meta);
            folder_.write("forged.isx", test::forgedIndex(test::readText(folder_ / "forged.isx"), meta));
        }
        return faultsOf(folder_ / "forged.isx", against == nullptr, against);
    }
    test::TemporaryFolder folder_;

private:
    static void writeChunks(const IndexReader& reader, IndexWriter& writer, const Forgery& forgery) {
        writeChunksAs<float>(reader, writer, forgery.samples, forgery.encoded);
    }
    template <class Value, class Change, class ChangeBytes>
    static void writeChunksAs(const IndexReader& reader, IndexWriter& writer, const Change& change,
                              const ChangeBytes& changeBytes) {
        const SampleStore store(reader);
        std::vector<Value> cube(SampleStore::kChunkSamples);
        std::uint64_t bytesRead = 0;
        for (const ChunkIndex chunk : firstIds<ChunkIndex>(store.chunks().chunkCount())) {
            ASSERT_THAT(store.read<Value>(chunk, std::span<Value, SampleStore::kChunkSamples>(cube), bytesRead),
                        IsOk());
            const ChunkExtent extent = store.chunks().extent(chunk);
            std::vector<Value> packed;
            for (int z = 0; z < extent[2]; ++z)
                for (int y = 0; y < extent[1]; ++y)
                    packed.insert(packed.end(), cube.begin() + 16 * (y + 16 * z),
                                  cube.begin() + 16 * (y + 16 * z) + extent[0]);
            if (change)
                change(chunk.number(), packed);
            std::vector<std::byte> bytes = encodeChunk<Value>(packed, extent);
            if (changeBytes)
                changeBytes(chunk.number(), bytes);
            ASSERT_THAT(writer.addChunk(bytes), IsOk());
        }
        ASSERT_THAT(writer.endChunks(), IsOk());
    }
    static void writeLevel(const IndexReader& reader, IndexWriter& writer, int level, const Forgery& forgery) {
        const LevelDirectory& directory = reader.meta().levels[static_cast<std::size_t>(level)];
        const auto writePage = [&](std::size_t i) {
            std::vector<std::byte> bytes;
            DecodedPage<std::uint32_t> page;
            ASSERT_THAT(reader.readPage(directory.pages[i], bytes), IsOk());
            ASSERT_THAT(decodePage<std::uint32_t>(bytes, reader.grid(), page, "x"), IsOk());
            std::vector<SmallRecord> records = test::recordsOf(page);
            if (forgery.records)
                forgery.records(level, i, records);
            PageEntry entry = directory.pages[i];
            entry.points = static_cast<std::uint32_t>(records.size());
            entry.edges = 0;
            entry.firstKey = entry.lastKey = records.front().key;
            for (const SmallRecord& record : records) {
                entry.edges += static_cast<std::uint32_t>(std::popcount(record.edgeMask));
                entry.firstKey = std::min<std::uint64_t>(entry.firstKey, record.key);
                entry.lastKey = std::max<std::uint64_t>(entry.lastKey, record.key);
            }
            const auto order = level == 0 ? PageOrder::Value : PageOrder::Id;
            const FarEnds farEnds = forgery.farEnds ? forgery.farEnds(level, i, page.farEnds) : page.farEnds;
            ASSERT_THAT(writer.addPage(SkipLevel(level), entry,
                                       encodePage<std::uint32_t>(records, order, farEnds, reader.grid())),
                        IsOk());
        };
        if (level == 0)
            for (std::size_t i = 0; i < directory.pages.size(); ++i)
                writePage(i);
        for (const BlockEntry& block : directory.blocks) {
            for (std::uint64_t i = 0; i < block.pageCount; ++i)
                writePage(block.firstPage + i);
            writer.endBlock(SkipLevel(level), block.firstKey, block.lastKey);
        }
    }
};

TEST_P(Validation, FindsNothingInASoundIndex) {
    const auto path = build();
    for (const bool isFull : {false, true}) {
        EXPECT_THAT(faultsOf(path, isFull), testing::IsEmpty());
        EXPECT_THAT(faultsOf(path, isFull, volume()), testing::IsEmpty());
    }
    ValidationOptions full;
    full.isFull = true;
    const auto report = validateIndex(path, full).value();
    EXPECT_EQ(report.bytes, std::filesystem::file_size(path)) << "every byte is looked at";
    EXPECT_EQ(report.chunks, 3 * 2 * 2u);
}

TEST_P(Validation, FindsNothingInSoundIndexesOfEachTypeAndShape) {
    for (const GridDims& dims : {GridDims{1, 1, 1}, {1, 1, 9}, {2, 1, 5}, {2, 2, 2}, {17, 16, 33}, {40, 9, 8}})
        for (const ScalarType type : kAllScalarTypes) {
            GridGeometry geometry;
            geometry.dims = dims;
            const auto grid = visitScalarType(type, [&](auto sample) {
                return test::makeVolume<decltype(sample)>(
                    type, geometry, [](auto x, auto y, auto z) { return (x * 37 + y * 11 + z * 5 + x * y * 3) % 100; });
            });
            SCOPED_TRACE(scalarTypeName(type));
            const auto path = build({}, grid);
            EXPECT_THAT(faultsOf(path, true, grid), testing::IsEmpty()) << dims[0] << 'x' << dims[1] << 'x' << dims[2];
        }
}

TEST_P(Validation, FindsNothingWhereCellsAreMerged) {
    if (GetParam() == IndexKind::Metacells)
        GTEST_SKIP() << "are merged while sliding";
    for (const auto measure : {extract::MergeBound::Measure::Scalar, extract::MergeBound::Measure::Distance}) {
        preprocess::BuildOptions options;
        options.mergeError = {measure, measure == extract::MergeBound::Measure::Scalar ? 3.0 : 0.4};
        const auto grid = test::hillsVolume({40, 33, 25});
        const auto path = build(options, grid);
        EXPECT_THAT(faultsOf(path, true, grid), testing::IsEmpty());
    }
}

TEST_P(Validation, FindsEachByteThatChanged) {
    const auto path = build();
    std::string bytes = test::readText(path);
    test::MemoryFileSystem memory(bytes);
    const std::uint64_t metaOffset = IndexReader::open(path).value()->metaOffset();
    std::mt19937 random(4);
    std::size_t found = 0, refused = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 1 + random() % (40 * test::kSparser)) {
        const char right = bytes[at];
        bytes[at] = static_cast<char>(right ^ 1 << random() % 8);
        const auto report = validateIndex("a.isx", {}, {}, memory);
        if (report.isOk()) {
            ASSERT_FALSE(report.value().isSound()) << "byte " << at;
            ASSERT_EQ(report.value().faultCount, 1u) << "byte " << at;
            ++found;
        } else {
            ASSERT_TRUE(at < kPreambleBytes || at >= metaOffset) << "header or directory only";
            ++refused;
        }
        bytes[at] = right;
    }
    EXPECT_GT(found, 100u / test::kSparser);
    EXPECT_GT(refused, 5u / test::kSparser);
}

TEST_P(Validation, StatesWhereDamageIs) {
    const auto path = build();
    const std::string good = test::readText(path);
    const auto reader = IndexReader::open(path).value();
    const auto damagedAt = [&](std::uint64_t offset) {
        std::string bytes = good;
        bytes[offset] = static_cast<char>(~bytes[offset]);
        return faultsOf(folder_.write("damaged.isx", bytes), false);
    };
    const PageEntry& page = reader->meta().levels[0].pages[0];
    EXPECT_THAT(damagedAt(page.offset + page.bytes / 2),
                testing::ElementsAre(testing::AllOf(HasSubstr("page 0 of level 0 fails its checksum (at byte " +
                                                              std::to_string(page.offset) + "; isovalues -"),
                                                    HasSubstr(" to "))));
    const SampleStore store(*reader);
    std::uint64_t bytesRead = 0;
    const ChunkPlace chunk = store.find(ChunkIndex(4), bytesRead).value();
    EXPECT_THAT(damagedAt(chunk.offset + 3),
                testing::ElementsAre(AllOf(HasSubstr("chunk 4 "), HasSubstr("grid points 16,16,0 to 31,19,15"))));
    const ChunkGroupEntry& group = reader->meta().chunkGroups[0];
    EXPECT_THAT(damagedAt(group.offset + group.chunkBytes), testing::ElementsAre(HasSubstr("table of chunk group 0")));
}

TEST_P(Validation, RefusesWhatIsNoIndex) {
    const std::string good = test::readText(build());
    const auto errorOf = [&](std::string bytes) {
        const auto report = validateIndex(folder_.write("other.isx", bytes));
        return report.isOk() ? Error() : report.error();
    };
    EXPECT_EQ(errorOf("a text of some length").code, ErrorCode::InvalidArgument);
    std::string newer = good;
    newer[12] = static_cast<char>(kFormatMajor + 1);
    EXPECT_EQ(errorOf(newer).code, ErrorCode::UnsupportedVersion);
    EXPECT_THAT(errorOf(newer).message, HasSubstr("newer version"));
    EXPECT_EQ(errorOf(good.substr(0, good.size() - 1)).code, ErrorCode::Corruption);
    EXPECT_THAT(validateIndex(folder_ / "none.isx"), HasError(ErrorCode::NotFound));
}

TEST_P(Validation, IsCancelled) {
    std::stop_source stop;
    stop.request_stop();
    JobControl job;
    job.stop = stop.get_token();
    ValidationOptions full;
    full.isFull = true;
    EXPECT_THAT(validateIndex(build(), full, job), HasError(ErrorCode::Cancelled));
}

TEST_P(Validation, FindsGapsAndOverlaps) {
    const std::string good = test::readText(build());
    const auto reader = IndexReader::open(folder_ / "a.isx").value();
    IndexMeta meta = reader->meta();
    meta.levels[0].pages[0].offset += 1;
    meta.levels[0].pages[0].bytes -= 1;
    EXPECT_THAT(faultsOf(folder_.write("b.isx", test::forgedIndex(good, meta)), false),
                Contains(HasSubstr("comes after 1 bytes of no part")));
    meta = reader->meta();
    auto& last = meta.levels[0].pages.back();
    last.offset -= 1;
    last.bytes += 1;
    EXPECT_THAT(faultsOf(folder_.write("c.isx", test::forgedIndex(good, meta)), false),
                Contains(HasSubstr("begins inside the part before it")));
}

TEST_P(Validation, FindsForgedFacts) {
    const auto expectFound = [&](const char* words, std::function<void(IndexMeta&)> change) {
        EXPECT_THAT(faultsOfForgery({.meta = std::move(change)}), Contains(HasSubstr(words))) << words;
    };
    expectFound("histogram does not count", [](IndexMeta& meta) { ++meta.info.histogram.counts[7]; });
    expectFound("histogram has another range", [](IndexMeta& meta) { meta.info.histogram.max += 1.0; });
    expectFound("curve of active edges states", [](IndexMeta& meta) { ++meta.info.activeEdgesPerBin[100]; });
    expectFound("distinct values is not possible", [](IndexMeta& meta) { meta.info.distinctValues = 0; });
    expectFound("level 0 should have", [](IndexMeta& meta) { ++meta.info.levels[0].blocks; });
    expectFound("activated entries", [](IndexMeta& meta) { --meta.info.levels[0].activatedEdges; });
    expectFound("records", [](IndexMeta& meta) { ++meta.info.levels[0].points; });
    expectFound("redundant entries", [](IndexMeta& meta) { ++meta.info.levels[1].redundantRemoved; });
    expectFound("has other keys than the directory", [](IndexMeta& meta) { --meta.levels[0].pages[0].firstKey; });
    expectFound("has other counts than the directory", [](IndexMeta& meta) { ++meta.levels[0].pages[0].edges; });
    expectFound("bytes of chunks", [](IndexMeta& meta) { ++meta.info.chunkBytes; });
    expectFound("missing samples is 2", [](IndexMeta& meta) {
        ++meta.info.nanCount;
        --meta.info.histogram.counts[std::size_t{0} + static_cast<std::size_t>(
                                                          std::find_if(meta.info.histogram.counts.begin(),
                                                                       meta.info.histogram.counts.end(),
                                                                       [](std::uint64_t count) { return count > 0; }) -
                                                          meta.info.histogram.counts.begin())];
    });
    expectFound("distinct values is", [](IndexMeta& meta) { --meta.info.distinctValues; });
    expectFound("missing cells are not those", [](IndexMeta& meta) { meta.missingCells[0].cells[2] ^= 1; });
    expectFound("value range", [](IndexMeta& meta) { meta.info.max += 1.0; });
}

TEST_P(Validation, FindsForgedRecords) {
    const auto expectFound = [&](const char* words,
                                 std::function<void(int level, std::size_t page, std::vector<SmallRecord>&)> change) {
        EXPECT_THAT(faultsOfForgery({.records = std::move(change)}), Contains(HasSubstr(words))) << words;
    };
    const auto onlyAt = [](int wanted, auto change) {
        return [wanted, change](int level, std::size_t page, std::vector<SmallRecord>& records) {
            if (level == wanted && page == 0)
                change(records[records.size() / 2]);
        };
    };
    const bool isEdges = GetParam() == IndexKind::Edges;
    const auto change = [isEdges](SmallRecord& record) { // where an edge goes, or the other key of a brick
        std::uint32_t& far = record.farKeys[std::countr_zero(unsigned{record.edgeMask})];
        far = isEdges ? record.key + (far > record.key ? ~0u : 1u) : far + 1;
    };
    expectFound("two ends disagree", onlyAt(0, change));
    expectFound("of level 1 is not the net change of level 0", onlyAt(1, change));
    expectFound("has records out of order", [](int level, std::size_t page, std::vector<SmallRecord>& records) {
        if (level == 1 && page == 0)
            std::swap(records[0], records[1]);
    });
    expectFound("of level 1 is not the net change of level 0",
                [](int level, std::size_t page, std::vector<SmallRecord>& records) {
                    if (level == 1 && page == 0 && records.size() > 1)
                        records.pop_back();
                });
}

// A page may lack what is looked at in those of its kind.
TEST_P(Validation, FindsPagesThatStateOtherFarEnds) {
    Forgery forgery;
    forgery.farEnds = [](int level, std::size_t page, FarEnds farEnds) {
        return level > 0 || page > 0 ? farEnds : farEnds == FarEnds::Keys ? FarEnds::Directions : FarEnds::Keys;
    };
    EXPECT_THAT(faultsOfForgery(forgery),
                testing::ElementsAre(HasSubstr("page 0 of level 0 is one of another format version")));
}

// Where cells are merged, edges do not follow from samples alone.
TEST_P(Validation, FindsPointsOfOtherValuesWhereCellsAreMerged) {
    if (GetParam() != IndexKind::Edges)
        GTEST_SKIP() << "only of edges";
    Forgery forgery;
    forgery.options.mergeError = {extract::MergeBound::Measure::Scalar, 0.5};
    bool hasChanged = false;
    forgery.records = [&](int level, std::size_t, std::vector<SmallRecord>& records) {
        for (std::size_t i = 0; i + 1 < records.size() && level == 0 && !hasChanged; ++i) {
            SmallRecord& record = records[i];
            const std::uint32_t next = records[i + 1].key;
            if (record.form != record_form::kPoint || next - record.key < 2)
                continue;
            for (std::uint32_t& far : record.farKeys)
                far = far > record.key ? next + 1 : record.key - 1;
            record.key += (next - record.key) / 2;
            hasChanged = true;
        }
    };
    const auto faults = faultsOfForgery(forgery);
    ASSERT_TRUE(hasChanged);
    EXPECT_THAT(faults, Contains(HasSubstr("level 0 has points of other values than the samples")));
}

// Numbers of points, axes and edges are small and beside each other: their hashes must not fall together, nor sums.
TEST(ValidationHashes, TellEdgesAndTheirDirectionsApart) {
    std::set<std::uint64_t> edges, ends, bricks;
    constexpr std::uint64_t kIds = 2048;
    for (std::uint64_t id = 0; id < kIds; ++id) {
        for (int axis = 0; axis < 3; ++axis)
            edges.insert(edgeHash(id, axis));
        for (int edge = 0; edge < kPointEdges; ++edge)
            for (const bool rises : {false, true})
                ends.insert(edgeEndHash(id, 5, edge, rises));
        for (std::uint64_t least = 0; least < 8; ++least)
            bricks.insert(intervalHash(id, least, 9));
    }
    EXPECT_EQ(edges.size(), 3 * kIds);
    EXPECT_EQ(ends.size(), 12 * kIds);
    EXPECT_EQ(bricks.size(), 8 * kIds);
    for (std::uint64_t id = 0; id < kIds; id += 2)
        for (int edge = 0; edge < kPointEdges; ++edge)
            EXPECT_NE(edgeEndHash(id, 5, edge, true) + edgeEndHash(id + 1, 5, edge, true),
                      edgeEndHash(id, 5, edge, false) + edgeEndHash(id + 1, 5, edge, false));
}

// They add up to nothing, so no sum shows them, and counts are stated to fit.
TEST_P(Validation, FindsEdgesThatAreRedundantInTheirBlock) {
    if (GetParam() != IndexKind::Edges)
        GTEST_SKIP() << "of bricks far keys are stated";
    Forgery forgery;
    bool hasAdded = false;
    forgery.records = [&](int level, std::size_t, std::vector<SmallRecord>& records) {
        for (std::size_t i = 0; i + 1 < records.size() && level == 1 && !hasAdded; ++i) {
            SmallRecord &lower = records[i], &upper = records[i + 1];
            const bool areBeside = upper.id() == lower.id() + 1 && localOf(lower.id()).number() % 8 != 7;
            if (!areBeside || (lower.edgeMask & 2) != 0 || (upper.edgeMask & 1) != 0)
                continue;
            lower.edgeMask |= 2;
            lower.farKeys[1] = lower.key + 1;
            upper.edgeMask |= 1;
            upper.farKeys[0] = upper.key - 1;
            hasAdded = true;
        }
    };
    forgery.meta = [](IndexMeta& meta) {
        meta.info.levels[1].edges += 2;
        meta.info.levels[1].activatedEdges += 1;
        meta.info.levels[1].redundantRemoved -= 2;
        if (meta.info.levels.size() > 2)
            meta.info.levels[2].redundantRemoved += 2;
    };
    const auto faults = faultsOfForgery(forgery);
    ASSERT_TRUE(hasAdded);
    EXPECT_THAT(faults, Contains(HasSubstr("where the edges of the samples make")));
    EXPECT_THAT(faults, testing::Not(Contains(HasSubstr("net change"))));
}

// Behind right checksums.
TEST_P(Validation, FindsForgedChunks) {
    Forgery forgery;
    forgery.encoded = [](std::uint64_t chunk, std::vector<std::byte>& bytes) {
        if (chunk == 4)
            bytes.pop_back();
    };
    EXPECT_THAT(faultsOfForgery(forgery), testing::ElementsAre(AllOf(HasSubstr("chunk 4 cannot be decoded"),
                                                                     HasSubstr("grid points 16,16,0 to 31,19,15"))));
}

TEST_P(Validation, FindsForgedSamples) {
    Forgery forgery;
    forgery.samples = [](std::uint64_t chunk, std::vector<float>& samples) {
        if (chunk == 4)
            samples[300] = 1000.0f;
    };
    const auto faults = faultsOfForgery(forgery);
    EXPECT_THAT(faults, Contains(HasSubstr("value range is not that of the samples")));
    EXPECT_THAT(faults,
                Contains(HasSubstr(GetParam() == IndexKind::Edges ? "level 0 has other edges than the samples"
                                                                  : "level 0 has other bricks than the samples")));
    EXPECT_THAT(faultsOfForgery(forgery, volume()),
                testing::ElementsAre(AllOf(HasSubstr("chunk 4 has other samples than the volume"),
                                           HasSubstr("grid points 16,16,0 to 31,19,15"))));
}

// Stored samples that cannot be read say nothing of the list; the volume does.
TEST_P(Validation, ComparesTheListWithTheVolumeWhereSamplesAreDamaged) {
    const auto path = build();
    const auto grid = volume();
    std::vector<float> samples(grid->values<float>().begin(), grid->values<float>().end());
    samples[5000] = 29.0f;
    const auto other =
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(grid->geometry(), grid->type(), samples));
    const auto isTold =
        Contains(HasSubstr(GetParam() == IndexKind::Edges ? "level 0 has other edges than the volume"
                                                          : "level 0 has other bricks than the volume"));
    EXPECT_THAT(faultsOf(path, true, other), testing::Not(isTold)) << "it has those of its samples";
    const auto reader = IndexReader::open(path).value();
    std::uint64_t bytesRead = 0;
    const ChunkPlace chunk = SampleStore(*reader).find(ChunkIndex(4), bytesRead).value();
    std::string bytes = test::readText(path);
    bytes[chunk.offset + 3] = static_cast<char>(~bytes[chunk.offset + 3]);
    EXPECT_THAT(faultsOf(folder_.write("damaged.isx", bytes), true, other), isTold);
    EXPECT_THAT(faultsOf(folder_ / "damaged.isx", true, grid), testing::Not(isTold));
}

// Edges are counted by brick, in whichever measure no cells are merged.
TEST_P(Validation, MovesTellEdgesFromThoseOfOtherSamples) {
    if (GetParam() != IndexKind::Edges)
        GTEST_SKIP() << "say nothing of edges";
    Forgery forgery;
    forgery.samples = [](std::uint64_t chunk, std::vector<float>& samples) {
        if (chunk == 0) // away from the missing sample, beside which there is no telling
            samples[2 + 16 * (2 + 16 * 2)] = 25.0f;
    };
    EXPECT_THAT(faultsOfForgery(forgery), testing::Not(testing::IsEmpty()));
    for (const auto measure : {extract::MergeBound::Measure::Scalar, extract::MergeBound::Measure::Distance}) {
        const auto engine = extract::SlideEngine::open(folder_ / "forged.isx");
        ASSERT_THAT(engine, IsOk());
        engine.value()->setMergeBound({measure, 0.0});
        std::string problem;
        for (double isovalue = 0.5; isovalue < 25.0 && problem.empty(); ++isovalue)
            if (const auto stats = engine.value()->slideTo(isovalue); !stats.isOk())
                problem = stats.error().message;
        EXPECT_THAT(problem, HasSubstr("its edges are not those of its samples"));
    }
}

TEST_P(Validation, TellsVolumesApart) {
    const auto path = build();
    EXPECT_THAT(faultsOf(path, false, volume(6)), testing::Not(testing::IsEmpty()));
    EXPECT_THAT(faultsOf(path, false, test::noiseVolume({35, 20, 18}, 1)),
                testing::ElementsAre(HasSubstr("scalar type")));
    EXPECT_THAT(faultsOf(path, false, test::hillsVolume({35, 20, 17})),
                testing::ElementsAre(HasSubstr("grid has 35 x 20 x 18 points, the volume 35 x 20 x 17")));
    // One sample by one step.
    const auto grid = volume();
    std::vector<float> samples(grid->values<float>().begin(), grid->values<float>().end());
    samples[5000] = std::nextafter(samples[5000], 100.0f);
    const auto other =
        std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(grid->geometry(), grid->type(), samples));
    EXPECT_THAT(faultsOf(path, false, other),
                Contains(AnyOf(HasSubstr("level 0 has other edges than the volume"), HasSubstr("has other samples"))));
    GridGeometry moved = grid->geometry();
    moved.origin[1] += 0.5;
    const auto elsewhere = std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<float>(
        moved, grid->type(), std::vector<float>(grid->values<float>().begin(), grid->values<float>().end())));
    EXPECT_THAT(faultsOf(path, false, elsewhere), testing::ElementsAre(HasSubstr("grid lies elsewhere")));
}

TEST_P(Validation, TellsADamagedAppendixFromAnUnfinishedOne) {
    const auto path = build();
    const std::string good = test::readText(path);
    EXPECT_THAT(faultsOf(folder_.write("b.isx", good + std::string(100, '\0')), false),
                testing::ElementsAre(HasSubstr("appendix is not finished, or has lost its header (at byte " +
                                               std::to_string(good.size()))));
    const auto reader = IndexReader::open(path).value();
    const std::vector<std::byte> text(40, std::byte{7});
    ASSERT_THAT(writeAppendix(
                    *reader, 1, [&](std::size_t) { return text; }, text, true),
                IsOk());
    EXPECT_THAT(faultsOf(path, false), testing::IsEmpty());
    const std::string whole = test::readText(path);
    std::string damaged = whole;
    damaged.back() = static_cast<char>(damaged.back() ^ 1);
    EXPECT_THAT(faultsOf(folder_.write("c.isx", damaged), false), testing::ElementsAre(HasSubstr("appendix fails")));
    damaged = whole;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(good.size()), 64, '\0');
    EXPECT_THAT(faultsOf(folder_.write("d.isx", damaged), false), testing::ElementsAre(HasSubstr("lost its header")));
    for (const std::size_t more : {1u, 63u, 64u, 5000u})
        for (const char byte : {'\0', 'x'})
            EXPECT_THAT(
                faultsOf(folder_.write("e.isx", whole + std::string(more, byte)), false),
                testing::ElementsAre(HasSubstr("appendix is followed by bytes that belong to nothing (at byte " +
                                               std::to_string(whole.size()))))
                << more;
}

TEST_P(Validation, DescribesAFewFaultsAndCountsAll) {
    const auto path = build();
    std::string bytes = test::readText(path);
    const auto reader = IndexReader::open(path).value();
    for (const LevelDirectory& level : reader->meta().levels)
        for (const PageEntry& page : level.pages)
            bytes[page.offset + 40] = static_cast<char>(bytes[page.offset + 40] ^ 1);
    ValidationOptions options;
    options.mostFaults = 1;
    const auto report = validateIndex(folder_.write("b.isx", bytes), options);
    ASSERT_THAT(report, IsOk());
    EXPECT_EQ(report.value().faults.size(), 1u);
    EXPECT_GE(report.value().faultCount, 2u);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Validation, testing::Values(IndexKind::Edges, IndexKind::Metacells),
                         [](const auto& kind) { return std::string(indexKindName(kind.param)); });

} // namespace
} // namespace isoslider::index
