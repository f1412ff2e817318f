#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isoslider::preprocess {

/// What a record is sorted by, and where it stands.
template <class Key>
struct KeyedPosition {
    Key key;
    std::uint32_t position;
};

/// Sorts by key, stable: a counting sort for each byte in which keys differ. O(entries * such bytes). `scratch` is any
/// memory to work in.
template <class Key>
void radixSort(std::vector<KeyedPosition<Key>>& entries, std::vector<KeyedPosition<Key>>& scratch) {
    constexpr std::size_t kFew = 128; // below, counting costs more than comparing
    if (entries.size() < kFew) {
        std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
        return;
    }
    std::array<std::array<std::uint32_t, 256>, sizeof(Key)> counts{};
    for (const auto& entry : entries)
        for (std::size_t byte = 0; byte < sizeof(Key); ++byte)
            ++counts[byte][entry.key >> (8 * byte) & 0xff];
    scratch.resize(entries.size());
    for (std::size_t byte = 0; byte < sizeof(Key); ++byte) {
        const auto digit = [byte](Key key) { return static_cast<std::size_t>(key >> (8 * byte) & 0xff); };
        if (counts[byte][digit(entries.front().key)] == entries.size())
            continue;
        std::array<std::uint32_t, 256> next;
        std::uint32_t sum = 0;
        for (std::size_t value = 0; value < next.size(); ++value) {
            next[value] = sum;
            sum += counts[byte][value];
        }
        for (const auto& entry : entries)
            scratch[next[digit(entry.key)]++] = entry;
        entries.swap(scratch);
    }
}

/// Sorts records by keyOf(record), an unsigned number; stable.
template <class Record, class KeyOf>
void sortRecords(std::vector<Record>& records, const KeyOf& keyOf) {
    using Entry = KeyedPosition<decltype(keyOf(records.front()))>;
    std::vector<Entry> entries(records.size()), scratch;
    for (std::size_t i = 0; i < records.size(); ++i)
        entries[i] = {keyOf(records[i]), static_cast<std::uint32_t>(i)};
    radixSort(entries, scratch);
    std::vector<Record> sorted(records.size());
    for (std::size_t i = 0; i < records.size(); ++i)
        sorted[i] = records[entries[i].position];
    records.swap(sorted);
}

} // namespace isoslider::preprocess
