// A grid with more points than 32 bits count, nearly all of whose samples are the same.

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "core/extract/full_extraction.h"
#include "core/extract/slide_engine.h"
#include "core/index/format/block_codec.h"
#include "core/index/format/chunk_table.h"
#include "core/index/index_writer.h"
#include "tests/property/test_volumes.h"
#include "tests/support/forged_index.h"
#include "tests/support/page_records.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_paths.h"

namespace isoslider::extract {
namespace {

using test::IsOk;

/// A group of chunks, written to an index with seed 1. `chunkOf`: the bytes of each.
template <class ChunkOf>
index::ChunkGroupEntry writeGroup(const index::ChunkGrid& chunks, std::uint64_t number, const ChunkOf& chunkOf,
                                  index::IndexWriter& writer) {
    index::ChunkGroupEntry group{writer.sizeBytes(), 0, 0};
    std::vector<std::byte> table;
    for (std::uint64_t i = 0; i < index::chunksInGroup(chunks, number); ++i) {
        const auto bytes = chunkOf(index::ChunkIndex(number * index::kGroupChunks + i));
        const std::uint64_t at = group.offset + group.chunkBytes;
        index::putChunkPlace(table, {at, static_cast<std::uint16_t>(bytes.size()), index::pageChecksum(bytes, 1, at)});
        EXPECT_THAT(writer.addChunk(bytes), IsOk());
        group.chunkBytes += bytes.size();
    }
    EXPECT_THAT(writer.endChunks(), IsOk());
    group.checksum = index::pageChecksum(table, 1, group.offset + group.chunkBytes);
    return group;
}

/// The samples of a chunk: 0 but where those of `corner` lie, at the end of the grid.
std::vector<std::byte> sparseChunk(const index::ChunkGrid& chunks, index::ChunkIndex chunk, const GridDims& dims,
                                   const ScalarGrid& corner) {
    const auto at = chunks.chunkCoords(chunk);
    const index::ChunkExtent extent = chunks.extent(chunk);
    std::vector<std::uint16_t> samples;
    for (int z = 0; z < extent[2]; ++z)
        for (int y = 0; y < extent[1]; ++y)
            for (int x = 0; x < extent[0]; ++x) {
                std::array<std::int64_t, 3> p{x, y, z};
                bool isInCorner = true;
                for (int a = 0; a < 3; ++a) {
                    std::int64_t& c = p[static_cast<std::size_t>(a)];
                    c += index::kChunkSide * at[static_cast<std::size_t>(a)] - (dims[a] - corner.dims()[a]);
                    isInCorner = isInCorner && c >= 0;
                }
                samples.push_back(isInCorner ? static_cast<std::uint16_t>(corner.valueAt(p[0], p[1], p[2])) : 0);
            }
    return index::encodeChunk<std::uint16_t>(samples, extent);
}

/// An index of a grid of 5 * 10^10 edges, all of whose samples are 0 but those of the last cells: there it holds what
/// an index of `corner`, whose outermost samples are 0 too, holds at its only level.
void writeSparseIndex(const std::filesystem::path& cornerIndex, const ScalarGrid& cornerVolume, const GridDims& dims,
                      const std::filesystem::path& path) {
    const auto opened = index::IndexReader::open(cornerIndex);
    ASSERT_THAT(opened, IsOk());
    const index::IndexReader& corner = *opened.value();
    const BrickGrid grid(dims);
    std::vector<std::byte> pageBytes;
    index::DecodedPage<std::uint16_t> decoded;
    std::vector<index::PointRecord<std::uint16_t>> records;
    for (const index::PageEntry& place : corner.meta().levels[0].pages) {
        ASSERT_THAT(corner.readPage(place, pageBytes), IsOk());
        ASSERT_THAT(index::decodePage<std::uint16_t>(pageBytes, corner.grid(), decoded, "page"), IsOk());
        for (auto record : test::recordsOf(decoded)) {
            auto at = corner.grid().pointCoords(record.id());
            for (int a = 0; a < 3; ++a)
                at[a] += dims[a] - corner.grid().dims()[a];
            record.setId(grid.pointId(at[0], at[1], at[2]));
            records.push_back(record);
        }
    }
    std::sort(records.begin(), records.end(),
              [](const auto& a, const auto& b) { return std::pair(a.key, a.id()) < std::pair(b.key, b.id()); });
    auto writer = index::IndexWriter::create(path, 1);
    ASSERT_THAT(writer, IsOk());
    // All groups but those around the corner, which are read, are one and the same.
    const index::ChunkGrid chunks(dims);
    index::IndexMeta meta = corner.meta();
    meta.info.geometry.dims = dims;
    const auto write = [&](std::uint64_t group) {
        return writeGroup(
            chunks, group, [&](index::ChunkIndex chunk) { return sparseChunk(chunks, chunk, dims, cornerVolume); },
            *writer.value());
    };
    meta.chunkGroups.assign(index::chunkGroupCount(chunks), write(0));
    std::set<std::uint64_t> around;
    for (unsigned k = 0; k < 8; ++k)
        around.insert(chunks
                          .chunkAt(chunks.chunks()[0] - 1 - (k & 1), chunks.chunks()[1] - 1 - (k >> 1 & 1),
                                   chunks.chunks()[2] - 1 - (k >> 2))
                          .number() /
                      index::kGroupChunks);
    for (const std::uint64_t group : around)
        meta.chunkGroups[group] = write(group);
    const auto bytes =
        index::encodePage<std::uint16_t>(records, index::PageOrder::Value, index::FarEnds::Directions, grid);
    index::PageEntry& entry = meta.levels[0].pages[0];
    entry.offset = writer.value()->sizeBytes();
    entry.bytes = static_cast<std::uint32_t>(bytes.size());
    entry.checksum = index::pageChecksum(bytes, 1, entry.offset);
    ASSERT_THAT(writer.value()->addPage(index::kLevel0, entry, bytes), IsOk());
    ASSERT_THAT(writer.value()->finish(meta), IsOk());
    const std::string forged = test::forgedIndex(test::readText(path), meta);
    std::ofstream(path, std::ios::binary) << forged;
}

// Ids of points and edges have 64 bits all the way from the page to the mesh.
TEST(SlideEngineOfALargeGrid, ReachesTheLastCellOfMoreEdgesThan32BitsCount) {
    const test::TemporaryFolder folder;
    const GridDims dims{3001, 3003, 2001};
    ASSERT_GT(3 * pointCount(dims), std::int64_t{1} << 34);
    ASSERT_GT(pointCount(dims), std::int64_t{1} << 34);
    GridGeometry geometry;
    geometry.dims = {5, 6, 4};
    const auto corner =
        test::makeVolume<std::uint16_t>(ScalarType::U16, geometry, [](std::int64_t x, std::int64_t y, std::int64_t z) {
            return x == 0 || y == 0 || z == 0 ? 0 : 100 * x + 10 * y * z;
        });
    preprocess::BuildOptions options;
    options.skipLevels = 1;
    ASSERT_THAT(test::buildIndexOf(corner, folder / "corner.isx", options), IsOk());
    ASSERT_NO_FATAL_FAILURE(writeSparseIndex(folder / "corner.isx", *corner, dims, folder / "sparse.isx"));
    const auto engine = SlideEngine::open(folder / "sparse.isx");
    ASSERT_THAT(engine, IsOk());
    for (const double isovalue : {150.0, 333.0, 41.5, 500.0, 1.0}) {
        ASSERT_THAT(engine.value()->slideTo(isovalue), IsOk());
        const SurfaceMesh mesh = engine.value()->mesh().value(), expected = extractFull(*corner, isovalue).value();
        EXPECT_GT(mesh.triangleCount(), 3u);
        EXPECT_EQ(mesh.triangles, expected.triangles) << isovalue;
        std::vector<EdgeId> ids;
        for (const EdgeId id : expected.edgeIds) {
            const auto point = static_cast<std::int64_t>(id / 4);
            const std::int64_t x = point % 5 + dims[0] - 5, y = point / 5 % 6 + dims[1] - 6,
                               z = point / 30 + dims[2] - 4;
            ids.push_back(4 * static_cast<EdgeId>(x + dims[0] * (y + dims[1] * z)) + id % 4);
        }
        EXPECT_GT(ids.back(), EdgeId{1} << 34);
        EXPECT_EQ(mesh.edgeIds, ids);
        ASSERT_EQ(mesh.positions.size(), expected.positions.size());
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) // floats of some thousands
            EXPECT_LT(glm::distance(mesh.positions[i], expected.positions[i] + glm::vec3(2996, 2997, 1997)), 2e-3F);
    }
}

} // namespace
} // namespace isoslider::extract
