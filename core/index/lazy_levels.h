#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "core/index/format/block_codec.h"

namespace isoslider::index {

/// Skip levels above those of the file, built when walks need them and kept (PAPER 2.1: they "may be
/// computed in a lazy fashion"). DEVIATION: a block is merged when it is asked for a second time; merging
/// costs as much as the move itself, and most jumps happen once. Block g of lazy level l merges blocks 2 g and 2 g + 1
/// of level l - 1; lazy level 0 stands for the file's top level. A merged block holds what is left of both when edges
/// with both ends in their common interval are taken out.
///
/// Memory is bounded: once full, nothing more is kept, walks use the levels below. Any thread.
template <class Key>
class LazyLevels {
public:
    using Page = std::shared_ptr<const DecodedPage<Key>>;

    /// One block to be taken in a walk: group `index` of lazy level `level`.
    struct Group {
        int level = 0;
        std::uint64_t index = 0;
        std::uint64_t firstBlock() const { return index << level; }
        std::uint64_t blockEnd() const { return (index + 1) << level; }
    };

    /// Reads block b of the file's top level as pages; the key interval of blocks [begin, end).
    struct Below {
        std::function<Result<std::vector<Page>>(std::uint64_t block)> pages;
        std::function<std::pair<std::uint64_t, std::uint64_t>(std::uint64_t begin, std::uint64_t end)> interval;
    };

    /// Groups are no larger than 2^kMaxLevel blocks.
    static constexpr int kMaxLevel = 12;

    explicit LazyLevels(std::uint64_t maxBytes) : maxBytes_(maxBytes) {}

    /// Cuts blocks [begin, end) of the top level into the largest groups. O(log(end - begin)).
    static std::vector<Group> groupsOf(std::uint64_t begin, std::uint64_t end);

    /// The merged block, built from below if it is not there. Null at the first request, and when there
    /// is no room to keep it.
    /// Errors: those of `below`.
    Result<Page> get(const Group& group, const Below& below);

    std::uint64_t memoryBytes() const;
    void clear();

private:
    Result<Page> build(const Group& group, const Below& below);
    Page find(const Group& group) const;
    bool isFull() const;

    std::uint64_t maxBytes_;
    mutable std::mutex mutex_;
    std::uint64_t bytes_ = 0;
    std::map<std::pair<int, std::uint64_t>, Page> blocks_; ///< null: asked for once
};

extern template class LazyLevels<std::uint16_t>;
extern template class LazyLevels<std::uint32_t>;
extern template class LazyLevels<std::uint64_t>;

} // namespace isoslider::index
