// What an index holds against its definition: each block is the net change of the set of active edges
// over its interval, computed here from the samples alone.

#include <algorithm>
#include <bit>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/extract/surface_mesh.h"
#include "core/grid/classification.h"
#include "core/grid/scalar_key.h"
#include "core/index/format/block_codec.h"
#include "core/index/index_reader.h"
#include "tests/property/random_volumes.h"
#include "tests/support/result_matchers.h"
#include "tests/support/temporary_folder.h"

namespace isoslider::index {
namespace {

using extract::EdgeId;
using test::IsOk;

struct GridEdge {
    EdgeId id;
    std::uint64_t key1, key2; ///< at the lower and the upper grid point
};

// Usable edges of a volume, the slow way.
template <class Sample>
std::vector<GridEdge> usableEdges(const ScalarGrid& grid) {
    const auto values = grid.values<Sample>();
    const GridDims& n = grid.dims();
    const auto at = [&](const std::array<std::int64_t, 3>& p) {
        return values[static_cast<std::size_t>(p[0] + n[0] * (p[1] + n[1] * p[2]))];
    };
    const auto isWhole = [&](std::array<std::int64_t, 3> cell) {
        for (int a = 0; a < 3; ++a)
            if (cell[a] < 0 || cell[a] + 1 >= n[a])
                return false;
        for (int c = 0; c < 8; ++c)
            if (isMissing(at({cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)})))
                return false;
        return true;
    };
    std::vector<GridEdge> edges;
    for (std::int64_t z = 0; z < n[2]; ++z)
        for (std::int64_t y = 0; y < n[1]; ++y)
            for (std::int64_t x = 0; x < n[0]; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    const std::array<std::int64_t, 3> p{x, y, z};
                    std::array<std::int64_t, 3> q = p;
                    if (++q[axis] >= n[axis] || isMissing(at(p)) || isMissing(at(q)) || at(p) == at(q))
                        continue;
                    bool isUsable = false;
                    for (int k = 0; k < 4; ++k) {
                        std::array<std::int64_t, 3> cell = p;
                        cell[(axis + 1) % 3] -= k & 1;
                        cell[(axis + 2) % 3] -= k >> 1;
                        isUsable = isUsable || isWhole(cell);
                    }
                    if (isUsable)
                        edges.push_back(
                            {static_cast<EdgeId>(4 * (x + n[0] * (y + n[1] * z)) + axis), keyOf(at(p)), keyOf(at(q))});
                }
    return edges;
}

// Which edges a rise from one threshold to another switches: +1 on, -1 off.
using SwitchCounts = std::map<EdgeId, int>;

SwitchCounts netChange(const std::vector<GridEdge>& edges, std::uint64_t from, std::uint64_t to) {
    SwitchCounts switches;
    for (const GridEdge& edge : edges) {
        const auto isActive = [&](std::uint64_t threshold) {
            return (edge.key1 >= threshold) != (edge.key2 >= threshold);
        };
        if (isActive(from) != isActive(to))
            switches[edge.id] = isActive(to) ? 1 : -1;
    }
    return switches;
}

// What the records of a page switch when their points are crossed upwards. Nothing may come twice.
template <class Key>
void countSwitches(const DecodedPage<Key>& page, const BrickGrid& grid, std::uint64_t firstKey, std::uint64_t lastKey,
                   SwitchCounts& switches) {
    for (std::size_t i = 0; i < page.pointCount(); ++i) {
        const auto p = grid.pointCoords(PointId(page.ids[i]));
        for (int e = 0; e < kPointEdges; ++e) {
            if (!(page.masks[i] >> e & 1))
                continue;
            if (page.keys[i] < firstKey || page.keys[i] > lastKey)
                continue;
            auto start = p;
            start[e >> 1] -= (e & 1) ? 0 : 1;
            const auto& n = grid.dims();
            const EdgeId id = static_cast<EdgeId>(4 * (start[0] + n[0] * (start[1] + n[1] * start[2])) + (e >> 1));
            const bool isNew = switches.emplace(id, (page.rising[i] >> e & 1) != 0 ? 1 : -1).second;
            EXPECT_TRUE(isNew) << "edge " << id << " twice in a block";
        }
    }
}

template <class Sample>
void expectDefinition(const ScalarGrid& grid, const IndexReader& reader) {
    using Key = KeyOf<Sample>;
    const auto edges = usableEdges<Sample>(grid);
    const IndexMeta& meta = reader.meta();
    std::vector<std::vector<DecodedPage<Key>>> pages(meta.levels.size());
    for (std::size_t l = 0; l < meta.levels.size(); ++l)
        for (const PageEntry& entry : meta.levels[l].pages) {
            std::vector<std::byte> bytes;
            ASSERT_THAT(reader.readPage(entry, bytes), IsOk());
            DecodedPage<Key> page;
            ASSERT_THAT(decodePage<Key>(bytes, reader.grid(), page, "a.isx"), IsOk());
            EXPECT_EQ(*std::min_element(page.keys.begin(), page.keys.end()), entry.firstKey);
            if (l == 0) {
                EXPECT_EQ(*std::max_element(page.keys.begin(), page.keys.end()), entry.lastKey);
            }
            EXPECT_EQ(page.pointCount(), entry.points);
            EXPECT_EQ(page.entries, entry.edges);
            pages[l].push_back(std::move(page));
        }

    std::set<std::uint64_t> keys; // of points that have an edge
    for (const GridEdge& edge : edges)
        keys.insert({edge.key1, edge.key2});
    EXPECT_EQ(meta.info.levels[0].blocks, keys.size());
    for (const std::uint64_t key : keys) {
        SwitchCounts switches;
        for (const auto& page : pages[0])
            countSwitches(page, reader.grid(), key, key, switches);
        ASSERT_EQ(switches, netChange(edges, key, key + 1)) << "block of key " << key;
    }
    std::set<std::uint64_t> firsts = keys, lasts = keys; // of the blocks of the level below
    for (std::size_t l = 1; l < meta.levels.size(); ++l) {
        std::set<std::uint64_t> covered, newFirsts, newLasts;
        EXPECT_EQ(meta.info.levels[l].blocks, meta.levels[l].blocks.size());
        for (const BlockEntry& block : meta.levels[l].blocks) {
            SwitchCounts switches;
            for (std::uint64_t p = 0; p < block.pageCount; ++p)
                countSwitches(pages[l][block.firstPage + p], reader.grid(), block.firstKey, block.lastKey, switches);
            ASSERT_EQ(switches, netChange(edges, block.firstKey, block.lastKey + 1))
                << "level " << l << ", block of keys " << block.firstKey << " to " << block.lastKey;
            EXPECT_TRUE(firsts.contains(block.firstKey) && lasts.contains(block.lastKey))
                << "cuts a block of the level below";
            covered.insert(keys.lower_bound(block.firstKey), keys.upper_bound(block.lastKey));
            newFirsts.insert(block.firstKey);
            newLasts.insert(block.lastKey);
        }
        EXPECT_EQ(covered, keys) << "level " << l << " leaves values out";
        firsts = newFirsts;
        lasts = newLasts;
    }
    for (std::size_t l = 0; l < meta.levels.size(); ++l) { // the counts that the index states
        const SkipLevelInfo& info = meta.info.levels[l];
        std::uint64_t points = 0, entries = 0, activated = 0, bytes = 0;
        for (const PageEntry& entry : meta.levels[l].pages)
            bytes += entry.bytes;
        for (const auto& page : pages[l]) {
            points += page.pointCount();
            entries += page.entries;
            for (const std::uint8_t rising : page.rising)
                activated += static_cast<std::uint64_t>(std::popcount(rising));
        }
        EXPECT_EQ(info.points, points);
        EXPECT_EQ(info.edges, entries);
        EXPECT_EQ(info.activatedEdges, activated);
        EXPECT_EQ(info.bytes, bytes);
        EXPECT_EQ(info.redundantRemoved, l == 0 ? 0 : meta.info.levels[l - 1].edges - entries);
        if (l == 0) {
            EXPECT_EQ(entries, 2 * edges.size()) << "each edge once with either end";
        }
    }
}

TEST(SkipLevels, EveryBlockIsTheNetChangeOverItsInterval) {
    int levelsSeen = 0;
    for (std::uint64_t seed = test::testSeed(500), last = seed + 60; seed < last && !HasFailure(); ++seed) {
        test::Random random(seed);
        const test::RandomVolume volume = test::randomVolume(random, 12);
        if (!volume.hasFinite)
            continue;
        preprocess::BuildOptions options;
        options.skipLevels = static_cast<int>(test::intRandom(random, 1, 8));
        options.redundancyThreshold = std::exp(5.0 * test::unitRandom(random) - 4.0);
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + volume.description);
        const test::TemporaryFolder folder;
        ASSERT_THAT(test::buildIndexOf(volume.grid, folder / "a.isx", options), IsOk());
        const auto reader = IndexReader::open(folder / "a.isx");
        ASSERT_THAT(reader, IsOk());
        EXPECT_LE(reader.value()->meta().levels.size(), static_cast<std::size_t>(options.skipLevels));
        levelsSeen = std::max(levelsSeen, static_cast<int>(reader.value()->meta().levels.size()));
        visitScalarType(volume.grid->type(),
                        [&](auto sample) { expectDefinition<decltype(sample)>(*volume.grid, *reader.value()); });
    }
    EXPECT_GE(levelsSeen, 4);
}

} // namespace
} // namespace isoslider::index
