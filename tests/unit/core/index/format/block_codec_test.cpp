#include "core/index/format/block_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/result_matchers.h"
#include "tests/support/sanitizers.h"

namespace isoslider::index {
namespace {

using test::HasError;
using test::IsOk;

constexpr GridDims kDims{21, 17, 10};

template <class Key>
class BlockCodec : public testing::Test {
protected:
    std::mt19937_64 random_{41};

    Key randomKey(std::uint64_t spread) {
        return static_cast<Key>(Key(std::numeric_limits<Key>::max() / 2) + random_() % spread);
    }

    // Points of the grid with random edges, in id order. `spread`: how far keys lie apart.
    std::vector<PointRecord<Key>> randomRecords(std::size_t count, std::uint64_t spread) {
        const BrickGrid grid(kDims);
        std::vector<PointRecord<Key>> records;
        for (PointId id; id < PointId(grid.idCount()) && records.size() < count; ++id) {
            if (!grid.contains(id) || random_() % 3 == 0)
                continue;
            const auto p = grid.pointCoords(id);
            PointRecord<Key> record;
            record.setId(id);
            record.key = randomKey(spread);
            for (int e = 0; e < kPointEdges; ++e) {
                const int axis = e >> 1;
                const bool exists = (e & 1) ? p[axis] + 1 < kDims[axis] : p[axis] > 0;
                if (!exists || random_() % 2)
                    continue;
                record.edgeMask |= static_cast<std::uint8_t>(1 << e);
                record.farKeys[e] = randomKey(spread);
            }
            if (record.edgeMask != 0)
                records.push_back(record);
        }
        return records;
    }

    static void sortByKey(std::vector<PointRecord<Key>>& records) {
        std::stable_sort(records.begin(), records.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    }

    static void expectSame(const std::vector<PointRecord<Key>>& records, PageOrder order,
                           const DecodedPage<Key>& page) {
        ASSERT_EQ(page.pointCount(), records.size());
        const bool hasKeys = order == PageOrder::Value || page.farEnds == FarEnds::Keys;
        const Key least = std::min_element(records.begin(), records.end(), [](const auto& a, const auto& b) {
                              return a.key < b.key;
                          })->key;
        std::size_t edge = 0;
        for (std::size_t i = 0; i < records.size(); ++i) {
            ASSERT_EQ(page.keys[i], hasKeys ? records[i].key : least) << i;
            ASSERT_EQ(page.ids[i], records[i].id().number()) << i;
            ASSERT_EQ(page.masks[i], records[i].edgeMask) << i;
            for (int e = 0; e < kPointEdges; ++e)
                if (records[i].edgeMask >> e & 1) {
                    if (page.farEnds == FarEnds::Keys) {
                        ASSERT_EQ(page.farKeys[edge], records[i].farKeys[e]) << i << " " << e;
                    }
                    ASSERT_EQ((page.rising[i] >> e & 1) != 0, records[i].farKeys[e] > records[i].key) << i << " " << e;
                    ++edge;
                }
            ASSERT_EQ(page.rising[i] & ~page.masks[i], 0) << i;
        }
        EXPECT_EQ(edge, page.entries);
        EXPECT_EQ(page.farKeys.size(), page.farEnds == FarEnds::Keys ? edge : 0u);
    }

    // The invariants that block_codec.h promises to those who use a page.
    static void expectInvariants(const DecodedPage<Key>& page, bool isByValue) {
        const BrickGrid grid(kDims);
        ASSERT_TRUE(page.ids.size() == page.keys.size() && page.masks.size() == page.keys.size() &&
                    page.rising.size() == page.keys.size());
        ASSERT_TRUE(page.normals.empty() || page.normals.size() == page.keys.size());
        std::size_t edges = 0, farKeys = 0;
        for (std::size_t i = 0; i < page.pointCount(); ++i) {
            farKeys += page.hasFarKeys(i) ? static_cast<std::size_t>(std::popcount(unsigned{page.masks[i]})) : 0;
            ASSERT_EQ(page.rising[i] & ~page.masks[i], 0);
            ASSERT_TRUE(grid.contains(PointId(page.ids[i])));
            const auto p = grid.pointCoords(PointId(page.ids[i]));
            for (int e = 0; e < kPointEdges; ++e)
                if (page.masks[i] >> e & 1) {
                    ASSERT_TRUE((e & 1) ? p[e >> 1] + 1 < kDims[e >> 1] : p[e >> 1] > 0);
                    ++edges;
                }
            ASSERT_EQ(page.masks[i] >> kPointEdges, 0);
            if (isByValue && i > 0) {
                ASSERT_GE(page.keys[i], page.keys[i - 1]);
            }
        }
        ASSERT_EQ(edges, page.entries);
        ASSERT_EQ(farKeys, page.farKeys.size());
        ASSERT_EQ(page.farNormals.size(), page.hasNormals() ? page.entries : 0u);
    }
};

using KeyTypes = testing::Types<std::uint16_t, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(BlockCodec, KeyTypes);

TYPED_TEST(BlockCodec, GivesBackWhatItTook) {
    const BrickGrid grid(kDims);
    DecodedPage<TypeParam> page; // memory that was used before
    for (const std::uint64_t spread : {std::uint64_t{1}, std::uint64_t{9}, std::uint64_t{3000}, ~std::uint64_t{0}})
        for (const std::size_t count : {1, 2, 17, 800})
            for (const FarEnds farEnds : {FarEnds::Keys, FarEnds::Directions}) {
                SCOPED_TRACE(std::to_string(spread) + " " + std::to_string(count));
                auto records = this->randomRecords(count, spread);
                const auto byId = encodePage<TypeParam>(records, PageOrder::Id, farEnds, grid);
                ASSERT_THAT(decodePage<TypeParam>(byId, grid, page, "p"), IsOk());
                EXPECT_EQ(page.farEnds, farEnds);
                this->expectSame(records, PageOrder::Id, page);
                this->sortByKey(records);
                const auto byValue = encodePage<TypeParam>(records, PageOrder::Value, farEnds, grid);
                ASSERT_THAT(decodePage<TypeParam>(byValue, grid, page, "p"), IsOk());
                this->expectSame(records, PageOrder::Value, page);
            }
}

// A field that goes on in straight lines costs nearly nothing: the mirrored prediction is used.
TYPED_TEST(BlockCodec, PredictsAStraightField) {
    const BrickGrid grid(kDims);
    std::vector<PointRecord<TypeParam>> straight;
    for (auto record : this->randomRecords(900, 1)) {
        const auto p = grid.pointCoords(record.id());
        record.edgeMask = 0;
        for (int a = 0; a < 3; ++a)
            for (const int up : {0, 1})
                if (up ? p[a] + 1 < kDims[a] : p[a] > 0) {
                    const int e = 2 * a + up;
                    record.edgeMask |= static_cast<std::uint8_t>(1 << e);
                    record.farKeys[e] = static_cast<TypeParam>(
                        record.key + (up ? 1 : -1) * (500 + static_cast<int>(p[0] * p[0]) + 7 * a));
                }
        straight.push_back(record);
    }
    const auto bytes = encodePage<TypeParam>(straight, PageOrder::Id, FarEnds::Keys, grid);
    EXPECT_EQ(static_cast<int>(bytes[19]) & 1, 1);
    DecodedPage<TypeParam> page;
    ASSERT_THAT(decodePage<TypeParam>(bytes, grid, page, "p"), IsOk());
    this->expectSame(straight, PageOrder::Id, page);
}

// Directions must be those of edges that the record has, and of points.
TYPED_TEST(BlockCodec, RefusesDirectionsOfWhatIsNotThere) {
    const BrickGrid grid(kDims);
    PointRecord<TypeParam> point;
    point.setId(grid.pointId(1, 1, 1));
    point.key = 5;
    point.edgeMask = 2;
    point.farKeys[1] = 9;
    auto bytes = encodePage<TypeParam>(std::span(&point, 1), PageOrder::Value, FarEnds::Directions, grid);
    ASSERT_EQ(bytes.back(), std::byte{2}) << "the last plane, one constant byte";
    DecodedPage<TypeParam> page;
    ASSERT_THAT(decodePage<TypeParam>(bytes, grid, page, "p"), IsOk());
    EXPECT_EQ(page.rising[0], 2);
    bytes.back() = std::byte{0};
    ASSERT_THAT(decodePage<TypeParam>(bytes, grid, page, "p"), IsOk());
    EXPECT_EQ(page.rising[0], 0);
    bytes.back() = std::byte{6};
    EXPECT_THAT(decodePage<TypeParam>(bytes, grid, page, "p"), HasError(ErrorCode::Corruption));
    PointRecord<TypeParam> leaf;
    leaf.form = record_form::leaf(1);
    leaf.edgeMask = record_form::maskOf(leaf.form);
    leaf.farKeys[record_form::kOtherEnd] = 9;
    leaf.setId(grid.pointId(2, 2, 2));
    const std::array both{point, leaf};
    auto mixed = encodePage<TypeParam>(both, PageOrder::Id, FarEnds::Directions, grid);
    ASSERT_THAT(decodePage<TypeParam>(mixed, grid, page, "p"), IsOk());
    EXPECT_EQ(page.farKeys, std::vector<TypeParam>{9});
    EXPECT_EQ(page.rising, (std::vector<std::uint8_t>{2, 2}));
    const std::array<std::byte, 2> directions{std::byte{2}, std::byte{0}}, ofTheLeaf{std::byte{2}, std::byte{2}};
    const auto at = std::search(mixed.begin() + 32, mixed.end(), directions.begin(), directions.end());
    ASSERT_NE(at, mixed.end());
    std::copy(ofTheLeaf.begin(), ofTheLeaf.end(), at);
    EXPECT_THAT(decodePage<TypeParam>(mixed, grid, page, "p"), HasError(ErrorCode::Corruption));
}

// A page by id states no keys of points.
TYPED_TEST(BlockCodec, RefusesKeysOfPointsWhereThereAreNone) {
    const BrickGrid grid(kDims);
    auto bytes = encodePage<TypeParam>(this->randomRecords(20, 40), PageOrder::Id, FarEnds::Directions, grid);
    DecodedPage<TypeParam> page;
    ASSERT_THAT(decodePage<TypeParam>(bytes, grid, page, "p"), IsOk());
    const std::size_t firstPlane = 32 + 4 * static_cast<std::size_t>(bytes[20]);
    ASSERT_EQ(bytes[firstPlane], std::byte{0});
    bytes[firstPlane] = std::byte{1};
    EXPECT_THAT(decodePage<TypeParam>(bytes, grid, page, "p"), HasError(ErrorCode::Corruption));
}

TYPED_TEST(BlockCodec, IsDeterministic) {
    const auto records = this->randomRecords(300, 50);
    EXPECT_EQ(encodePage<TypeParam>(records, PageOrder::Id, FarEnds::Keys, BrickGrid(kDims)),
              encodePage<TypeParam>(records, PageOrder::Id, FarEnds::Keys, BrickGrid(kDims)));
}

TYPED_TEST(BlockCodec, RefusesEveryTruncationAndTrailingBytes) {
    const BrickGrid grid(kDims);
    const auto bytes = encodePage<TypeParam>(this->randomRecords(70, 40), PageOrder::Id, FarEnds::Keys, grid);
    DecodedPage<TypeParam> page;
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        // A copy of that size, so that a read past its end is seen by the address sanitizer.
        const std::vector<std::byte> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
        ASSERT_THAT(decodePage<TypeParam>(cut, grid, page, "p"), HasError(ErrorCode::Corruption)) << length;
    }
    auto longer = bytes;
    longer.push_back(std::byte{0});
    EXPECT_THAT(decodePage<TypeParam>(longer, grid, page, "p"), HasError(ErrorCode::Corruption));
}

TYPED_TEST(BlockCodec, SurvivesEveryFlippedBit) {
    const BrickGrid grid(kDims);
    for (const auto& [order, farEnds] : {std::pair{PageOrder::Value, FarEnds::Keys},
                                         {PageOrder::Value, FarEnds::Directions},
                                         {PageOrder::Id, FarEnds::Keys},
                                         {PageOrder::Id, FarEnds::Directions}})
        for (const std::size_t count : {3, 200}) {
            auto records = this->randomRecords(count, 12);
            if (order == PageOrder::Value)
                this->sortByKey(records);
            auto bytes = encodePage<TypeParam>(records, order, farEnds, grid);
            std::size_t refused = 0;
            DecodedPage<TypeParam> page;
            for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += test::kSparser) {
                bytes[bit / 8] ^= std::byte(1 << (bit % 8));
                const auto status = decodePage<TypeParam>(bytes, grid, page, "damaged.isx");
                if (status.isOk()) {
                    this->expectInvariants(page, order == PageOrder::Value && bytes[18] == std::byte{0});
                } else {
                    ++refused;
                    ASSERT_EQ(status.error().code, ErrorCode::Corruption);
                    ASSERT_EQ(status.error().path, "damaged.isx");
                }
                bytes[bit / 8] ^= std::byte(1 << (bit % 8));
            }
            EXPECT_GT(refused, 8 * 24u / test::kSparser) << "the header alone has that many bits that must be right";
        }
}

TYPED_TEST(BlockCodec, SurvivesRandomBytes) {
    const BrickGrid grid(kDims);
    const auto records = this->randomRecords(500, 100);
    const std::array pages{encodePage<TypeParam>(records, PageOrder::Id, FarEnds::Keys, grid),
                           encodePage<TypeParam>(records, PageOrder::Id, FarEnds::Directions, grid)};
    DecodedPage<TypeParam> page;
    for (int round = 0; round < 6000; ++round) {
        auto damaged = pages[static_cast<std::size_t>(round / 3000)];
        for (int k = 0; k < 3; ++k)
            damaged[this->random_() % (round % 2 ? 120 : damaged.size())] = static_cast<std::byte>(this->random_());
        if (decodePage<TypeParam>(damaged, grid, page, "p").isOk())
            this->expectInvariants(page, damaged[18] == std::byte{0});
    }
}

TYPED_TEST(BlockCodec, RefusesAPageOfAnotherKeySizeOrGrid) {
    const auto records = this->randomRecords(5000, 40);
    const auto bytes = encodePage<TypeParam>(records, PageOrder::Id, FarEnds::Keys, BrickGrid(kDims));
    DecodedPage<std::uint16_t> page16;
    DecodedPage<std::uint32_t> page32;
    const bool is16 = sizeof(TypeParam) == 2;
    EXPECT_EQ(decodePage<std::uint16_t>(bytes, BrickGrid(kDims), page16, "p").isOk(), is16);
    EXPECT_EQ(decodePage<std::uint32_t>(bytes, BrickGrid(kDims), page32, "p").isOk(), sizeof(TypeParam) == 4);
    DecodedPage<TypeParam> page;
    // Same number of bricks, so the same ids; but the box is smaller.
    EXPECT_THAT(decodePage<TypeParam>(bytes, BrickGrid({17, 17, 10}), page, "p"), HasError(ErrorCode::Corruption));
}

} // namespace
} // namespace isoslider::index
