#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/grid/scalar_key.h"

namespace isoslider::topology {

/// Places of items in the order of their isovalues, ascending; of equal ones the first comes first. A radix sort: O(n).
/// REQUIRES: less than 2^32 items; isovalues are no NaN.
template <class Item>
std::vector<std::uint32_t> orderByIsovalue(const std::vector<Item>& items) {
    struct Entry {
        std::uint64_t key;
        std::uint32_t place;
    };
    constexpr std::size_t kFew = 256; // for which passes over all digits would not pay
    if (items.size() < kFew) {
        std::vector<std::uint32_t> places(items.size());
        std::iota(places.begin(), places.end(), 0u);
        std::stable_sort(places.begin(), places.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return items[a].isovalue < items[b].isovalue; });
        return places;
    }
    constexpr unsigned kBits = 11, kDigits = 6;
    constexpr std::size_t kValues = std::size_t{1} << kBits;
    std::vector<Entry> entries(items.size()), sorted(items.size());
    std::vector<std::array<std::uint32_t, kValues>> counts(kDigits);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::uint64_t key = keyOf(items[i].isovalue);
        entries[i] = {key, static_cast<std::uint32_t>(i)};
        for (unsigned digit = 0; digit < kDigits; ++digit)
            ++counts[digit][key >> (kBits * digit) & (kValues - 1)];
    }
    for (unsigned digit = 0; digit < kDigits; ++digit) {
        auto& starts = counts[digit];
        if (starts[entries[0].key >> (kBits * digit) & (kValues - 1)] == items.size())
            continue; // all the same
        std::exclusive_scan(starts.begin(), starts.end(), starts.begin(), 0u);
        for (const Entry& entry : entries)
            sorted[starts[entry.key >> (kBits * digit) & (kValues - 1)]++] = entry;
        entries.swap(sorted);
    }
    std::vector<std::uint32_t> places(items.size());
    std::transform(entries.begin(), entries.end(), places.begin(), [](const Entry& entry) { return entry.place; });
    return places;
}

/// Brings items into that order, or from the greatest to the least.
template <class Item>
void sortByIsovalue(std::vector<Item>& items, bool isDescending = false) {
    if (isDescending)
        std::reverse(items.begin(), items.end()); // so that of equal ones the first comes first
    const std::vector<std::uint32_t> places = orderByIsovalue(items);
    std::vector<Item> sorted(items.size());
    for (std::size_t i = 0; i < items.size(); ++i)
        sorted[isDescending ? items.size() - 1 - i : i] = items[places[i]];
    items = std::move(sorted);
}

} // namespace isoslider::topology
