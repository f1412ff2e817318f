// core/index/format/FORMAT.md against the code: its worked example, and every page of real indices.

#include <algorithm>
#include <bit>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "core/index/sample_store.h"
#include "core/index/validation/index_validation.h"
#include "tests/format/document_decoder.h"
#include "tests/property/random_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/index_chunks.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::index {
namespace {

using test::IsOk;

// The bytes of a ```hex block of the document; a '#' begins a remark.
constexpr int kPageExample = 1, kChunkExample = 2, kPageOfVersion6Example = 3, kPageOfVersion4Example = 4;
std::vector<std::byte> bytesOfWorkedExample(int wanted = kPageExample) {
    std::istringstream text(
        test::readText(std::filesystem::path(test::sourceFolder()) / "core/index/format/FORMAT.md"));
    std::vector<std::byte> bytes;
    bool isInside = false;
    int block = 0;
    for (std::string line; std::getline(text, line);) {
        if (line.rfind("```", 0) == 0) {
            isInside = line == "```hex";
            block += isInside;
            continue;
        }
        if (!isInside || block != wanted)
            continue;
        std::istringstream fields(line.substr(0, line.find('#')));
        for (std::string field; fields >> field;)
            bytes.push_back(static_cast<std::byte>(std::stoi(field, nullptr, 16)));
    }
    return bytes;
}

std::shared_ptr<const ScalarGrid> exampleVolume() {
    return test::makeVolume<std::uint8_t>(ScalarType::U8, test::cubeGeometry(2),
                                          [](auto x, auto y, auto z) { return x + y + z == 3 ? 9 : 3; });
}

template <class Key>
void expectSame(const DecodedPage<Key>& page, const std::vector<test::DocumentPoint>& document) {
    ASSERT_EQ(page.pointCount(), document.size());
    std::size_t edge = 0;
    for (std::size_t i = 0; i < document.size(); ++i) {
        const auto& point = document[i];
        ASSERT_EQ(page.keys[i], point.key) << i;
        ASSERT_EQ(page.ids[i], point.id) << i;
        ASSERT_EQ(page.masks[i], point.mask) << i;
        ASSERT_EQ(page.farEnds == FarEnds::Directions ? int{page.rising[i]} : -1, point.rising) << i;
        ASSERT_EQ(page.hasNormals() ? int{page.normals[i]} : -1, point.normal) << i;
        for (std::size_t k = 0; k < point.farKeys.size(); ++k, ++edge) {
            ASSERT_EQ(page.farKeys[edge], point.farKeys[k]) << i << " " << k;
            if (page.hasNormals()) {
                ASSERT_EQ(page.farNormals[edge], point.farNormals[k]) << i << " " << k;
            }
        }
    }
    EXPECT_EQ(edge, page.farKeys.size());
}

// As the text has it: directions; with far keys as versions 5 and 6 have it, and with normals besides as version 4.
TEST(FormatDocument, ExampleSaysWhatItsTextSays) {
    const auto bytes = bytesOfWorkedExample(), ofVersion6 = bytesOfWorkedExample(kPageOfVersion6Example);
    ASSERT_EQ(bytes.size(), 74u);
    ASSERT_EQ(ofVersion6.size(), 81u);
    const auto points = test::DocumentDecoder(bytes).decode(512);
    const auto withKeys = test::DocumentDecoder(ofVersion6).decode(512);
    const auto withNormals = test::DocumentDecoder(bytesOfWorkedExample(kPageOfVersion4Example)).decode(512);
    ASSERT_TRUE(points.has_value() && withKeys.has_value() && withNormals.has_value());
    ASSERT_EQ(points->size(), withNormals->size());
    for (std::size_t i = 0; i < points->size(); ++i) {
        for (const auto& other : {(*withKeys)[i], (*withNormals)[i]}) {
            EXPECT_EQ((*points)[i].key, other.key);
            EXPECT_EQ((*points)[i].id, other.id);
            EXPECT_EQ((*points)[i].mask, other.mask);
            EXPECT_EQ((*points)[i].rising, other.farKeys.front() > other.key ? other.mask : 0);
        }
        EXPECT_EQ((*withKeys)[i].farKeys, (*withNormals)[i].farKeys);
        EXPECT_TRUE((*points)[i].farKeys.empty());
        EXPECT_EQ((*points)[i].normal, -1);
        EXPECT_TRUE((*points)[i].farNormals.empty());
    }
}

TEST(FormatDocument, ExampleOfVersion4SaysWhatItsTextSays) {
    const auto bytes = bytesOfWorkedExample(kPageOfVersion4Example);
    ASSERT_EQ(bytes.size(), 117u);
    const auto points = test::DocumentDecoder(bytes).decode(512);
    ASSERT_TRUE(points.has_value());
    ASSERT_EQ(points->size(), 4u);
    struct Expected {
        std::uint64_t key, id;
        int mask, normal;
    };
    const Expected expected[] = {
        {3, 9, 1 << 5, 0x7f7f}, {3, 65, 1 << 3, 0x8100}, {3, 72, 1 << 1, 0x0081}, {9, 73, 21, 0xabab}};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ((*points)[i].key, expected[i].key);
        EXPECT_EQ((*points)[i].id, expected[i].id);
        EXPECT_EQ((*points)[i].mask, expected[i].mask);
        EXPECT_EQ((*points)[i].normal, expected[i].normal);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ((*points)[i].farKeys, std::vector<std::uint64_t>{9});
        EXPECT_EQ((*points)[i].farNormals, std::vector<int>{0xabab});
    }
    EXPECT_EQ((*points)[3].farKeys, (std::vector<std::uint64_t>{3, 3, 3}));
    EXPECT_EQ((*points)[3].farNormals, (std::vector<int>{0x0081, 0x8100, 0x7f7f}));
}

TEST(FormatDocument, ExampleIsDecodedAlikeByTheProduct) {
    for (const int example : {kPageExample, kPageOfVersion6Example, kPageOfVersion4Example}) {
        const auto bytes = bytesOfWorkedExample(example);
        DecodedPage<std::uint16_t> page;
        ASSERT_THAT(decodePage<std::uint16_t>(bytes, BrickGrid({2, 2, 2}), page, "FORMAT.md"), IsOk());
        EXPECT_EQ(page.hasNormals(), example == kPageOfVersion4Example);
        EXPECT_EQ(page.farEnds == FarEnds::Directions, example == kPageExample);
        const auto points = test::DocumentDecoder(bytes).decode(512);
        ASSERT_TRUE(points.has_value());
        expectSame(page, *points);
    }
}

// The chunk of the same volume.
TEST(FormatDocument, ExampleOfAChunkIsWhatABuildWrites) {
    const auto bytes = bytesOfWorkedExample(kChunkExample);
    ASSERT_EQ(bytes.size(), 10u);
    std::vector<std::uint8_t> samples(8);
    ASSERT_TRUE(decodeChunk<std::uint8_t>(bytes, {2, 2, 2}, samples));
    EXPECT_EQ(samples, (std::vector<std::uint8_t>{3, 3, 3, 3, 3, 3, 3, 9}));
    const test::TemporaryFolder folder;
    ASSERT_THAT(test::buildIndexOf(exampleVolume(), folder / "example.isx"), IsOk());
    const auto reader = IndexReader::open(folder / "example.isx");
    ASSERT_THAT(reader, IsOk());
    const SampleStore store(*reader.value());
    std::uint64_t bytesRead = 0;
    const ChunkPlace place = store.find(ChunkIndex(), bytesRead).value();
    std::vector<std::byte> written;
    ASSERT_THAT(reader.value()->readPart(place.offset, place.bytes, place.checksum, written), IsOk());
    EXPECT_EQ(written, bytes);
}

TEST(FormatDocument, ExampleIsWhatABuildWrites) {
    const test::TemporaryFolder folder;
    ASSERT_THAT(test::buildIndexOf(exampleVolume(), folder / "example.isx"), IsOk());
    const auto reader = IndexReader::open(folder / "example.isx");
    ASSERT_THAT(reader, IsOk());
    const auto& levels = reader.value()->meta().levels;
    ASSERT_EQ(levels[0].pages.size(), 1u);
    std::vector<std::byte> bytes;
    ASSERT_THAT(reader.value()->readPage(levels[0].pages[0], bytes), IsOk());
    EXPECT_EQ(bytes, bytesOfWorkedExample());
    EXPECT_EQ(levels.size(), 1u) << "a single block over all values would hold nothing";
}

// A page with normals, or with far keys of edges, in an index of this version.
TEST(FormatDocument, PagesOfAnotherVersionAreRefused) {
    for (const int example : {kPageOfVersion4Example, kPageOfVersion6Example}) {
        const test::TemporaryFolder folder;
        ASSERT_THAT(test::buildIndexOf(exampleVolume(), folder / "good.isx"), IsOk());
        const IndexMeta good = IndexReader::open(folder / "good.isx").value()->meta();

        auto writer = IndexWriter::create(folder / "earlier_page.isx", 1);
        ASSERT_THAT(writer, IsOk());
        ASSERT_THAT(test::addBlankSamples<std::uint8_t>({2, 2, 2}, *writer.value()), IsOk());
        ASSERT_THAT(writer.value()->addPage(kLevel0, good.levels[0].pages[0], bytesOfWorkedExample(example)), IsOk());
        ASSERT_THAT(writer.value()->finish(good), IsOk());

        ValidationOptions full;
        full.isFull = true;
        const auto report = validateIndex(folder / "earlier_page.isx", full);
        ASSERT_THAT(report, IsOk());
        EXPECT_TRUE(
            std::any_of(report.value().faults.begin(), report.value().faults.end(), [](const IndexFault& fault) {
                return fault.problem.find("another format version") != std::string::npos;
            }));
    }
}

TEST(FormatDocument, PreambleFieldsAreWhereTheTableSays) {
    const test::TemporaryFolder folder;
    ASSERT_THAT(test::buildIndexOf(exampleVolume(), folder / "example.isx"), IsOk());
    const std::string file = test::readText(folder / "example.isx");
    const auto number = [&](std::size_t at, int bytes) {
        std::uint64_t value = 0;
        for (int i = bytes - 1; i >= 0; --i)
            value = value << 8 | static_cast<unsigned char>(file.at(at + static_cast<std::size_t>(i)));
        return value;
    };
    EXPECT_EQ(file.substr(0, 12), std::string("ISOSLIDE\r\n\x1a\n"));
    EXPECT_EQ(number(12, 2), 7u);
    EXPECT_EQ(number(14, 2), 0u);
    const std::size_t metaAt = 64 + 10 + 10 + 74;
    EXPECT_EQ(number(16, 8), metaAt) << "meta follows the only chunk, its group's table and the only page";
    EXPECT_EQ(number(16, 8) + number(24, 8), file.size());
    EXPECT_EQ(number(40, 8), file.size());
    // Meta: kind, scalar type, then the dims.
    EXPECT_EQ(number(metaAt, 1), 0u);
    EXPECT_EQ(number(metaAt + 1, 1), 0u);
    for (const std::size_t axis : {0, 1, 2})
        EXPECT_EQ(number(metaAt + 2 + 8 * axis, 8), 2u);
}

// Both orders, all plane modes and kinds: whatever these volumes bring about.
template <class Sample>
void expectDocumentReadsAllPages(const std::shared_ptr<const ScalarGrid>& volume, IndexKind kind, int& compressed,
                                 int& flags) {
    const test::TemporaryFolder folder;
    preprocess::BuildOptions options;
    options.kind = kind;
    ASSERT_THAT(test::buildIndexOf(volume, folder / "a.isx", options), IsOk());
    const auto opened = IndexReader::open(folder / "a.isx");
    ASSERT_THAT(opened, IsOk());
    const IndexReader& reader = *opened.value();
    std::vector<std::byte> bytes;
    DecodedPage<KeyOf<Sample>> page;
    for (const auto& level : reader.meta().levels)
        for (const PageEntry& entry : level.pages) {
            ASSERT_THAT(reader.readPage(entry, bytes), IsOk());
            ASSERT_THAT(decodePage<KeyOf<Sample>>(bytes, reader.grid(), page, "a.isx"), IsOk());
            const auto points = test::DocumentDecoder(bytes).decode(reader.grid().idCount());
            ASSERT_TRUE(points.has_value());
            expectSame(page, *points);
            flags |= static_cast<int>(bytes[19]);
            for (std::uint32_t plane = 0; plane < static_cast<std::uint32_t>(bytes[20]); ++plane)
                compressed += static_cast<int>(bytes[32 + 4 * plane + 3]) >> 6 == 2;
        }
}

TEST(FormatDocument, ReadsEveryPageOfRealIndices) {
    for (const IndexKind kind : {IndexKind::Edges, IndexKind::Metacells}) {
        int compressed = 0, flags = 0;
        expectDocumentReadsAllPages<std::uint16_t>(test::hillsVolume({40, 33, 21}), kind, compressed, flags);
        EXPECT_EQ(flags, kind == IndexKind::Edges ? 8 + 16 : 8);
        expectDocumentReadsAllPages<std::uint8_t>(test::noiseVolume({19, 17, 18}, 7), kind, compressed, flags);
        const auto waves =
            test::makeVolume<double>(ScalarType::F64, test::cubeGeometry(14), [](auto x, auto y, auto z) {
                return std::sin(0.7 * static_cast<double>(x)) - 1e-3 * static_cast<double>(y * z);
            });
        expectDocumentReadsAllPages<double>(waves, kind, compressed, flags);
        if (kind == IndexKind::Edges) {
            EXPECT_GT(compressed, 0);
        }
    }
}

// As versions 5 and 6 had it: predictions by mirroring are not made any more, and read.
TEST(FormatDocument, ReadsPagesWithMirroredFarKeys) {
    const auto opened = IndexReader::open(std::filesystem::path(test::sourceFolder()) / "tests/data/golden_v6.isx");
    ASSERT_THAT(opened, IsOk());
    const IndexReader& reader = *opened.value();
    std::vector<std::byte> bytes;
    DecodedPage<std::uint32_t> page;
    int flags = 0;
    for (const auto& level : reader.meta().levels)
        for (const PageEntry& entry : level.pages) {
            ASSERT_THAT(reader.readPage(entry, bytes), IsOk());
            ASSERT_THAT(decodePage<std::uint32_t>(bytes, reader.grid(), page, "golden"), IsOk());
            flags |= static_cast<int>(bytes[19]);
            const auto points = test::DocumentDecoder(bytes).decode(reader.grid().idCount());
            ASSERT_TRUE(points.has_value());
            expectSame(page, *points);
        }
    EXPECT_EQ(flags, 1 + 8);
}

} // namespace
} // namespace isoslider::index
