#include "core/index/lazy_levels.h"

#include <algorithm>
#include <bit>
#include <exception>
#include <system_error>
#include <utility>

#include "core/base/machine.h"
#include "core/index/page_cache.h"

namespace isoslider::index {
namespace {

constexpr std::size_t kPagePoints = 8192; // as in the levels of the file
constexpr std::uint64_t kLeastGain = 8; // the part of its entries that a group must leave out

template <class Key>
PointRecord<Key> recordOf(const DecodedPage<Key>& page, std::size_t point, std::size_t entry) {
    PointRecord<Key> record;
    record.key = page.keys[point];
    record.setId(PointId(page.ids[point]));
    record.edgeMask = page.masks[point];
    record.form = page.form(point);
    for (unsigned rest = record.edgeMask; rest != 0; rest &= rest - 1, ++entry)
        record.farKeys[std::countr_zero(rest)] = page.farKeys[entry];
    return record;
}

} // namespace

/// The records of a group on their way into the store.
template <class Key>
class LazyLevels<Key>::Gathering {
public:
    Gathering(LevelStore& store, const BrickGrid& grid, std::uint64_t beginKey, std::uint64_t endKey,
              std::uint64_t mostEntries)
        : store_(store), grid_(grid), beginKey_(beginKey), endKey_(endKey), mostEntries_(mostEntries) {
        records_.reserve(kBuildPoints);
    }

    /// False: there is no room, or it is not worthwhile.
    bool add(const DecodedPage<Key>& page) {
        std::size_t entry = 0;
        for (std::size_t i = 0; i < page.pointCount(); ++i) {
            PointRecord<Key> record = recordOf(page, i, entry);
            entry += static_cast<std::size_t>(std::popcount(page.masks[i]));
            record.edgeMask = maskWithoutRedundant(record, beginKey_, endKey_);
            if (record.edgeMask == 0)
                continue;
            entries_ += static_cast<std::uint64_t>(std::popcount(record.edgeMask));
            records_.push_back(record);
            if (records_.size() == kBuildPoints && !flush())
                return false;
        }
        return isWorthwhile();
    }
    bool flush() {
        std::stable_sort(records_.begin(), records_.end(),
                         [](const auto& a, const auto& b) { return a.id() < b.id(); });
        for (std::size_t first = 0; first < records_.size(); first += kPagePoints) {
            const auto part = std::span<const PointRecord<Key>>(records_).subspan(
                first, std::min(kPagePoints, records_.size() - first));
            std::uint32_t edges = 0;
            for (const auto& record : part)
                edges += static_cast<std::uint32_t>(std::popcount(record.edgeMask));
            if (!store_.add(encodePage<Key>(part, PageOrder::Id, grid_), static_cast<std::uint32_t>(part.size()),
                            edges))
                return false;
        }
        records_.clear();
        return true;
    }
    bool isWorthwhile() const { return entries_ <= mostEntries_; }

private:
    LevelStore& store_;
    const BrickGrid& grid_;
    std::uint64_t beginKey_, endKey_, mostEntries_;
    std::uint64_t entries_ = 0;
    std::vector<PointRecord<Key>> records_;
};

template <class Key>
LazyLevels<Key>::LazyLevels(const IndexReader& reader, std::uint64_t memoryBytes)
    : reader_(reader), store_(reader, memoryBytes) {}

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
Status LazyLevels<Key>::load(const StoredPage& page, DecodedPage<Key>& decoded) const {
    thread_local std::vector<std::byte> bytes;
    ISO_TRY(store_.read(page, bytes));
    return decodeStated(reader_, bytes, page.points, page.edges, decoded);
}

template <class Key>
void LazyLevels<Key>::request(std::vector<BlockGroup> groups) {
    std::sort(groups.begin(), groups.end()); // by level
    const std::lock_guard lock(mutex_);
    if (isStopped_ || groups.empty())
        return;
    wanted_ = std::move(groups);
    changed_.notify_all();
    if (thread_.joinable())
        return;
    try {
        thread_ = std::jthread([this](std::stop_token stop) { run(stop); });
    } catch (const std::system_error&) { // no thread, no levels
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
    const auto& blocks = reader_.meta().levels.back().blocks;
    const std::uint64_t below = entriesOf(group);
    Gathering gathering(store_, reader_.grid(), blocks[group.firstBlock()].firstKey,
                        blocks[group.blockEnd() - 1].lastKey + 1, below - below / kLeastGain);
    const bool isWhole = gather(group, gathering, stop) && gathering.flush();
    if (isWhole) {
        store_.finish(group, true);
        return;
    }
    store_.abandon();
    if (!gathering.isWorthwhile() && store_.begin())
        store_.finish(group, false);
}

// From groups that are there already, as far as there are such: they have fewer entries than their blocks.
template <class Key>
bool LazyLevels<Key>::gather(const BlockGroup& group, Gathering& gathering, std::stop_token stop) {
    DecodedPage<Key> page;
    for (std::uint64_t half = 2 * group.index; half < 2 * group.index + 2; ++half) {
        const BlockGroup child{group.level - 1, half};
        const auto stored = child.level > 0 ? store_.find(child) : nullptr;
        if (stored && stored->isWorthwhile) {
            for (const StoredPage& storedPage : stored->pages) {
                if (stop.stop_requested())
                    return false;
                if (!load(storedPage, page).isOk()) {
                    store_.forget(child);
                    return false;
                }
                if (!gathering.add(page))
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
        for (std::uint64_t p = block.firstPage; p < block.firstPage + block.pageCount; ++p) {
            // What is damaged is found, and reported, by the walk.
            const PageEntry& entry = level.pages[p];
            if (stop.stop_requested() || !reader_.readPage(entry, bytes).isOk() ||
                !decodeStated(reader_, bytes, entry.points, entry.edges, page).isOk() || !gathering.add(page))
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
