#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/index/change_page.h"
#include "core/index/index_reader.h"

namespace isoslider::index {

/// A page of `reader`'s volume from its bytes, checked against what is stated of it. Errors: Corruption.
template <class Key>
Status decodeStated(const IndexReader& reader, std::span<const std::byte> bytes, std::uint32_t points,
                    std::uint32_t edges, DecodedPage<Key>& page);

/// What walks need of pages, decoded, least recently used out first, within a bound on their memory (a single page
/// larger than the bound is handed out but not kept). Beyond it a few evicted pages wait for their memory to be used
/// again. Any number of threads; two that miss the same page at once both decode it.
template <class Key>
class PageCache {
public:
    /// Adds up a page's records by brick.
    using SumUp = std::function<void(const ChangePage<Key>& records, std::vector<BrickTotal>&)>;
    enum class Form : std::uint8_t { Records, Totals };

    /// `sumUp`: none, or called on any thread; without it there are no pages of totals.
    PageCache(const IndexReader& reader, std::uint64_t maxBytes, SumUp sumUp = {})
        : reader_(reader), maxBytes_(maxBytes), sumUp_(std::move(sumUp)) {}

    struct Lookup {
        std::shared_ptr<const ChangePage<Key>> page;
        std::uint64_t bytesRead = 0; ///< 0 on a hit
    };

    /// Totals are records where there is no sumUp. Errors: IoError, Corruption.
    Result<Lookup> get(SkipLevel level, std::size_t pageIndex, Form form = Form::Records);
    /// Totals that lie elsewhere (LevelStore), by a number that no other such page has. Errors: those of `load`.
    Result<Lookup> getOther(std::uint64_t number, std::uint64_t bytes,
                            const std::function<Status(std::vector<BrickTotal>&)>& load);

    std::uint64_t memoryBytes() const;
    void clear();

private:
    struct Entry {
        std::uint64_t id;
        std::shared_ptr<ChangePage<Key>> page;
    };

    std::shared_ptr<ChangePage<Key>> find(std::uint64_t id);
    std::shared_ptr<ChangePage<Key>> takeSpare(bool hasTotals);
    std::shared_ptr<ChangePage<Key>> pageOf(const DecodedPage<Key>& decoded, Form form);
    void insert(std::uint64_t id, std::shared_ptr<ChangePage<Key>> page);

    const IndexReader& reader_;
    std::uint64_t maxBytes_;
    SumUp sumUp_;
    mutable std::mutex mutex_;
    std::uint64_t bytes_ = 0;
    std::list<Entry> entries_; // most recently used first
    std::vector<std::shared_ptr<ChangePage<Key>>> spares_; // evicted and unused: memory to use again
    std::unordered_map<std::uint64_t, typename std::list<Entry>::iterator> byId_;
};

extern template class PageCache<std::uint16_t>;
extern template class PageCache<std::uint32_t>;
extern template class PageCache<std::uint64_t>;

} // namespace isoslider::index
