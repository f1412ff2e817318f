#include "preprocess/levels/level_builder.h"

#include <algorithm>
#include <bit>
#include <limits>

#include <tbb/parallel_for.h>

#include "preprocess/levels/radix_sort.h"

namespace isoslider::preprocess {

using index::PageEntry;
using index::PageOrder;
using index::SkipLevelInfo;

namespace {

constexpr std::uint64_t kNoEnd = std::numeric_limits<std::uint64_t>::max();

// Work that the stream has completed and that still has to be encoded: one page, or the end of a block.
template <class Key>
struct PendingPage {
    std::uint64_t position = 0; // in the stream, when it was complete
    index::SkipLevel level;
    std::vector<index::PointRecord<Key>> records; // empty: a block ends here
    std::uint64_t blockFirstKey = 0;
    std::uint64_t blockLastKey = 0;
    std::vector<std::byte> bytes;
};

template <class Key>
PageEntry describePage(std::span<const index::PointRecord<Key>> records) {
    PageEntry entry;
    entry.firstKey = kNoEnd;
    for (const auto& record : records) {
        entry.firstKey = std::min<std::uint64_t>(entry.firstKey, record.key);
        entry.lastKey = std::max<std::uint64_t>(entry.lastKey, record.key);
        entry.edges += static_cast<std::uint32_t>(std::popcount(record.edgeMask));
    }
    entry.points = static_cast<std::uint32_t>(records.size());
    return entry;
}

} // namespace

template <class Key>
class LevelBuilder<Key>::Level {
public:
    Level(index::SkipLevel level, std::vector<std::uint64_t> begins) : level_(level), begins_(std::move(begins)) {}

    void add(std::span<const Record> records, std::uint64_t position) {
        if (level_ == index::kLevel0)
            addToValuePages(records, position);
        else
            addToBlocks(records, position);
    }

    void finish(std::uint64_t position) {
        if (level_ == index::kLevel0)
            cutPages(chunk_, kValuePagePoints, position);
        else if (hasBlock_)
            endBlock(position);
        chunk_.clear();
    }

    void state(StateArchive& archive) {
        archive(chunk_);
        archive(info_);
        archive(hasBlock_);
        for (std::uint64_t* value : {&blockBegin_, &blockEnd_, &blockFirstKey_, &lastKey_})
            archive(*value);
    }

    std::vector<PendingPage<Key>>& pending() { return pending_; }
    const SkipLevelInfo& info() const { return info_; }

private:
    void addToValuePages(std::span<const Record> records, std::uint64_t position) {
        for (const Record& record : records) {
            ++position;
            if (record.edgeMask == 0)
                continue; // there only to be counted
            info_.blocks += !hasBlock_ || record.key != lastKey_;
            hasBlock_ = true;
            lastKey_ = record.key;
            countActivated(record, record.edgeMask);
            chunk_.push_back(record);
            if (chunk_.size() == kValuePagePoints) {
                cutPages(chunk_, kValuePagePoints, position);
                chunk_.clear();
            }
        }
    }

    void addToBlocks(std::span<const Record> records, std::uint64_t position) {
        for (const Record& record : records) {
            ++position;
            if (!hasBlock_ || record.key >= blockEnd_) {
                if (hasBlock_)
                    endBlock(position);
                beginBlock(record.key);
            }
            lastKey_ = record.key;
            const std::uint8_t mask = index::maskWithoutRedundant(record, blockBegin_, blockEnd_);
            if (mask == 0)
                continue;
            countActivated(record, mask);
            chunk_.push_back(record);
            chunk_.back().edgeMask = mask;
            if (chunk_.size() == kChunkPoints)
                endChunk(position);
        }
    }

    void beginBlock(std::uint64_t key) {
        const auto next = std::upper_bound(begins_.begin(), begins_.end(), key);
        blockBegin_ = next == begins_.begin() ? 0 : *(next - 1);
        blockEnd_ = next == begins_.end() ? kNoEnd : *next;
        blockFirstKey_ = key;
        hasBlock_ = true;
        ++info_.blocks;
    }

    void endBlock(std::uint64_t position) {
        endChunk(position);
        PendingPage<Key> end;
        end.position = position;
        end.level = level_;
        end.blockFirstKey = blockFirstKey_;
        end.blockLastKey = lastKey_;
        pending_.push_back(std::move(end));
        hasBlock_ = false;
    }

    void endChunk(std::uint64_t position) {
        sortRecords(chunk_, [](const Record& record) { return record.id().number(); });
        cutPages(chunk_, kIdPagePoints, position);
        chunk_.clear();
    }

    void cutPages(const std::vector<Record>& records, std::size_t pagePoints, std::uint64_t position) {
        for (std::size_t first = 0; first < records.size(); first += pagePoints) {
            PendingPage<Key> page;
            page.position = position;
            page.level = level_;
            const auto begin = records.begin() + static_cast<std::ptrdiff_t>(first);
            page.records.assign(begin,
                                begin + static_cast<std::ptrdiff_t>(std::min(pagePoints, records.size() - first)));
            pending_.push_back(std::move(page));
        }
    }

    void countActivated(const Record& record, std::uint8_t mask) {
        if (record.form != index::record_form::kPoint) // as it becomes active or not, so do all its entries
            info_.activatedEdges += record.farKeys[index::record_form::kOtherEnd] > record.key
                                        ? static_cast<std::uint64_t>(std::popcount(mask))
                                        : 0;
        else
            for (int e = 0; e < index::kPointEdges; ++e)
                info_.activatedEdges += (mask >> e & 1) && record.farKeys[e] > record.key;
    }

    index::SkipLevel level_;
    std::vector<std::uint64_t> begins_;
    std::vector<Record> chunk_;
    std::vector<PendingPage<Key>> pending_;
    SkipLevelInfo info_;
    bool hasBlock_ = false;
    std::uint64_t blockBegin_ = 0;
    std::uint64_t blockEnd_ = 0;
    std::uint64_t blockFirstKey_ = 0;
    std::uint64_t lastKey_ = 0;
};

template <class Key>
LevelBuilder<Key>::LevelBuilder(index::IndexWriter& writer, const BrickGrid& grid, index::FarEnds farEnds,
                                std::vector<std::vector<std::uint64_t>> blockBegins)
    : writer_(writer), grid_(grid), farEnds_(farEnds) {
    levels_.push_back(std::make_unique<Level>(index::kLevel0, std::vector<std::uint64_t>{}));
    for (auto& begins : blockBegins)
        levels_.push_back(std::make_unique<Level>(index::SkipLevel(levels_.size()), std::move(begins)));
}

template <class Key>
LevelBuilder<Key>::~LevelBuilder() = default;

template <class Key>
Status LevelBuilder<Key>::add(std::span<const Record> records) {
    constexpr std::size_t kStep =
        (std::size_t{4} << 20) / sizeof(Record); // bounds what waits for encoding, at each level
    for (std::size_t first = 0; first < records.size(); first += kStep) {
        const auto part = records.subspan(first, std::min(kStep, records.size() - first));
        tbb::parallel_for(std::size_t{0}, levels_.size(), [&](std::size_t l) { levels_[l]->add(part, position_); });
        position_ += part.size();
        ISO_TRY(encodeAndWrite());
    }
    return {};
}

template <class Key>
Status LevelBuilder<Key>::finish() {
    for (const auto& level : levels_)
        level->finish(position_);
    return encodeAndWrite();
}

template <class Key>
Status LevelBuilder<Key>::encodeAndWrite() {
    std::vector<PendingPage<Key>> pages;
    for (const auto& level : levels_) {
        std::move(level->pending().begin(), level->pending().end(), std::back_inserter(pages));
        level->pending().clear();
    }
    // However the stream was cut into calls, pages come in this order.
    std::stable_sort(pages.begin(), pages.end(), [](const auto& a, const auto& b) {
        return a.position != b.position ? a.position < b.position : a.level < b.level;
    });
    tbb::parallel_for(std::size_t{0}, pages.size(), [&](std::size_t i) {
        if (!pages[i].records.empty())
            pages[i].bytes = index::encodePage<Key>(
                pages[i].records, pages[i].level == index::kLevel0 ? PageOrder::Value : PageOrder::Id, farEnds_, grid_);
    });
    for (const PendingPage<Key>& page : pages) {
        if (page.records.empty())
            writer_.endBlock(page.level, page.blockFirstKey, page.blockLastKey);
        else
            ISO_TRY(writer_.addPage(page.level, describePage<Key>(page.records), page.bytes));
    }
    return {};
}

template <class Key>
void LevelBuilder<Key>::state(StateArchive& archive) {
    archive(position_);
    for (const auto& level : levels_)
        level->state(archive);
}

template <class Key>
std::vector<SkipLevelInfo> LevelBuilder<Key>::levelInfos() const {
    std::vector<SkipLevelInfo> infos;
    for (const auto& level : levels_)
        infos.push_back(level->info());
    return infos;
}

template class LevelBuilder<std::uint16_t>;
template class LevelBuilder<std::uint32_t>;
template class LevelBuilder<std::uint64_t>;

} // namespace isoslider::preprocess
