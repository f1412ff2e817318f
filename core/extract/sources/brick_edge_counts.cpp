#include "core/extract/sources/brick_edge_counts.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/extract/sources/edge_change_kernels.h"

namespace isoslider::extract {
namespace {

constexpr std::size_t kBatch = 512; // records, which stay in the nearest cache

} // namespace

template <class Key>
BrickEdgeCounts<Key>::BrickEdgeCounts(const BrickGrid& grid)
    : holders_(grid), bricks_(grid.brickCount()), counts_(bricks_), deltas_([this] { return Deltas(bricks_); }) {}

template <class Key>
BrickEdgeCounts<Key>::~BrickEdgeCounts() = default;

template <class Key>
void BrickEdgeCounts<Key>::clear() {
    counts_.release(0);
}

template <class Key>
void BrickEdgeCounts<Key>::beginWalk(KeyThreshold lower, KeyThreshold upper, bool goesUp) {
    lower_ = lower;
    upper_ = upper;
    goesUp_ = goesUp;
    for (Deltas& deltas : deltas_)
        deltas.touched.clear();
    if (++walk_ != 0)
        return;
    for (Deltas& deltas : deltas_) // numbers begin again
        deltas.byBrick.release(0);
    walk_ = 1;
}

template <class Key>
inline void BrickEdgeCounts<Key>::add(BrickIndex brick, int edges, Deltas& deltas) {
    Delta& delta = deltas.byBrick[brick.index()];
    if (delta.walk != walk_) {
        delta = {walk_, 0};
        deltas.touched.push_back(brick);
    }
    delta.edges += edges;
}

template <class Key>
std::size_t BrickEdgeCounts<Key>::add(const typename BlockWalk<Key>::Part& part) {
    Deltas& deltas = deltas_.local();
    std::size_t entry = part.firstEntry;
    for (std::size_t begin = part.begin; begin < part.end; begin += kBatch) {
        const std::size_t end = std::min(begin + kBatch, part.end);
        addBatch({part.page, begin, end, entry}, deltas);
        for (std::size_t i = begin; i < end; ++i)
            entry += static_cast<std::size_t>(std::popcount(part.page.masks[i]));
    }
    return entry;
}

template <class Key>
void BrickEdgeCounts<Key>::addBatch(const typename BlockWalk<Key>::Part& batch, Deltas& deltas) {
    namespace form = index::record_form;
    const index::DecodedPage<Key>& page = batch.page;
    const std::size_t count = batch.end - batch.begin;
    std::array<std::uint8_t, kBatch> above, below;
    findChangedEdges<Key>(std::span(page.masks).subspan(batch.begin, count),
                          std::span(page.farKeys).subspan(batch.firstEntry), lower_, upper_, above.data(),
                          below.data());
    if (!page.forms.empty()) {
        std::size_t entry = batch.firstEntry;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t record = batch.begin + i;
            if (const std::uint8_t which = page.forms[record]; which != form::kPoint) {
                const std::uint64_t other = page.farKeys[entry];
                const auto edge = static_cast<std::uint8_t>(form::isEdge(which) ? 2u << (2 * form::axisOf(which)) : 0u);
                above[i] = other >= upper_ ? edge : 0;
                below[i] = other < lower_ ? edge : 0;
            }
            entry += static_cast<std::size_t>(std::popcount(page.masks[record]));
        }
    }
    const auto &activated = goesUp_ ? above : below, &deactivated = goesUp_ ? below : above;
    // Which points are held more than once can hardly be predicted: so those are listed first.
    std::array<std::uint16_t, kBatch + 1> heldOften;
    std::size_t often = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const PointId id(page.ids[batch.begin + i]);
        const bool isOnce = holders_.isHeldOnce(id);
        const int edges = std::popcount(activated[i]) - std::popcount(deactivated[i]);
        add(brickOf(id), isOnce ? edges : 0, deltas);
        heldOften[often] = static_cast<std::uint16_t>(i);
        often += !isOnce && (activated[i] | deactivated[i]) != 0;
    }
    for (const std::uint16_t i : std::span(heldOften).first(often))
        holders_.forEach(PointId(page.ids[batch.begin + i]), [&](BrickIndex holder, ClosedPoint, unsigned inside) {
            add(holder, std::popcount(activated[i] & inside) - std::popcount(deactivated[i] & inside), deltas);
        });
}

template <class Key>
auto BrickEdgeCounts<Key>::changes() -> std::vector<Change> {
    std::vector<Change> changes;
    for (Deltas& deltas : deltas_)
        for (const BrickIndex brick : deltas.touched) {
            int edges = 0;
            for (Deltas& each : deltas_) {
                Delta& delta = each.byBrick[brick.index()];
                if (delta.walk == walk_)
                    edges += std::exchange(delta.edges, 0); // which other threads have touched, too
            }
            if (edges != 0)
                changes.push_back({brick, edges});
        }
    return changes;
}

template <class Key>
bool BrickEdgeCounts<Key>::apply(std::span<const Change> changes) {
    const bool isPossible = std::all_of(changes.begin(), changes.end(), [this](const Change& change) {
        const int edges = static_cast<int>(at(change.brick)) + change.edges;
        return edges >= 0 && edges <= kMostEdges;
    });
    if (!isPossible)
        return false;
    for (const Change& change : changes)
        counts_[change.brick.index()] = static_cast<std::uint16_t>(counts_[change.brick.index()] + change.edges);
    return true;
}

template class BrickEdgeCounts<std::uint16_t>;
template class BrickEdgeCounts<std::uint32_t>;
template class BrickEdgeCounts<std::uint64_t>;

} // namespace isoslider::extract
