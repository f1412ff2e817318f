#include "core/extract/sources/brick_activity.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace isoslider::extract {
namespace {

constexpr std::size_t kBatch = 512; // records, which stay in the nearest cache

int difference(unsigned rising, unsigned falling) { return std::popcount(rising) - std::popcount(falling); }

} // namespace

template <class Key>
BrickActivity<Key>::BrickActivity(const BrickGrid& grid, ListOf list) : counts_(grid.brickCount()) {
    if (list == ListOf::Edges)
        holders_.emplace(grid);
}

template <class Key>
BrickActivity<Key>::~BrickActivity() = default;

template <class Key>
void BrickActivity<Key>::clear() {
    counts_.release(0);
}

template <class Key>
void BrickActivity<Key>::beginWalk(bool goesUp) {
    endWalk();
    goesUp_ = goesUp;
}

template <class Key>
void BrickActivity<Key>::endWalk() {
    for (auto& deltas : walk_)
        if (deltas)
            pool_.giveBack(std::move(deltas));
    walk_.clear();
}

template <class Key>
void BrickActivity<Key>::add(const typename BlockWalk<Key>::Part& part) {
    std::unique_ptr<BrickDeltas>& deltas = walk_.local();
    if (!deltas)
        deltas = pool_.take();
    if (!part.page.hasTotals)
        return addRecords(part, *deltas);
    for (const auto& total : part.page.totals)
        deltas->add(total.brick, total.count);
}

template <class Key>
void BrickActivity<Key>::sumUp(const index::ChangePage<Key>& page, std::vector<index::BrickTotal>& totals) {
    std::unique_ptr<BrickDeltas> sums = pool_.take();
    addRecords({page, 0, page.recordCount()}, *sums);
    sums->forEach([&](BrickIndex brick, std::int32_t count) {
        if (count != 0)
            totals.push_back({brick, count});
    });
    pool_.giveBack(std::move(sums));
}

template <class Key>
void BrickActivity<Key>::addRecords(const typename BlockWalk<Key>::Part& part, BrickDeltas& deltas) const {
    if (holders_) {
        for (std::size_t begin = part.begin; begin < part.end; begin += kBatch)
            addEdges({part.page, begin, std::min(begin + kBatch, part.end)}, deltas);
        return;
    }
    for (std::size_t i = part.begin; i < part.end; ++i)
        deltas.add(brickOf(part.page.id(i)), difference(part.page.rising[i], part.page.falling[i]));
}

// Which points are held more than once can hardly be predicted: so those are listed first.
template <class Key>
void BrickActivity<Key>::addEdges(const typename BlockWalk<Key>::Part& batch, BrickDeltas& deltas) const {
    const index::ChangePage<Key>& page = batch.page;
    std::array<std::uint32_t, kBatch + 1> heldOften;
    std::size_t often = 0;
    for (std::size_t i = batch.begin; i < batch.end; ++i) {
        const PointId id = page.id(i);
        const bool isOnce = holders_->isHeldOnce(id);
        deltas.add(brickOf(id), isOnce ? difference(page.rising[i], page.falling[i]) : 0);
        heldOften[often] = static_cast<std::uint32_t>(i);
        often += !isOnce;
    }
    for (const std::uint32_t i : std::span(heldOften).first(often))
        holders_->forEach(page.id(i), [&](BrickIndex holder, unsigned inside) {
            deltas.add(holder, difference(page.rising[i] & inside, page.falling[i] & inside));
        });
}

template <class Key>
auto BrickActivity<Key>::changes() -> std::vector<Change> {
    BrickDeltas* all = nullptr; // the largest, to which the others are added
    for (const auto& deltas : walk_)
        if (deltas && (!all || deltas->size() > all->size()))
            all = deltas.get();
    std::vector<Change> changes;
    if (!all)
        return changes;
    for (const auto& deltas : walk_)
        if (deltas && deltas.get() != all)
            deltas->forEach([&](BrickIndex brick, std::int32_t count) { all->add(brick, count); });
    all->forEach([&](BrickIndex brick, std::int32_t count) {
        if (count != 0)
            changes.push_back({brick, goesUp_ ? count : -count});
    });
    endWalk();
    return changes;
}

template <class Key>
bool BrickActivity<Key>::apply(std::span<const Change> changes) {
    const int most = holders_ ? kMostEdges : 1;
    const bool isPossible = std::all_of(changes.begin(), changes.end(), [&](const Change& change) {
        const int after = static_cast<int>(count(change.brick)) + change.count;
        return after >= 0 && after <= most;
    });
    if (!isPossible)
        return false;
    for (const Change& change : changes)
        counts_[change.brick.index()] = static_cast<std::uint16_t>(counts_[change.brick.index()] + change.count);
    return true;
}

template class BrickActivity<std::uint16_t>;
template class BrickActivity<std::uint32_t>;
template class BrickActivity<std::uint64_t>;

} // namespace isoslider::extract
