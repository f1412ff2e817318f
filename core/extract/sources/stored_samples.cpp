#include "core/extract/sources/stored_samples.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>
#include <optional>

#include "core/base/job_control.h"
#include "core/base/worker_team.h"

namespace isoslider::extract {
namespace {

constexpr std::size_t kMostChunksOfBrick = 8;
constexpr int kSide = index::kChunkSide;

std::size_t capacityFor(std::uint64_t cacheBytes, std::size_t chunkBytes, std::uint64_t chunkCount) {
    const std::uint64_t bound = std::min<std::uint64_t>(cacheBytes / chunkBytes, chunkCount);
    return static_cast<std::size_t>(std::max<std::uint64_t>(bound, kMostChunksOfBrick));
}

} // namespace

template <class Sample>
StoredSamples<Sample>::StoredSamples(const index::IndexReader& reader, std::uint64_t cacheBytes)
    : store_(reader),
      dims_(reader.info().geometry.dims),
      bricks_(dims_),
      capacity_(capacityFor(cacheBytes, kSamples * sizeof(Sample), store_.chunks().chunkCount())),
      samples_(capacity_ * kSamples),
      slotOf_(store_.chunks().chunkCount()) {}

template <class Sample>
std::uint64_t StoredSamples<Sample>::orderOf(BrickIndex brick) const {
    const auto b = bricks_.brickCoords(brick);
    const auto inside = static_cast<std::uint64_t>((b[0] & 1) + 2 * (b[1] & 1) + 4 * (b[2] & 1));
    return store_.chunks().chunkAt(b[0] >> 1, b[1] >> 1, b[2] >> 1).number() << 3 | inside;
}

template <class Sample>
typename StoredSamples<Sample>::Neighbourhood StoredSamples<Sample>::neighbourhood(BrickIndex brick) const {
    const auto b = bricks_.brickCoords(brick);
    Neighbourhood around;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t begin = std::max<std::int64_t>(0, b[a] * kBrickSide - 1);
        const std::int64_t last = std::min(dims_[a], b[a] * kBrickSide + kBrickSide + 2) - 1;
        around.first[a] = begin / kSide;
        around.count[a] = static_cast<int>(last / kSide - around.first[a]) + 1;
    }
    return around;
}

template <class Sample>
void StoredSamples<Sample>::unlink(Slot slot) {
    const SlotState& state = slots_[slot - 1];
    (state.newer != 0 ? slots_[state.newer - 1].older : newest_) = state.older;
    (state.older != 0 ? slots_[state.older - 1].newer : oldest_) = state.newer;
}

template <class Sample>
void StoredSamples<Sample>::pushNewest(Slot slot) {
    SlotState& state = slots_[slot - 1];
    state.newer = 0;
    state.older = newest_;
    (newest_ != 0 ? slots_[newest_ - 1].newer : oldest_) = slot;
    newest_ = slot;
}

// Calls visit(chunk) for the chunks that a brick's block reaches into, until one returns false.
template <class Sample>
template <class Visit>
bool StoredSamples<Sample>::forEachChunk(BrickIndex brick, const Visit& visit) const {
    const Neighbourhood around = neighbourhood(brick);
    for (int k = 0; k < around.count[2]; ++k)
        for (int j = 0; j < around.count[1]; ++j)
            for (int i = 0; i < around.count[0]; ++i)
                if (!visit(store_.chunks().chunkAt(around.first[0] + i, around.first[1] + j, around.first[2] + k)))
                    return false;
    return true;
}

template <class Sample>
bool StoredSamples<Sample>::isReady(BrickIndex brick) const {
    return forEachChunk(brick, [&](Chunk chunk) {
        const Slot slot = slotOf_[chunk.index()];
        return slot != 0 && slots_[slot - 1].isFilled;
    });
}

// While there are free slots nothing is evicted, and the order does not matter yet.
template <class Sample>
void StoredSamples<Sample>::touch(std::span<const BrickIndex> bricks) {
    if (slots_.size() < capacity_)
        return;
    ++batch_;
    for (const BrickIndex brick : bricks)
        (void)forEachChunk(brick, [&](Chunk chunk) {
            const Slot slot = slotOf_[chunk.index()];
            if (slot != 0 && slots_[slot - 1].batch != batch_) {
                unlink(slot);
                slots_[slot - 1].batch = batch_;
                pushNewest(slot);
            }
            return true;
        });
}

// The chunk of the brick itself: nine tenths of what is read.
template <class Sample>
void StoredSamples<Sample>::prefetch(BrickIndex brick) const {
    const auto b = bricks_.brickCoords(brick);
    constexpr int kRowsPerLine = sizeof(Sample) == 1 ? 4 : sizeof(Sample) == 2 ? 2 : 1;
    const auto fetch = [&](const Sample* from, std::ptrdiff_t x) {
        for (int z = 0; z < kBrickSide; ++z)
            for (int y = 0; y < kBrickSide; y += kRowsPerLine)
                __builtin_prefetch(from + x + kSide * (y + kSide * z));
    };
    const std::ptrdiff_t first = kSide * ((b[1] & 1) * kBrickSide + kSide * ((b[2] & 1) * kBrickSide));
    const Sample* const own = dataOf(b[0] >> 1, b[1] >> 1, b[2] >> 1);
    if (!own)
        return;
    fetch(own + first, kBrickSide * (b[0] & 1));
    // Of the chunk beside it along x each row has one or two samples for the brick, in a separate line.
    const bool isUpper = (b[0] & 1) != 0;
    const std::int64_t beside = (b[0] >> 1) + (isUpper ? 1 : -1);
    if (beside >= 0 && beside < store_.chunks().chunks()[0])
        if (const Sample* const data = dataOf(beside, b[1] >> 1, b[2] >> 1))
            fetch(data + first, isUpper ? 0 : kSide - 1);
}

template <class Sample>
void StoredSamples<Sample>::pushOldest(Slot slot) {
    SlotState& state = slots_[slot - 1];
    state.newer = oldest_;
    state.older = 0;
    (oldest_ != 0 ? slots_[oldest_ - 1].older : newest_) = slot;
    oldest_ = slot;
}

// Gives the chunk a slot for this batch; false when all slots are needed by it already.
template <class Sample>
bool StoredSamples<Sample>::claim(Chunk chunk, std::vector<Slot>& missing) {
    Slot slot = slotOf_[chunk.index()];
    if (slot != 0) {
        if (slots_[slot - 1].batch == batch_)
            return true;
        unlink(slot);
        if (!slots_[slot - 1].isFilled) // left behind when memory ran out
            missing.push_back(slot);
    } else {
        if (slots_.size() < capacity_) {
            slots_.emplace_back();
            slot = static_cast<Slot>(slots_.size());
        } else {
            slot = oldest_;
            if (slots_[slot - 1].batch == batch_)
                return false;
            unlink(slot);
            if (slots_[slot - 1].chunk != kNone)
                slotOf_[slots_[slot - 1].chunk.index()] = 0;
        }
        slotOf_[chunk.index()] = slot;
        slots_[slot - 1].chunk = chunk;
        slots_[slot - 1].isFilled = false;
        missing.push_back(slot);
    }
    slots_[slot - 1].batch = batch_;
    pushNewest(slot);
    return true;
}

template <class Sample>
Result<std::size_t> StoredSamples<Sample>::prepare(std::span<const BrickIndex> bricks, SlideStats& stats,
                                                   std::stop_token stop) {
    return prepare(bricks, capacity_, stats, stop);
}

template <class Sample>
Status StoredSamples<Sample>::fetch(std::span<const BrickIndex> bricks, SlideStats& stats, std::stop_token stop) {
    const auto fetched = prepare(bricks, capacity_ / 4, stats, stop);
    return fetched.isOk() ? Status() : Status(fetched.error());
}

template <class Sample>
Result<std::size_t> StoredSamples<Sample>::prepare(std::span<const BrickIndex> bricks, std::size_t maxMissing,
                                                   SlideStats& stats, std::stop_token stop) {
    ++batch_;
    std::vector<Slot> missing;
    std::size_t ready = 0;
    for (bool hasRoom = true; ready < bricks.size() && missing.size() <= maxMissing; ++ready) {
        hasRoom = forEachChunk(bricks[ready], [&](Chunk chunk) { return claim(chunk, missing); });
        if (!hasRoom)
            break;
    }
    const Status decoded = decode(missing, stats, stop);
    if (decoded.isOk())
        return ready;
    dropUnfilled(missing);
    return decoded.error();
}

// After a move that was broken off, or a chunk that cannot be read.
template <class Sample>
void StoredSamples<Sample>::dropUnfilled(std::span<const Slot> missing) {
    for (const Slot slot : missing) {
        SlotState& state = slots_[slot - 1];
        if (state.isFilled)
            continue;
        slotOf_[state.chunk.index()] = 0;
        state.chunk = kNone;
        state.batch = 0;
        unlink(slot);
        pushOldest(slot);
    }
}

template <class Sample>
void StoredSamples<Sample>::dropCaches() {
    for (const SlotState& state : slots_)
        if (state.chunk != kNone)
            slotOf_[state.chunk.index()] = 0;
    slots_.clear();
    newest_ = oldest_ = 0;
}

template <class Sample>
Status StoredSamples<Sample>::decode(std::span<const Slot> missing, SlideStats& stats, std::stop_token stop) {
    std::vector<Chunk> order;
    order.reserve(missing.size());
    for (const Slot slot : missing)
        order.push_back(slots_[slot - 1].chunk);
    std::sort(order.begin(), order.end());
    std::uint64_t tableBytes = 0;
    store_.willNeed(order, tableBytes, stop);
    std::atomic<std::uint64_t> bytesRead = tableBytes;
    std::mutex errorMutex;
    std::optional<Error> firstError;
    std::size_t firstErrorAt = order.size();
    forEachIndex(order.size(), 1, [&](std::size_t i) {
        if (stop.stop_requested())
            return;
        std::uint64_t bytes = 0;
        const Slot slot = slotOf_[order[i].index()];
        const std::span<Sample, kSamples> out(samplesOf(slot), kSamples);
        const Status status = store_.read<Sample>(order[i], out, bytes);
        bytesRead.fetch_add(bytes, std::memory_order_relaxed);
        slots_[slot - 1].isFilled = status.isOk();
        if (!status.isOk()) {
            const std::lock_guard lock(errorMutex);
            if (i < firstErrorAt)
                firstError = status.error();
            firstErrorAt = std::min(firstErrorAt, i);
        }
    });
    stats.bytesRead += bytesRead;
    stats.chunksRead += order.size();
    if (firstError)
        return std::move(*firstError);
    return stop.stop_requested() && !order.empty() ? Status(cancelledError()) : Status();
}

// A chunk is two bricks wide. Along each axis a brick's block reaches into the chunk before by one sample where the
// brick is its chunk's first, and into the one behind by two where it is the second.
template <class Sample>
SampleRows<Sample> StoredSamples<Sample>::rows(BrickIndex brick) const {
    const auto b = bricks_.brickCoords(brick);
    const std::array<std::int64_t, 3> origin{b[0] * kBrickSide, b[1] * kBrickSide, b[2] * kBrickSide};
    SampleRows<Sample> rows;
    placeInBox(dims_, origin, rows.begin, rows.end);
    rows.rowStride = kSide;
    rows.planeStride = kSide * kSide;
    rows.splitY = b[1] & 1 ? kBrickSide : 0;
    rows.splitZ = b[2] & 1 ? kBrickSide : 0;
    const GridDims& chunks = store_.chunks().chunks();
    const std::int64_t cx = b[0] >> 1;
    const bool isSecond = b[0] & 1;
    for (std::size_t place = 0; place < 4; ++place) {
        const std::int64_t cy = (b[1] >> 1) - (b[1] & 1 ? 0 : 1) + static_cast<std::int64_t>(place & 1);
        const std::int64_t cz = (b[2] >> 1) - (b[2] & 1 ? 0 : 1) + static_cast<std::int64_t>(place >> 1);
        if (cy < 0 || cz < 0 || cy >= chunks[1] || cz >= chunks[2])
            continue;
        // Of local row 0 of plane 0, counted from the chunk's first sample.
        const std::ptrdiff_t first = kSide * (origin[1] - kSide * cy) + kSide * kSide * (origin[2] - kSide * cz);
        const Sample* const own = dataOf(cx, cy, cz);
        rows.own[place] = {own, first + (isSecond ? kBrickSide : 0)};
        if (isSecond) {
            rows.before[place] = {own, first + kBrickSide - 1};
            rows.behind[place] = {cx + 1 < chunks[0] ? dataOf(cx + 1, cy, cz) : nullptr, first};
        } else {
            rows.before[place] = {cx > 0 ? dataOf(cx - 1, cy, cz) : nullptr, first + kSide - 1};
            rows.behind[place] = {own, first + kBrickSide};
        }
    }
    return rows;
}

#define ISO_INSTANTIATE(Sample, Name) template class StoredSamples<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
