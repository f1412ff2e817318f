#include "core/index/hidden_corners.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/index/index_places.h"

namespace isoslider::index {

HiddenCorners::HiddenCorners(const IndexReader& reader) : reader_(reader), pages_(reader.meta().hiddenPages.size()) {}

HiddenCorners::~HiddenCorners() { clear(); }

void HiddenCorners::clear() {
    for (auto& page : pages_)
        delete page.exchange(nullptr, std::memory_order_relaxed);
}

Result<std::optional<double>> HiddenCorners::find(BrickIndex brick, LocalPoint cell, int corner) const {
    const std::vector<HiddenPageEntry>& entries = reader_.meta().hiddenPages;
    const auto after =
        std::upper_bound(entries.begin(), entries.end(), brick,
                         [](BrickIndex b, const HiddenPageEntry& entry) { return b < entry.firstBrick; });
    if (after == entries.begin() || brick > (after - 1)->lastBrick)
        return std::optional<double>();
    const auto found = load(static_cast<std::size_t>(after - entries.begin()) - 1);
    if (!found.isOk())
        return found.error();
    const HiddenPage& page = *found.value();
    const std::uint32_t place = (brick - (after - 1)->firstBrick) * kHiddenPlacesPerBrick + 8u * cell.number() +
                                static_cast<std::uint32_t>(corner);
    const auto at = std::lower_bound(page.places.begin(), page.places.end(), place);
    if (at == page.places.end() || *at != place)
        return std::optional<double>();
    return std::optional<double>(page.scalars[static_cast<std::size_t>(at - page.places.begin())]);
}

Result<const HiddenPage*> HiddenCorners::load(std::size_t index) const {
    std::atomic<const HiddenPage*>& slot = pages_[index];
    if (const HiddenPage* known = slot.load(std::memory_order_acquire))
        return known;
    // Whoever wants the same page waits for it: read twice it would be counted twice.
    const std::lock_guard lock(loading_[index % loading_.size()]);
    if (const HiddenPage* known = slot.load(std::memory_order_acquire))
        return known;
    const HiddenPageEntry& entry = reader_.meta().hiddenPages[index];
    thread_local std::vector<std::byte> bytes;
    if (Status read = reader_.readPage(entry, bytes); !read.isOk())
        return inHiddenPage(reader_, index, std::move(read).error());
    bytesRead_.fetch_add(entry.bytes, std::memory_order_relaxed);
    auto fresh = std::make_unique<HiddenPage>();
    if (Status decoded = decodeHiddenPage(bytes, entry, reader_.info(), *fresh, reader_.pathString()); !decoded.isOk())
        return inHiddenPage(reader_, index, std::move(decoded).error());
    slot.store(fresh.get(), std::memory_order_release);
    return fresh.release();
}

std::uint64_t HiddenCorners::memoryBytes() const {
    std::uint64_t sum = pages_.size() * sizeof pages_[0];
    for (const auto& slot : pages_)
        if (const HiddenPage* page = slot.load(std::memory_order_acquire))
            sum += sizeof *page + page->places.capacity() * sizeof page->places[0] +
                   page->scalars.capacity() * sizeof page->scalars[0];
    return sum;
}

} // namespace isoslider::index
