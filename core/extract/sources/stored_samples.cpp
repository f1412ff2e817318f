#include "core/extract/sources/stored_samples.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>
#include <optional>

#include <tbb/parallel_for.h>

#include "core/base/job_control.h"

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
    : store_(reader), dims_(reader.info().geometry.dims), bricks_(dims_),
      capacity_(capacityFor(cacheBytes, kSamples * sizeof(Sample), store_.chunks().chunkCount())),
      samples_(capacity_ * kSamples), slotOf_(store_.chunks().chunkCount()) {}

template <class Sample>
std::uint64_t StoredSamples<Sample>::orderOf(BrickIndex brick) const {
    const auto b = bricks_.brickCoords(brick);
    const auto inside = static_cast<std::uint64_t>((b[0] & 1) + 2 * (b[1] & 1) + 4 * (b[2] & 1));
    return store_.chunks().chunkAt(b[0] >> 1, b[1] >> 1, b[2] >> 1) << 3 | inside;
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
        const Slot slot = slotOf_[chunk];
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
            const Slot slot = slotOf_[chunk];
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
    const Slot slot = slotOf_[store_.chunks().chunkAt(b[0] >> 1, b[1] >> 1, b[2] >> 1)];
    if (slot == 0)
        return;
    const Sample* const corner = samplesOf(slot) + kBrickSide * ((b[0] & 1) + kSide * ((b[1] & 1) + kSide * (b[2] & 1)));
    constexpr int kRowsPerLine = sizeof(Sample) == 1 ? 4 : sizeof(Sample) == 2 ? 2 : 1;
    for (int z = 0; z < kBrickSide; ++z)
        for (int y = 0; y < kBrickSide; y += kRowsPerLine)
            __builtin_prefetch(corner + kSide * (y + kSide * z));
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
    Slot slot = slotOf_[chunk];
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
                slotOf_[slots_[slot - 1].chunk] = 0;
        }
        slotOf_[chunk] = slot;
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
        slotOf_[state.chunk] = 0;
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
            slotOf_[state.chunk] = 0;
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
    tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t i) {
        if (stop.stop_requested())
            return;
        std::uint64_t bytes = 0;
        const Slot slot = slotOf_[order[i]];
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

template <class Sample>
void StoredSamples<Sample>::readWanted(BrickIndex brick, const BlockRows& rows, SampleBlock<Sample>& block) const {
    const auto b = bricks_.brickCoords(brick);
    block.place(dims_, {b[0] * kBrickSide, b[1] * kBrickSide, b[2] * kBrickSide});
    // Rows -1 to 9 along x lie in two chunks: one sample left of the brick's chunk, or two right of it.
    const bool isRight = b[0] & 1;
    const std::int64_t beside = (b[0] >> 1) + (isRight ? 1 : -1);
    const bool hasBeside = isRight ? block.end[0] > kBrickSide : block.begin[0] < 0;
    const index::ChunkGrid& chunks = store_.chunks();
    for (int z = block.begin[2]; z < block.end[2];) {
        const std::int64_t pz = b[2] * kBrickSide + z;
        const int zEnd = std::min(block.end[2], z + kSide - static_cast<int>(pz % kSide)); // of the chunk
        for (int y = block.begin[1]; y < block.end[1];) {
            const std::int64_t py = b[1] * kBrickSide + y;
            const int yEnd = std::min(block.end[1], y + kSide - static_cast<int>(py % kSide));
            const auto first = static_cast<std::size_t>(kSide * (py % kSide) + kSide * kSide * (pz % kSide));
            const Sample* here = samplesOf(slotOf_[chunks.chunkAt(b[0] >> 1, py / kSide, pz / kSide)]) + first;
            const Sample* aside =
                hasBeside ? samplesOf(slotOf_[chunks.chunkAt(beside, py / kSide, pz / kSide)]) + first
                          : nullptr;
            for (int k = z; k < zEnd; ++k)
                for (int j = y; j < yEnd; ++j) {
                    if (!(rows[static_cast<std::size_t>(k + 1)] >> (j + 1) & 1))
                        continue;
                    const int row = kSide * (j - y) + kSide * kSide * (k - z);
                    Sample* out = block.samples.data() + SampleBlock<Sample>::offset(-1, j, k);
                    if (isRight) {
                        std::memcpy(out, here + row + kBrickSide - 1, (kBrickSide + 1) * sizeof(Sample));
                        if (aside)
                            std::memcpy(out + kBrickSide + 1, aside + row, 2 * sizeof(Sample));
                    } else {
                        std::memcpy(out + 1, here + row, (kBrickSide + 2) * sizeof(Sample));
                        if (aside)
                            out[0] = aside[row + kSide - 1];
                    }
                }
            y = yEnd;
        }
        z = zEnd;
    }
}

template class StoredSamples<std::uint8_t>;
template class StoredSamples<std::int8_t>;
template class StoredSamples<std::uint16_t>;
template class StoredSamples<std::int16_t>;
template class StoredSamples<std::int32_t>;
template class StoredSamples<float>;
template class StoredSamples<double>;

} // namespace isoslider::extract
