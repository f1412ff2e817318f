#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/scalar_key.h"

namespace isoslider::topology {

/// Orders items by their isovalues; keeps the memory that this takes for the next time. A radix sort of the upper 32
/// bits of their keys, from the lowest key on, and where these are equal of the few that are then together: O(n) but
/// for very uneven isovalues, 16 bytes an item.
class IsovalueOrder {
public:
    /// Places of items, isovalues ascending, or descending; of equal ones the first comes first. Until the next call.
    /// REQUIRES: less than 2^32 items; isovalues are no NaN.
    template <class Item>
    std::span<std::uint32_t> of(const std::vector<Item>& items, bool descends = false) {
        places_.resize(items.size());
        if (items.size() < kFew) {
            std::iota(places_.begin(), places_.end(), 0u);
            std::stable_sort(places_.begin(), places_.end(), [&](std::uint32_t a, std::uint32_t b) {
                return descends ? items[b].isovalue < items[a].isovalue : items[a].isovalue < items[b].isovalue;
            });
            return places_;
        }
        const auto keyAt = [&](std::size_t i) -> std::uint64_t {
            const std::uint64_t key = keyOf(static_cast<double>(items[i].isovalue));
            return descends ? ~key : key;
        };
        std::uint64_t least = keyAt(0), greatest = least;
        for (std::size_t i = 1; i < items.size(); ++i) {
            const std::uint64_t key = keyAt(i);
            least = std::min(least, key);
            greatest = std::max(greatest, key);
        }
        const int shift = std::max(0, static_cast<int>(std::bit_width(greatest - least)) - kCodeBits);
        entries_.resize(items.size());
        counts_.assign(kDigits, {});
        for (std::size_t i = 0; i < items.size(); ++i) {
            const auto code = static_cast<std::uint32_t>((keyAt(i) - least) >> shift);
            entries_[i] = {code, static_cast<std::uint32_t>(i)};
            for (unsigned digit = 0; digit < kDigits; ++digit)
                ++counts_[digit][code >> (kBits * digit) & (kValues - 1)];
        }
        sortEntries();
        std::transform(entries_.begin(), entries_.end(), places_.begin(),
                       [](const Entry& entry) { return entry.place; });
        if (shift > 0)
            sortWithinCodes(keyAt);
        return places_;
    }

    /// Brings items into that order.
    template <class Item>
    void sort(std::vector<Item>& items) {
        const std::span<const std::uint32_t> places = of(items);
        std::vector<Item> sorted(items.size());
        for (std::size_t i = 0; i < items.size(); ++i)
            sorted[i] = items[places[i]];
        items = std::move(sorted);
    }

private:
    struct Entry {
        std::uint32_t code, place;
    };
    static constexpr std::size_t kFew = 256; // for which passes over all digits would not pay
    static constexpr int kCodeBits = 32;
    static constexpr unsigned kBits = 11, kDigits = 3;
    static constexpr std::size_t kValues = std::size_t{1} << kBits;

    // Of items with one code, which are in the order that they had.
    template <class KeyAt>
    void sortWithinCodes(const KeyAt& keyAt) {
        for (std::size_t begin = 0; begin < entries_.size();) {
            std::size_t end = begin + 1;
            bool ascend = true;
            for (; end < entries_.size() && entries_[end].code == entries_[begin].code; ++end)
                ascend = ascend && keyAt(places_[end - 1]) <= keyAt(places_[end]);
            if (!ascend)
                std::stable_sort(places_.begin() + static_cast<std::ptrdiff_t>(begin),
                                 places_.begin() + static_cast<std::ptrdiff_t>(end),
                                 [&](std::uint32_t a, std::uint32_t b) { return keyAt(a) < keyAt(b); });
            begin = end;
        }
    }

    void sortEntries() {
        sorted_.resize(entries_.size());
        for (unsigned digit = 0; digit < kDigits; ++digit) {
            auto& starts = counts_[digit];
            if (starts[entries_[0].code >> (kBits * digit) & (kValues - 1)] == entries_.size())
                continue; // all the same
            std::exclusive_scan(starts.begin(), starts.end(), starts.begin(), 0u);
            for (const Entry& entry : entries_)
                sorted_[starts[entry.code >> (kBits * digit) & (kValues - 1)]++] = entry;
            entries_.swap(sorted_);
        }
    }

    std::vector<Entry> entries_, sorted_;
    std::vector<std::array<std::uint32_t, kValues>> counts_; ///< of each digit: how many have a value
    std::vector<std::uint32_t> places_;
};

} // namespace isoslider::topology
