#pragma once

#include <cstdint>
#include <vector>

#include "core/extract/sources/sample_reader.h"
#include "core/extract/virtual_array.h"
#include "core/index/sample_store.h"

namespace isoslider::extract {

/// The samples of an index behind a cache of decoded chunks.
///
/// The cache is an array of slots of one chunk each, in which the samples of a brick lie together: a brick that arrives
/// reads fewer lines than if rows ran through the chunk, most of them one behind the other. Bricks are made ready in
/// batches: one thread gives each chunk that a batch needs a slot (least recently used out first, those of the batch
/// never), all threads decode what is missing; afterwards all threads read without locks or counts, because nothing
/// moves until the next batch. A batch ends where the slots end, so the bound on memory is kept whatever a move needs,
/// and the result does not depend on it. Never below the eight chunks that one brick may need.
template <class Sample>
class StoredSamples final : public SampleReader<Sample> {
public:
    /// `reader` must outlive this. At most `cacheBytes` of decoded samples are kept.
    StoredSamples(const index::IndexReader& reader, std::uint64_t cacheBytes);

    std::uint64_t orderOf(BrickIndex brick) const override;
    Result<std::size_t> prepare(std::span<const BrickIndex> bricks, SlideStats& stats, std::stop_token stop) override;
    bool isReady(BrickIndex brick) const override;
    void touch(std::span<const BrickIndex> bricks) override;
    void prefetch(BrickIndex brick) const override;
    SampleRows<Sample> rows(BrickIndex brick) const override;
    bool fetchesAhead() const override { return capacity_ >= kLeastAhead; }
    Status fetch(std::span<const BrickIndex> bricks, SlideStats& stats, std::stop_token stop) override;
    void dropCaches() override;

    /// Chunks that fit into the cache.
    std::size_t capacity() const { return capacity_; }
    std::uint64_t mostBytes() const { return capacity_ * kSamples * sizeof(Sample); }

private:
    using Chunk = index::ChunkIndex;
    using Slot = std::uint32_t; ///< from 1 on; 0 stands for none
    static constexpr std::size_t kLeastAhead = 256; ///< a smaller cache has better things to keep
    static constexpr std::size_t kSamples = index::SampleStore::kChunkSamples;

    static constexpr std::size_t kBrickSamples = kBrickSide * kBrickSide * kBrickSide;
    /// Samples of the bricks around one, which is in the middle; null where there are none.
    struct Around {
        std::array<const Sample*, 27> samples{};
        const Sample* at(int x, int y, int z) const {
            return samples[static_cast<std::size_t>(x + 1 + 3 * (y + 1) + 9 * (z + 1))];
        }
    };

    static constexpr Chunk kNone{~std::uint64_t{0}};
    struct SlotState {
        Chunk chunk = kNone;
        std::uint64_t batch = 0; ///< that used it last
        Slot newer = 0, older = 0;
        bool isFilled = false;
    };
    /// The chunks that a brick's block reaches into.
    struct Neighbourhood {
        std::array<std::int64_t, 3> first; ///< chunk coordinates
        std::array<int, 3> count; ///< 1 or 2
    };

    Neighbourhood neighbourhood(BrickIndex brick) const;
    Around samplesAround(const std::array<std::int64_t, 3>& b) const;
    template <class Visit>
    bool forEachChunk(BrickIndex brick, const Visit& visit) const;
    bool claim(Chunk chunk, std::vector<Slot>& missing);
    Result<std::size_t> prepare(std::span<const BrickIndex> bricks, std::size_t maxMissing, SlideStats& stats,
                                std::stop_token stop);
    Status decode(std::span<const Slot> missing, SlideStats& stats, std::stop_token stop);
    void unlink(Slot slot);
    void pushNewest(Slot slot);
    void pushOldest(Slot slot);
    void dropUnfilled(std::span<const Slot> missing);
    Sample* samplesOf(Slot slot) { return samples_.data() + (slot - 1) * kSamples; }
    const Sample* samplesOf(Slot slot) const { return samples_.data() + (slot - 1) * kSamples; }
    /// Null for a chunk that is not in the cache: a brick that is ready does not reach into it.
    const Sample* dataOf(std::int64_t cx, std::int64_t cy, std::int64_t cz) const {
        const Slot slot = slotOf_[store_.chunks().chunkAt(cx, cy, cz).index()];
        return slot == 0 ? nullptr : samplesOf(slot);
    }

    index::SampleStore store_;
    GridDims dims_;
    BrickGrid bricks_;
    std::size_t capacity_;
    VirtualArray<Sample> samples_;
    VirtualArray<Slot> slotOf_; ///< by chunk
    std::vector<SlotState> slots_; ///< slot i at i - 1; grows up to capacity_
    Slot newest_ = 0, oldest_ = 0;
    std::uint64_t batch_ = 0;
};

#define ISO_DECLARE(Sample, Name) extern template class StoredSamples<Sample>;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_DECLARE)
#undef ISO_DECLARE

} // namespace isoslider::extract
