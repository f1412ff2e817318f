// Edge blocks: what a move changes, from the records on its way to the edges of each brick.

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/base/worker_team.h"
#include "core/extract/sources/edge_scratch.h"

namespace isoslider::extract {
namespace {

constexpr std::array<int, index::kPointEdges> kFarEnd{-kPointStride[0], kPointStride[0],  -kPointStride[1],
                                                      kPointStride[1],  -kPointStride[2], kPointStride[2]};

// Grows only: what is behind the end stays.
template <class T>
void makeRoom(std::vector<T>& list, std::size_t count) {
    if (list.size() < count)
        list.resize(count);
}

} // namespace

template <class Sample>
void EdgeBlockSource<Sample>::Lists::clear() {
    for (std::size_t p = 0; p < kPartitions; ++p) {
        points[p].clear();
        normals[p].clear();
        edges[p].clear();
        leaves[p].clear();
    }
    edgesAdded = edgesRemoved = 0;
}

// In batches that stay in the nearest cache.
template <class Sample>
std::size_t EdgeBlockSource<Sample>::collect(const Part& part, KeyThreshold lower, KeyThreshold upper, bool goesUp) {
    Lists& lists = lists_->local();
    std::size_t entry = part.firstEntry;
    for (std::size_t begin = part.begin; begin < part.end; begin += kBatch) {
        const Part batch{part.page, begin, std::min(begin + kBatch, part.end), entry};
        entry = collectBatch(batch, lower, upper, goesUp, lists);
    }
    return entry;
}

template <class Sample>
std::size_t EdgeBlockSource<Sample>::collectBatch(const Part& batch, KeyThreshold lower, KeyThreshold upper,
                                                  bool goesUp, Lists& lists) {
    const index::DecodedPage<Key>& page = batch.page;
    std::array<std::uint8_t, kBatch> above, below;
    findChangedEdges<Key>(std::span(page.masks).subspan(batch.begin, batch.end - batch.begin),
                          std::span(page.farKeys).subspan(batch.firstEntry), lower, upper, above.data(), below.data());
    const auto &activated = goesUp ? above : below, &deactivated = goesUp ? below : above;
    // Which points change and which are held more than once can hardly be predicted: so they are listed first.
    std::array<Changed, kBatch + 1> heldOnce, heldOften;
    std::size_t once = 0, often = 0;
    std::uint64_t added = 0, removed = 0;
    std::size_t entry = batch.firstEntry;
    for (std::size_t record = batch.begin; record < batch.end; ++record) {
        Changed changed{record, entry, activated[record - batch.begin], deactivated[record - batch.begin]};
        if (page.form(record) != index::record_form::kPoint) {
            changed.activated = changed.deactivated = 0;
            if (const std::uint64_t other = page.farKeys[entry]; other < lower || other >= upper)
                collectMerged(batch, record, entry, goesUp, lists);
        }
        const bool isChanged = (changed.activated | changed.deactivated) != 0;
        const bool isOnce = holders_.isHeldOnce(PointId(page.ids[record]));
        heldOnce[once] = changed;
        heldOften[often] = changed;
        once += isChanged && isOnce;
        often += isChanged && !isOnce;
        added += static_cast<std::uint64_t>(std::popcount(changed.activated));
        removed += static_cast<std::uint64_t>(std::popcount(changed.deactivated));
        entry += static_cast<std::size_t>(std::popcount(page.masks[record]));
    }
    lists.edgesAdded += added;
    lists.edgesRemoved += removed;
    for (const Changed& changed : std::span(heldOnce).first(once)) {
        const PointId id(page.ids[changed.record]);
        const ClosedPoint point = PointHolders::closedPointOf(localOf(id));
        addCrossed(page, changed, {brickOf(id), point, changed.activated, changed.deactivated}, lists);
    }
    for (const Changed& changed : std::span(heldOften).first(often))
        holders_.forEach(PointId(page.ids[changed.record]), [&](BrickIndex holder, ClosedPoint point, unsigned inside) {
            const CrossedEdges edges{holder, point, static_cast<std::uint8_t>(changed.activated & inside),
                                     static_cast<std::uint8_t>(changed.deactivated & inside)};
            if ((edges.activated | edges.deactivated) != 0)
                addCrossed(page, changed, edges, lists);
        });
    return entry;
}

// Lists a crossed point for one of the bricks that hold it.
template <class Sample>
ISO_ALWAYS_INLINE void EdgeBlockSource<Sample>::addCrossed(const index::DecodedPage<Key>& page, const Changed& changed,
                                                           const CrossedEdges& edges, Lists& lists) const {
    const std::size_t record = changed.record;
    std::size_t entry = changed.entry;
    const std::size_t partition = partitionOf(edges.brick);
    CrossedPoint<Key>& crossed = lists.points[partition].emplace_back();
    __builtin_prefetch(reinterpret_cast<const char*>(&crossed) + 256, 1); // more lists than a processor follows
    static_cast<CrossedEdges&>(crossed) = edges;
    crossed.mask = page.masks[record];
    crossed.key = page.keys[record];
    if (entry + index::kPointEdges <= page.farKeys.size()) // a known number: without a call
        std::memcpy(crossed.far, page.farKeys.data() + entry, sizeof crossed.far);
    else
        std::copy(page.farKeys.data() + entry, page.farKeys.data() + page.farKeys.size(), crossed.far);
    if (normals_)
        return;
    CrossedNormals& normals = lists.normals[partition].emplace_back();
    if (!page.hasNormals())
        return;
    normals.own = page.normals[record];
    for (unsigned left = crossed.mask; left != 0; left &= left - 1)
        normals.far[std::countr_zero(left)] = page.farNormals[entry++];
}

// How much was collected of each brick of a partition.
template <class Sample>
void EdgeBlockSource<Sample>::countChanges(std::size_t partition, const LiveSurface<Live>& surface, Scratch& scratch) {
    std::vector<TouchedBrick>& touched = touched_[partition];
    touched.clear();
    const BrickIndex first = firstBrickOf(partition);
    scratch.isByBrickInUse = true;
    makeRoom(scratch.byBrick, (firstBrickOf(partition + 1) - first));
    const auto countOf = [&](BrickIndex brick) -> TouchedBrick& {
        TouchedBrick& count = scratch.byBrick[(brick - first)];
        if (!count.isTouched) {
            count.isTouched = true;
            touched.push_back({brick, 0, 0, false, true});
        }
        return count;
    };
    for (const Lists& lists : *lists_) {
        for (const CrossedPoint<Key>& point : lists.points[partition]) {
            TouchedBrick& count = countOf(point.brick);
            ++count.points;
            count.hasActivated |= point.activated != 0;
        }
        for (const ChangedEdge& edge : lists.edges[partition]) {
            TouchedBrick& count = countOf(edge.brick);
            ++count.edges;
            count.hasActivated |= edge.isActivated;
        }
        for (const ChangedLeaf& leaf : lists.leaves[partition])
            countOf(leaf.brick);
    }
    std::size_t kept = 0;
    for (const TouchedBrick& brick : touched) {
        const TouchedBrick count = std::exchange(scratch.byBrick[(brick.brick - first)], {});
        if (slotOf_[brick.brick.index()] == 0) {
            if (!count.hasActivated) { // loses an edge that it has never had
                scratch.isConsistent = scratch.isConsistent && surface.shapes().isNearMissing(brick.brick);
                continue;
            }
            scratch.arriving.push_back(brick.brick);
        }
        touched[kept++] = {brick.brick, count.points, count.edges, count.hasActivated, true};
    }
    touched.resize(kept);
    scratch.isByBrickInUse = false;
}

// Brings what was collected for a partition into the order of its bricks: each is made from what lies together.
template <class Sample>
void EdgeBlockSource<Sample>::sortChanges(std::size_t partition, Scratch& scratch) {
    std::vector<TouchedBrick>& touched = touched_[partition];
    std::sort(touched.begin(), touched.end(), [this](const TouchedBrick& a, const TouchedBrick& b) {
        return slotOf_[a.brick.index()] < slotOf_[b.brick.index()];
    });
    const BrickIndex first = firstBrickOf(partition);
    scratch.isByBrickInUse = true;
    makeRoom(scratch.byBrick, (firstBrickOf(partition + 1) - first));
    std::uint32_t points = 0, edges = 0;
    for (const TouchedBrick& brick : touched) {
        scratch.byBrick[(brick.brick - first)] = {brick.brick, points, edges, false, true}; // where its next ones go
        points += brick.points;
        edges += brick.edges;
    }
    makeRoom(scratch.crossed, points);
    makeRoom(scratch.edges, edges);
    if (!normals_)
        makeRoom(scratch.normals, points);
    for (const Lists& lists : *lists_) {
        for (std::size_t i = 0; i < lists.points[partition].size(); ++i) {
            const CrossedPoint<Key>& point = lists.points[partition][i];
            TouchedBrick& next = scratch.byBrick[(point.brick - first)];
            if (!next.isTouched)
                continue;
            if (!normals_)
                scratch.normals[next.points] = lists.normals[partition][i];
            scratch.crossed[next.points++] = point;
        }
        for (const ChangedEdge& edge : lists.edges[partition])
            if (TouchedBrick& next = scratch.byBrick[(edge.brick - first)]; next.isTouched)
                scratch.edges[next.edges++] = edge;
    }
    for (const TouchedBrick& brick : touched)
        scratch.byBrick[(brick.brick - first)] = {};
    scratch.isByBrickInUse = false;
}

// Edges of the brick that become active and inactive.
template <class Sample>
void EdgeBlockSource<Sample>::findToggled(const Changes& changes, const BrickMasks& masks, bool goesUp,
                                          Scratch& scratch) const {
    ToggledEdges& toggled = scratch.toggled;
    if (changes.points.empty())
        toggled = {};
    else
        listToggledEdges(changes.points.data(), sizeof(CrossedPoint<Key>), changes.points.size(), masks, goesUp,
                         toggled);
    for (const ChangedEdge& change : changes.edges) {
        const auto axis = static_cast<std::size_t>(axisOf(change.edge));
        if (masks.edges[axis].test(startOf(change.edge))) // otherwise of no valid cell of this brick
            (change.isActivated ? toggled.activated : toggled.deactivated)[axis].set(startOf(change.edge));
    }
}

// Calls visit(point, sample) for the ends of activated edges, for some more than once.
template <class Sample>
template <class Visit>
void EdgeBlockSource<Sample>::forEachEnd(std::span<const CrossedPoint<Key>> points, const Visit& visit) {
    for (const CrossedPoint<Key>& crossed : points) {
        if (crossed.activated == 0)
            continue;
        const std::size_t point = crossed.point.index();
        const Stored sample = storedOf(sampleOfKey<Sample>(crossed.key));
        visit(point, sample);
        const Key* far = crossed.far;
        for (std::size_t e = 0; e < index::kPointEdges; ++e) { // without branches, which could not be predicted
            const bool isActivated = crossed.activated >> e & 1;
            const Stored farSample = storedOf(sampleOfKey<Sample>(*far));
            visit(isActivated ? point + static_cast<std::size_t>(kFarEnd[e]) : point, isActivated ? farSample : sample);
            far += crossed.mask >> e & 1;
        }
    }
}

// Whether the samples that come are all there.
template <class Sample>
bool EdgeBlockSource<Sample>::hasAllEnds(const Points& points, std::span<const CrossedPoint<Key>> crossed) {
    for (std::size_t i = 0; i < crossed.size(); ++i) {
        bool isSame = true;
        forEachEnd(crossed.subspan(i, 1), [&](std::size_t point, Stored sample) {
            isSame &= std::memcmp(&points.samples[point], &sample, sizeof sample) == 0;
        });
        if (!isSame)
            return false;
    }
    return true;
}

// Scalars, and normals that entries bring, at the ends of edges that came. A point that is there already gets what it
// has; where all are, the brick's points stay as they are.
template <class Sample>
void EdgeBlockSource<Sample>::fillPoints(BrickSlot slot, const Changes& changes, const LiveSurface<Live>& surface,
                                         Scratch& scratch) const {
    scratch.draft.newPoints = nullptr;
    const bool isNew = !surface.brick(slot).hasPoints;
    if (!isNew && (!changes.hasActivated || (changes.edges.empty() && changes.normals.empty() &&
                                             hasAllEnds(pointsIn<Sample>(surface.points(slot)), changes.points))))
        return;
    Points& points = scratch.points;
    if (isNew && !normals_)
        std::memset(static_cast<void*>(&points), 0, sizeof points);
    else // pictures may refer to what is there
        std::memcpy(static_cast<void*>(&points), surface.points(slot), sizeof points);
    scratch.draft.newPoints = linesOf<Sample>(points);
    forEachEnd(changes.points, [&](std::size_t point, Stored sample) { points.samples[point] = sample; });
    for (std::size_t i = 0; i < changes.normals.size(); ++i) {
        const CrossedPoint<Key>& crossed = changes.points[i];
        NormalCode* const at = points.normals + crossed.point.index();
        if (crossed.activated != 0)
            *at = changes.normals[i].own;
        for (unsigned left = crossed.activated; left != 0; left &= left - 1) {
            const auto e = static_cast<std::size_t>(std::countr_zero(left));
            at[kFarEnd[e]] = changes.normals[i].far[e];
        }
    }
    for (const ChangedEdge& change : changes.edges) {
        if (!change.isActivated)
            continue;
        const auto [lower, upper] = endsOf(vertexCode(change.edge, change.level));
        points.samples[lower] = change.scalar1;
        points.samples[upper] = change.scalar2;
        if (normals_)
            continue;
        points.normals[lower] = change.normal1;
        points.normals[upper] = change.normal2;
    }
}

#define ISO_INSTANTIATE(Sample, Name) \
    template void EdgeBlockSource<Sample>::Lists::clear(); \
    template std::size_t EdgeBlockSource<Sample>::collect(const Part&, KeyThreshold, KeyThreshold, bool); \
    template void EdgeBlockSource<Sample>::countChanges(std::size_t, const LiveSurface<Live>&, Scratch&); \
    template void EdgeBlockSource<Sample>::sortChanges(std::size_t, Scratch&); \
    template void EdgeBlockSource<Sample>::findToggled(const Changes&, const BrickMasks&, bool, Scratch&) const; \
    template void EdgeBlockSource<Sample>::fillPoints(BrickSlot, const Changes&, const LiveSurface<Live>&, Scratch&) \
        const;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
