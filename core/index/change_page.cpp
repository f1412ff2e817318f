#include "core/index/change_page.h"

#include <cstring>

namespace isoslider::index {

template <class Key>
void ChangePage<Key>::assign(const DecodedPage<Key>& page) {
    const std::size_t count = page.pointCount();
    keys.resize(count);
    idsLow.resize(count);
    idsHigh.resize(count);
    rising.resize(count);
    falling.resize(count);
    std::size_t record = 0;
    for (std::size_t i = 0; i < count; ++i) {
        unsigned mask = page.masks[i], up = page.rising[i];
        if (const std::uint8_t form = page.form(i); form != record_form::kPoint) {
            if (!record_form::isEdge(form))
                continue;
            mask = 2u << (2 * record_form::axisOf(form));
            up = up != 0 ? mask : 0;
        }
        rising[record] = static_cast<std::uint8_t>(up);
        falling[record] = static_cast<std::uint8_t>(mask & ~up);
        keys[record] = page.keys[i];
        idsLow[record] = static_cast<std::uint32_t>(page.ids[i]);
        idsHigh[record] = static_cast<std::uint16_t>(page.ids[i] >> 32);
        ++record;
    }
    keys.resize(record);
    idsLow.resize(record);
    idsHigh.resize(record);
    rising.resize(record);
    falling.resize(record);
    entries = entriesOf(0, record);
    totals.clear();
    hasTotals = false;
}

template <class Key>
std::size_t ChangePage<Key>::entriesOf(std::size_t begin, std::size_t end) const {
    std::size_t count = 0, i = begin;
    for (std::uint64_t up, down; i + sizeof up <= end; i += sizeof up) {
        std::memcpy(&up, rising.data() + i, sizeof up);
        std::memcpy(&down, falling.data() + i, sizeof down);
        count += static_cast<std::size_t>(std::popcount(up | down));
    }
    for (; i < end; ++i)
        count += entriesOf(i);
    return count;
}

template <class Key>
void ChangePage<Key>::assignTotals(const ChangePage& records, std::span<const BrickTotal> sums) {
    assignTotals(sums);
    entries = records.entries;
    distinctKeys = records.keys.empty() ? 0 : 1;
    for (std::size_t i = 1; i < records.keys.size(); ++i)
        distinctKeys += records.keys[i] != records.keys[i - 1];
}

template <class Key>
void ChangePage<Key>::assignTotals(std::span<const BrickTotal> sums) {
    entries = sums.size();
    distinctKeys = 0;
    hasTotals = true;
    totals.assign(sums.begin(), sums.end());
    keys.clear();
    idsLow.clear();
    idsHigh.clear();
    rising.clear();
    falling.clear();
}

template struct ChangePage<std::uint16_t>;
template struct ChangePage<std::uint32_t>;
template struct ChangePage<std::uint64_t>;

} // namespace isoslider::index
