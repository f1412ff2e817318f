// What is kept of a page for walks, against the page.

#include <bit>
#include <random>

#include <gtest/gtest.h>

#include "core/index/change_page.h"

namespace isoslider::index {
namespace {

TEST(ChangePage, HasTheEdgesOfAPageByWhereTheyGo) {
    std::mt19937_64 random(3);
    ChangePage<std::uint32_t> page; // used again and again
    for (const std::size_t points : {1, 300, 7}) {
        DecodedPage<std::uint32_t> decoded;
        std::size_t edges = 0;
        for (std::size_t i = 0; i < points; ++i) {
            decoded.keys.push_back(static_cast<std::uint32_t>(random() % 100));
            decoded.ids.push_back(random() % (std::uint64_t{1} << 41));
            decoded.masks.push_back(static_cast<std::uint8_t>(1 + random() % 63));
            decoded.rising.push_back(static_cast<std::uint8_t>(decoded.masks.back() & random()));
            edges += static_cast<std::size_t>(std::popcount(unsigned{decoded.masks.back()}));
        }
        decoded.farEnds = FarEnds::Directions;
        decoded.entries = edges;
        page.assign(decoded);
        ASSERT_EQ(page.recordCount(), points);
        EXPECT_EQ(page.entries, edges);
        EXPECT_EQ(page.entriesOf(0, points), edges);
        EXPECT_EQ(page.entriesOf(points / 3, points), edges - page.entriesOf(0, points / 3));
        EXPECT_EQ(page.keys, decoded.keys);
        EXPECT_EQ(page.rising, decoded.rising);
        for (std::size_t i = 0; i < points; ++i) {
            ASSERT_EQ(page.id(i).number(), decoded.ids[i]);
            ASSERT_EQ(page.rising[i] ^ page.falling[i], decoded.masks[i]);
            ASSERT_EQ(page.entriesOf(i), static_cast<std::size_t>(std::popcount(unsigned{decoded.masks[i]})));
        }
    }
}

TEST(ChangePage, HasEdgesOnLeafEdgesAndNoLeaves) {
    namespace form = record_form;
    DecodedPage<std::uint16_t> decoded;
    const auto add = [&](std::uint64_t id, std::uint8_t which, std::uint16_t key, std::uint16_t other) {
        decoded.ids.push_back(id);
        decoded.keys.push_back(key);
        decoded.forms.push_back(which);
        decoded.masks.push_back(form::maskOf(which));
        decoded.rising.push_back(other > key ? form::maskOf(which) : std::uint8_t{0});
    };
    add(5, form::edge(1, 2), 10, 20);
    add(6, form::leaf(1), 11, 20);
    add(7, form::edge(2, 0), 20, 10);
    ChangePage<std::uint16_t> page;
    page.assign(decoded);
    ASSERT_EQ(page.recordCount(), 2u);
    EXPECT_EQ(page.entries, 2u);
    EXPECT_EQ(page.id(0).number(), 5u);
    EXPECT_EQ(page.rising[0], 1u << 3);
    EXPECT_EQ(page.falling[0], 0u);
    EXPECT_EQ(page.id(1).number(), 7u);
    EXPECT_EQ(page.keys[1], 20u);
    EXPECT_EQ(page.rising[1], 0u);
    EXPECT_EQ(page.falling[1], 1u << 5);
}

TEST(ChangePage, HasTotalsInPlaceOfRecords) {
    DecodedPage<std::uint16_t> decoded;
    decoded.keys = {3, 3, 5};
    decoded.ids = {1, 2, 600};
    decoded.masks = {1, 3, 4};
    decoded.rising = {1, 1, 0};
    decoded.entries = 4;
    ChangePage<std::uint16_t> records, page;
    records.assign(decoded);
    const std::vector<BrickTotal> totals{{BrickIndex(0), 1}, {BrickIndex(1), -1}};
    page.assignTotals(records, totals);
    EXPECT_TRUE(page.hasTotals);
    EXPECT_EQ(page.entries, 4u);
    EXPECT_EQ(page.distinctKeys, 2u);
    EXPECT_EQ(page.totals, totals);
    EXPECT_EQ(page.recordCount(), 0u);
    page.assignTotals(std::span(totals).first(1));
    EXPECT_EQ(page.entries, 1u) << "what a walk looks at";
    EXPECT_EQ(page.distinctKeys, 0u);
    page.assign(decoded);
    EXPECT_FALSE(page.hasTotals);
    EXPECT_EQ(page.recordCount(), 3u);
}

} // namespace
} // namespace isoslider::index
