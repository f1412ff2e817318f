#include "core/index/page_cache.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "core/index/index_places.h"

namespace isoslider::index {

// About as many as there are threads: each takes one and gives one back.
static constexpr std::size_t kMaxSpares = 8;

namespace {

template <class Key>
Status readAndDecode(const IndexReader& reader, const PageEntry& entry, DecodedPage<Key>& page) {
    thread_local std::vector<std::byte> bytes;
    ISO_TRY(reader.readPage(entry, bytes));
    ISO_TRY(decodePage<Key>(bytes, reader.grid(), page, reader.pathString()));
    const auto corrupt = [&](const char* problem) {
        return makeError(ErrorCode::Corruption, std::string("index page ") + problem, reader.pathString());
    };
    if (!page.forms.empty() && !(reader.info().mergeError > 0.0))
        return corrupt("is damaged: merged cells where there are none");
    if (page.pointCount() != entry.points || page.edgeCount() != entry.edges)
        return corrupt("disagrees with the directory");
    // A brick has one entry; whoever walks a list of bricks relies on it.
    if (reader.info().kind == IndexKind::Metacells &&
        !std::all_of(page.masks.begin(), page.masks.end(), [](std::uint8_t mask) { return std::has_single_bit(mask); }))
        return corrupt("lists a brick without or with several entries");
    return {};
}

} // namespace

template <class Key>
Result<typename PageCache<Key>::Lookup> PageCache<Key>::get(SkipLevel level, std::size_t pageIndex) {
    const std::uint64_t id = static_cast<std::uint64_t>(level) << 56 | pageIndex;
    {
        const std::lock_guard lock(mutex_);
        const auto found = byId_.find(id);
        if (found != byId_.end()) {
            entries_.splice(entries_.begin(), entries_, found->second);
            return Lookup{found->second->page, 0};
        }
    }
    const PageEntry& entry = reader_.meta().levels[level.index()].pages[pageIndex];
    std::shared_ptr<DecodedPage<Key>> page = takeSpare();
    if (Status status = readAndDecode(reader_, entry, *page); !status.isOk())
        return inPage(reader_, level, pageIndex, std::move(status).error());
    insert(id, page);
    return Lookup{std::move(page), entry.bytes};
}

template <class Key>
std::shared_ptr<DecodedPage<Key>> PageCache<Key>::takeSpare() {
    const std::lock_guard lock(mutex_);
    if (spares_.empty())
        return std::make_shared<DecodedPage<Key>>();
    std::shared_ptr<DecodedPage<Key>> page = std::move(spares_.back());
    spares_.pop_back();
    return page;
}

template <class Key>
void PageCache<Key>::insert(std::uint64_t id, std::shared_ptr<DecodedPage<Key>> page) {
    const std::uint64_t size = page->memoryBytes();
    const std::lock_guard lock(mutex_);
    if (size > maxBytes_ || byId_.contains(id))
        return;
    while (bytes_ + size > maxBytes_) {
        bytes_ -= entries_.back().page->memoryBytes();
        byId_.erase(entries_.back().id);
        if (entries_.back().page.use_count() == 1 && spares_.size() < kMaxSpares)
            spares_.push_back(std::move(entries_.back().page));
        entries_.pop_back();
    }
    entries_.push_front({id, std::move(page)});
    byId_[id] = entries_.begin();
    bytes_ += size;
}

template <class Key>
std::uint64_t PageCache<Key>::memoryBytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

template <class Key>
void PageCache<Key>::clear() {
    const std::lock_guard lock(mutex_);
    entries_.clear();
    spares_.clear();
    byId_.clear();
    bytes_ = 0;
}

template class PageCache<std::uint16_t>;
template class PageCache<std::uint32_t>;
template class PageCache<std::uint64_t>;

} // namespace isoslider::index
