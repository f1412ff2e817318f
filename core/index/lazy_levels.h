#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/index/level_store.h"
#include "core/index/page_cache.h"

namespace isoslider::index {

/// Skip levels above those of the file, built when walks need them and kept (PAPER 2.1: they "may be computed in a lazy
/// fashion"). Lazy level l has a group for each 2^l blocks of the file's highest level: what their records add up to by
/// brick. Walks take a group whole, so they need no records of it, and edges with both ends in its interval add up to
/// nothing. A group that would not leave out an eighth of what its blocks have is noted as not worthwhile, and its
/// blocks are walked.
///
/// A separate thread builds them, one after the other, while walks go on over the blocks; LevelStore keeps them.
/// Memory: some kBuildTotals totals while a group is built, whatever its size. Any thread.
template <class Key>
class LazyLevels {
public:
    using SumUp = typename PageCache<Key>::SumUp;
    static constexpr std::size_t kBuildTotals = 1u << 20;

    /// `reader` must outlive this; `memoryBytes` as of LevelStore. `sumUp`: called by the thread that builds; none of
    /// who needs records: then there are no groups.
    LazyLevels(const IndexReader& reader, std::uint64_t memoryBytes, SumUp sumUp);
    ~LazyLevels();

    /// Cuts blocks [begin, end) of the highest level into the largest groups, single blocks as groups of level 0.
    /// O(log(end - begin)).
    static std::vector<BlockGroup> groupsOf(std::uint64_t begin, std::uint64_t end);

    std::shared_ptr<const StoredGroup> find(const BlockGroup& group) const {
        return sumUp_ ? store_.find(group) : nullptr;
    }
    /// Errors: IoError, Corruption: forget() the group then.
    Status load(const StoredPage& page, std::vector<BrickTotal>& totals) const;
    void forget(const BlockGroup& group) { store_.forget(group); }

    /// What a walk has missed is built next, the largest first, in place of what was asked for before and is not begun.
    /// Returns at once.
    void request(std::vector<BlockGroup> groups);
    /// Nothing more is built, what is there stays in use.
    void stopBuilding();
    /// Waits until nothing is left to build.
    void wait();
    /// Forgets what is in memory only, after wait().
    void clear();

    std::uint64_t memoryBytes() const { return store_.memoryBytes(); }

private:
    class Gathering;

    void run(std::stop_token stop);
    void build(const BlockGroup& group, std::stop_token stop);
    bool gather(const BlockGroup& group, Gathering& gathering, std::stop_token stop);
    std::uint64_t entriesOf(const BlockGroup& group) const;

    const IndexReader& reader_;
    SumUp sumUp_;
    LevelStore store_;
    std::mutex mutex_; ///< of what follows
    std::condition_variable_any changed_;
    std::vector<BlockGroup> wanted_; ///< the next one last
    bool isBuilding_ = false, isStopped_ = false;
    std::jthread thread_; ///< the last member: it uses the others
};

extern template class LazyLevels<std::uint16_t>;
extern template class LazyLevels<std::uint32_t>;
extern template class LazyLevels<std::uint64_t>;

} // namespace isoslider::index
