#include "core/index/lazy_levels.h"

#include <algorithm>
#include <exception>
#include <span>
#include <utility>

#include "core/base/machine.h"

namespace isoslider::index {
namespace {

constexpr std::uint64_t kLeastGain = 8; // the part of what its blocks have that a group must leave out

} // namespace

/// The totals of a group on their way into the store.
template <class Key>
class LazyLevels<Key>::Gathering {
public:
    Gathering(LevelStore& store, std::uint64_t most) : store_(store), most_(most) {}

    /// False: there is no room, or it is not worthwhile.
    bool add(std::span<const BrickTotal> totals) {
        for (; !totals.empty(); totals = totals.subspan(std::min(totals.size(), kBuildTotals))) {
            const auto part = totals.first(std::min(totals.size(), kBuildTotals));
            if (totals_.size() + part.size() > kBuildTotals && !makeRoom())
                return false;
            if (totals_.capacity() < totals_.size() + part.size() && totals_.size() > kBuildTotals / 4)
                totals_.reserve(kBuildTotals);
            totals_.insert(totals_.end(), part.begin(), part.end());
        }
        return true;
    }
    bool flush() {
        combineTotals(totals_);
        count_ += totals_.size();
        if (!isWorthwhile())
            return false;
        for (std::span<const BrickTotal> rest = totals_; !rest.empty();) {
            const auto part = rest.first(std::min(rest.size(), kMaxPageTotals));
            if (!store_.add(encodeTotals(part), static_cast<std::uint32_t>(part.size())))
                return false;
            rest = rest.subspan(part.size());
        }
        totals_.clear();
        return true;
    }
    bool isWorthwhile() const { return count_ <= most_; }

private:
    // Of a group with more bricks than that several pages have the same ones.
    bool makeRoom() {
        combineTotals(totals_);
        return totals_.size() <= kBuildTotals / 2 || flush();
    }

    LevelStore& store_;
    std::uint64_t most_, count_ = 0;
    std::vector<BrickTotal> totals_;
};

template <class Key>
LazyLevels<Key>::LazyLevels(const IndexReader& reader, std::uint64_t memoryBytes, SumUp sumUp)
    : reader_(reader), sumUp_(std::move(sumUp)), store_(reader, memoryBytes) {}

template <class Key>
LazyLevels<Key>::~LazyLevels() = default;

template <class Key>
std::vector<BlockGroup> LazyLevels<Key>::groupsOf(std::uint64_t begin, std::uint64_t end) {
    std::vector<BlockGroup> groups;
    while (begin < end) {
        int level = begin == 0 ? kMaxGroupLevel : std::min(kMaxGroupLevel, std::countr_zero(begin));
        while ((std::uint64_t{1} << level) > end - begin)
            --level;
        groups.push_back({level, begin >> level});
        begin += std::uint64_t{1} << level;
    }
    return groups;
}

template <class Key>
Status LazyLevels<Key>::load(const StoredPage& page, std::vector<BrickTotal>& totals) const {
    thread_local std::vector<std::byte> bytes;
    ISO_TRY(store_.read(page, bytes));
    ISO_TRY(decodeTotals(bytes, reader_.grid(), totals, reader_.pathString()));
    if (totals.size() != page.totals)
        return makeError(ErrorCode::Corruption, "page of a lazy level disagrees with its table", reader_.pathString());
    return {};
}

template <class Key>
void LazyLevels<Key>::request(std::vector<BlockGroup> groups) {
    std::sort(groups.begin(), groups.end()); // by level
    const std::lock_guard lock(mutex_);
    if (isStopped_ || !sumUp_ || groups.empty())
        return;
    wanted_ = std::move(groups);
    changed_.notify_all();
    if (thread_.joinable())
        return;
    try {
        thread_ = std::jthread([this](std::stop_token stop) { run(stop); });
    } catch (const std::exception&) { // no thread, no levels
        wanted_.clear();
        isStopped_ = true;
    }
}

template <class Key>
void LazyLevels<Key>::run(std::stop_token stop) {
    lowerThreadPriority();
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return !wanted_.empty(); })) {
        const BlockGroup group = wanted_.back();
        wanted_.pop_back();
        isBuilding_ = true;
        lock.unlock();
        try {
            build(group, stop);
        } catch (const std::exception&) { // out of memory: walks go over the blocks
            store_.abandon();
        }
        lock.lock();
        isBuilding_ = false;
        changed_.notify_all();
    }
}

template <class Key>
void LazyLevels<Key>::build(const BlockGroup& group, std::stop_token stop) {
    if (store_.find(group) || !store_.begin())
        return;
    const std::uint64_t below = entriesOf(group);
    Gathering gathering(store_, below - below / kLeastGain);
    const bool isWhole = gather(group, gathering, stop) && gathering.flush();
    if (isWhole) {
        store_.finish(group, true);
        return;
    }
    store_.abandon();
    if (!gathering.isWorthwhile() && store_.begin())
        store_.finish(group, false);
}

// From groups that are there already, as far as there are such: they have less than their blocks.
template <class Key>
bool LazyLevels<Key>::gather(const BlockGroup& group, Gathering& gathering, std::stop_token stop) {
    std::vector<BrickTotal> totals;
    for (std::uint64_t half = 2 * group.index; half < 2 * group.index + 2; ++half) {
        const BlockGroup child{group.level - 1, half};
        const auto stored = child.level > 0 ? store_.find(child) : nullptr;
        if (stored && stored->isWorthwhile) {
            for (const StoredPage& storedPage : stored->pages) {
                if (stop.stop_requested())
                    return false;
                if (!load(storedPage, totals).isOk()) {
                    store_.forget(child);
                    return false;
                }
                if (!gathering.add(totals))
                    return false;
            }
            continue;
        }
        if (child.level > 0) {
            if (!gather(child, gathering, stop))
                return false;
            continue;
        }
        const LevelDirectory& level = reader_.meta().levels.back();
        const BlockEntry& block = level.blocks[half];
        std::vector<std::byte> bytes;
        DecodedPage<Key> page;
        ChangePage<Key> records;
        for (std::uint64_t p = block.firstPage; p < block.firstPage + block.pageCount; ++p) {
            // What is damaged is found, and reported, by the walk.
            const PageEntry& entry = level.pages[p];
            if (stop.stop_requested() || !reader_.readPage(entry, bytes).isOk() ||
                !decodeStated(reader_, bytes, entry.points, entry.edges, page).isOk())
                return false;
            records.assign(page);
            totals.clear();
            sumUp_(records, totals);
            if (!gathering.add(totals))
                return false;
        }
    }
    return true;
}

template <class Key>
std::uint64_t LazyLevels<Key>::entriesOf(const BlockGroup& group) const {
    const LevelDirectory& level = reader_.meta().levels.back();
    std::uint64_t entries = 0;
    for (std::uint64_t b = group.firstBlock(); b < group.blockEnd(); ++b)
        for (std::uint64_t p = 0; p < level.blocks[b].pageCount; ++p)
            entries += level.pages[level.blocks[b].firstPage + p].edges;
    return entries;
}

template <class Key>
void LazyLevels<Key>::stopBuilding() {
    {
        const std::lock_guard lock(mutex_);
        isStopped_ = true;
        wanted_.clear();
        thread_.request_stop();
    }
    if (thread_.joinable())
        thread_.join();
}

template <class Key>
void LazyLevels<Key>::wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return wanted_.empty() && !isBuilding_; });
}

template <class Key>
void LazyLevels<Key>::clear() {
    store_.dropMemory();
}

template class LazyLevels<std::uint16_t>;
template class LazyLevels<std::uint32_t>;
template class LazyLevels<std::uint64_t>;

} // namespace isoslider::index
