#include "core/index/page_cache.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "core/index/index_places.h"

namespace isoslider::index {

// About as many as there are threads: each takes one and gives one back.
static constexpr std::size_t kMaxSpares = 8;

// Above the numbers of all levels.
static constexpr std::uint64_t kOthers = std::uint64_t{0xff} << 56;
static constexpr std::uint64_t kTotals = std::uint64_t{1} << 55; // above the numbers of a level's pages

template <class Key>
Status decodeStated(const IndexReader& reader, std::span<const std::byte> bytes, std::uint32_t points,
                    std::uint32_t edges, DecodedPage<Key>& page) {
    ISO_TRY(decodePage<Key>(bytes, reader.grid(), page, reader.pathString()));
    const auto corrupt = [&](const char* problem) {
        return makeError(ErrorCode::Corruption, std::string("index page ") + problem, reader.pathString());
    };
    if (!isPageOfVersion(reader.info(), page.hasNormals(), page.farEnds))
        return corrupt("is one of another format version");
    if (!page.forms.empty() && !(reader.info().mergeError > 0.0))
        return corrupt("is damaged: merged cells where there are none");
    if (page.pointCount() != points || page.entries != edges)
        return corrupt("disagrees with the directory");
    // A brick has one entry; whoever walks a list of bricks relies on it.
    if (reader.info().kind != IndexKind::Edges &&
        !std::all_of(page.masks.begin(), page.masks.end(), [](std::uint8_t mask) { return std::has_single_bit(mask); }))
        return corrupt("lists a brick without or with several entries");
    return {};
}

template <class Key>
std::shared_ptr<ChangePage<Key>> PageCache<Key>::find(std::uint64_t id) {
    const std::lock_guard lock(mutex_);
    const auto found = byId_.find(id);
    if (found == byId_.end())
        return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->page;
}

template <class Key>
Result<typename PageCache<Key>::Lookup> PageCache<Key>::get(SkipLevel level, std::size_t pageIndex, Form form) {
    const std::uint64_t id = static_cast<std::uint64_t>(level) << 56 | (form == Form::Totals ? kTotals : 0) | pageIndex;
    if (auto page = find(id))
        return Lookup{std::move(page), 0};
    const PageEntry& entry = reader_.meta().levels[level.index()].pages[pageIndex];
    thread_local std::vector<std::byte> bytes;
    thread_local DecodedPage<Key> decoded;
    Status status = reader_.readPage(entry, bytes);
    if (status.isOk())
        status = decodeStated(reader_, bytes, entry.points, entry.edges, decoded);
    // A walk that takes a page of level 0 whole relies on it.
    if (status.isOk() && level == kLevel0 && !std::all_of(decoded.keys.begin(), decoded.keys.end(), [&](Key key) {
            return key >= entry.firstKey && key <= entry.lastKey;
        }))
        status = makeError(ErrorCode::Corruption, "index page has records outside its range", reader_.pathString());
    if (!status.isOk())
        return inPage(reader_, level, pageIndex, std::move(status).error());
    std::shared_ptr<ChangePage<Key>> page = pageOf(decoded, form);
    insert(id, page);
    return Lookup{std::move(page), entry.bytes};
}

template <class Key>
Result<typename PageCache<Key>::Lookup> PageCache<Key>::getOther(
    std::uint64_t number, std::uint64_t bytes, const std::function<Status(std::vector<BrickTotal>&)>& load) {
    if (auto page = find(kOthers | number))
        return Lookup{std::move(page), 0};
    thread_local std::vector<BrickTotal> totals;
    ISO_TRY(load(totals));
    std::shared_ptr<ChangePage<Key>> page = takeSpare(true);
    page->assignTotals(totals);
    insert(kOthers | number, page);
    return Lookup{std::move(page), bytes};
}

template <class Key>
std::shared_ptr<ChangePage<Key>> PageCache<Key>::pageOf(const DecodedPage<Key>& decoded, Form form) {
    const bool hasTotals = form == Form::Totals && sumUp_;
    std::shared_ptr<ChangePage<Key>> page = takeSpare(hasTotals);
    if (!hasTotals) {
        page->assign(decoded);
        return page;
    }
    thread_local ChangePage<Key> records;
    thread_local std::vector<BrickTotal> totals;
    records.assign(decoded);
    totals.clear();
    sumUp_(records, totals);
    page->assignTotals(records, totals);
    return page;
}

// One of the same form: a page of totals that had the memory of records would count as one of these.
template <class Key>
std::shared_ptr<ChangePage<Key>> PageCache<Key>::takeSpare(bool hasTotals) {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(spares_.begin(), spares_.end(),
                                    [hasTotals](const auto& page) { return page->hasTotals == hasTotals; });
    if (found == spares_.end())
        return std::make_shared<ChangePage<Key>>();
    std::shared_ptr<ChangePage<Key>> page = std::move(*found);
    spares_.erase(found);
    return page;
}

template <class Key>
void PageCache<Key>::insert(std::uint64_t id, std::shared_ptr<ChangePage<Key>> page) {
    const std::uint64_t size = page->memoryBytes();
    const std::lock_guard lock(mutex_);
    if (size > maxBytes_ || byId_.contains(id))
        return;
    while (bytes_ + size > maxBytes_) {
        bytes_ -= entries_.back().page->memoryBytes();
        byId_.erase(entries_.back().id);
        if (entries_.back().page.use_count() == 1) {
            if (spares_.size() == kMaxSpares)
                spares_.erase(spares_.begin());
            spares_.push_back(std::move(entries_.back().page));
        }
        entries_.pop_back();
    }
    std::list<Entry> added; // what may fail comes first
    added.push_front({id, std::move(page)});
    byId_.emplace(id, added.begin());
    entries_.splice(entries_.begin(), added);
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

#define ISO_INSTANTIATE(Key) \
    template class PageCache<Key>; \
    template Status decodeStated(const IndexReader&, std::span<const std::byte>, std::uint32_t, std::uint32_t, \
                                 DecodedPage<Key>&);
ISO_INSTANTIATE(std::uint16_t)
ISO_INSTANTIATE(std::uint32_t)
ISO_INSTANTIATE(std::uint64_t)
#undef ISO_INSTANTIATE

} // namespace isoslider::index
