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

// The samples of a chunk, brick by brick.
template <class Sample, std::size_t Count>
void storeBricks(const std::array<Sample, Count>& chunk, Sample* out) {
    constexpr std::size_t kInChunk = kSide / kBrickSide;
    for (std::size_t brick = 0; brick < kInChunk * kInChunk * kInChunk; ++brick)
        for (std::size_t z = 0; z < kBrickSide; ++z)
            for (std::size_t y = 0; y < kBrickSide; ++y, out += kBrickSide) {
                const std::size_t row = (brick >> 2) * kBrickSide + z, line = (brick >> 1 & 1) * kBrickSide + y;
                std::memcpy(out, chunk.data() + kSide * (kSide * row + line) + (brick & 1) * kBrickSide,
                            kBrickSide * sizeof(Sample));
            }
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
    constexpr std::int64_t kApron = 1; // beyond a brick's own 9^3, for gradients
    const auto b = bricks_.brickCoords(brick);
    Neighbourhood around;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t begin = std::max<std::int64_t>(0, b[a] * kBrickSide - kApron);
        const std::int64_t last = std::min(dims_[a] - 1, (b[a] + 1) * kBrickSide + kApron);
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

// The samples of the bricks around one, by step along each axis.
template <class Sample>
typename StoredSamples<Sample>::Around StoredSamples<Sample>::samplesAround(
    const std::array<std::int64_t, 3>& b) const {
    // Of the up to eight chunks, by whether they are the lower or the upper of the two along each axis.
    std::array<const Sample*, 8> chunks{};
    const GridDims& count = store_.chunks().chunks();
    std::array<std::int64_t, 3> lower;
    for (std::size_t a = 0; a < 3; ++a)
        lower[a] = (b[a] >> 1) - ((b[a] & 1) != 0 ? 0 : 1);
    for (std::size_t k = 0; k < 8; ++k) {
        const std::int64_t x = lower[0] + static_cast<std::int64_t>(k & 1),
                           y = lower[1] + static_cast<std::int64_t>(k >> 1 & 1),
                           z = lower[2] + static_cast<std::int64_t>(k >> 2);
        if (x >= 0 && y >= 0 && z >= 0 && x < count[0] && y < count[1] && z < count[2])
            chunks[k] = dataOf(x, y, z);
    }
    Around around;
    // Bricks at a step, counted from the lower chunk's first.
    std::array<std::array<std::size_t, 3>, 3> at;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t step = 0; step < 3; ++step)
            at[a][step] = step + ((b[a] & 1) != 0 ? 0 : 1);
    std::size_t place = 0;
    for (const std::size_t z : at[2])
        for (const std::size_t y : at[1])
            for (const std::size_t x : at[0]) {
                const Sample* const chunk = chunks[(x >> 1) + 2 * (y >> 1) + 4 * (z >> 1)];
                const std::size_t brick = (x & 1) + 2 * (y & 1) + 4 * (z & 1);
                around.samples[place++] = chunk ? chunk + kBrickSamples * brick : nullptr;
            }
    return around;
}

// All lines of the brick and of those beside it along x, and what is needed of the others.
template <class Sample>
void StoredSamples<Sample>::prefetch(BrickIndex brick) const {
    const Around around = samplesAround(bricks_.brickCoords(brick));
    constexpr std::size_t kLine = 64, kRow = kBrickSide * sizeof(Sample), kPlane = kBrickSide * kRow;
    const auto fetch = [](const Sample* samples, std::size_t first, std::size_t bytes) {
        if (samples)
            for (std::size_t at = first / kLine * kLine; at < first + bytes; at += kLine)
                __builtin_prefetch(reinterpret_cast<const char*>(samples) + at);
    };
    const auto fetchRows = [&](const Sample* samples, std::size_t row, std::size_t rows) {
        for (std::size_t z = 0; z < kBrickSide; ++z)
            fetch(samples, z * kPlane + row * kRow, rows * kRow);
    };
    fetch(around.at(0, 0, 0), 0, kBrickSide * kPlane);
    for (int x = 0; x <= 1; ++x) {
        fetchRows(around.at(x, 1, 0), 0, 2);
        fetchRows(around.at(x, -1, 0), kBrickSide - 1, 1);
        fetch(around.at(x, 0, 1), 0, 2 * kPlane);
        fetch(around.at(x, 0, -1), (kBrickSide - 1) * kPlane, kPlane);
    }
    fetch(around.at(1, 0, 0), 0, kBrickSide * kPlane);
    fetch(around.at(-1, 0, 0), 0, kBrickSide * kPlane);
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
        alignas(64) std::array<Sample, kSamples> chunk;
        const Status status = store_.read<Sample>(order[i], chunk, bytes);
        bytesRead.fetch_add(bytes, std::memory_order_relaxed);
        if (status.isOk())
            storeBricks(chunk, samplesOf(slot));
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
SampleRows<Sample> StoredSamples<Sample>::rows(BrickIndex brick) const {
    const auto b = bricks_.brickCoords(brick);
    SampleRows<Sample> rows;
    placeInBox(dims_, {b[0] * kBrickSide, b[1] * kBrickSide, b[2] * kBrickSide}, rows.begin, rows.end);
    rows.rowStride = kBrickSide;
    rows.planeStride = kBrickSide * kBrickSide;
    const Around around = samplesAround(b);
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y) {
            const std::size_t place = rows.placeOf(y, z);
            // Of row 0 of plane 0 of the brick in the middle, counted from the first sample of the other.
            const std::ptrdiff_t first = -kBrickSide * (rows.rowStride * y + rows.planeStride * z);
            rows.before[place] = {around.at(-1, y, z), first + kBrickSide - 1};
            rows.own[place] = {around.at(0, y, z), first};
            rows.behind[place] = {around.at(1, y, z), first};
        }
    return rows;
}

#define ISO_INSTANTIATE(Sample, Name) template class StoredSamples<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::extract
