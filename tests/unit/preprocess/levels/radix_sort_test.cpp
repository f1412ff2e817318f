#include "preprocess/levels/radix_sort.h"

#include <random>

#include <gtest/gtest.h>

namespace isoslider::preprocess {
namespace {

struct Record {
    std::uint64_t key;
    int place;
};

template <class Key>
void expectSorted(std::size_t count, Key mask, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Record> records;
    for (std::size_t i = 0; i < count; ++i)
        records.push_back({static_cast<Key>(random() & mask), static_cast<int>(i)});
    std::vector<Record> expected = records;
    std::stable_sort(expected.begin(), expected.end(), [](const Record& a, const Record& b) { return a.key < b.key; });
    sortRecords(records, [](const Record& record) { return static_cast<Key>(record.key); });
    ASSERT_EQ(records.size(), expected.size());
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(records[i].key, expected[i].key) << count << " records, mask " << mask;
        ASSERT_EQ(records[i].place, expected[i].place);
    }
}

TEST(RadixSort, IsStableForEveryWidth) {
    for (const std::size_t count : {0u, 1u, 2u, 127u, 128u, 1000u, 70000u}) {
        expectSorted<std::uint16_t>(count, 0xffff, count);
        expectSorted<std::uint16_t>(count, 0x7, count);
        expectSorted<std::uint32_t>(count, 0xff00ff00, count);
        expectSorted<std::uint64_t>(count, ~std::uint64_t{0}, count);
        expectSorted<std::uint64_t>(count, 0xff00000000ff0000, count);
        expectSorted<std::uint64_t>(count, 0, count);
    }
}

} // namespace
} // namespace isoslider::preprocess
