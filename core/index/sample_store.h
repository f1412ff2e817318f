#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <stop_token>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/scalar_grid.h"
#include "core/index/format/chunk_codec.h"
#include "core/index/format/chunk_grid.h"
#include "core/index/format/chunk_table.h"
#include "core/index/index_reader.h"

namespace isoslider::index {

/// The samples of an index, by chunk. Tables of chunk groups are read when
/// first needed and kept: 8 KB for the million samples around a piece of surface. Any number of threads at once.
class SampleStore {
public:
    /// Decoded chunks are 16^3 whatever their extent: sample (x, y, z) at x + 16 y + 256 z.
    static constexpr std::size_t kChunkSamples = std::size_t{kChunkSide} * kChunkSide * kChunkSide;

    /// `reader` must outlive the store.
    explicit SampleStore(const IndexReader& reader);
    ~SampleStore();

    const ChunkGrid& chunks() const { return chunks_; }

    /// Errors: IoError, Corruption. Adds to `bytesRead` what was read from disk.
    Result<ChunkPlace> find(ChunkIndex chunk, std::uint64_t& bytesRead) const;
    /// Decodes a chunk; places beyond its extent are left as they are. Errors: IoError, Corruption.
    /// REQUIRES: Sample is the volume's scalar type.
    template <class Sample>
    Status read(ChunkIndex chunk, std::span<Sample, kChunkSamples> out, std::uint64_t& bytesRead) const;
    /// Asks the system to read what `chunks`, in rising order, need, all at once. Adds to `bytesRead` what tables took.
    void willNeed(std::span<const ChunkIndex> chunks, std::uint64_t& bytesRead, std::stop_token stop) const;

private:
    struct ChunkGroup {
        std::vector<ChunkPlace> places;
    };
    Result<const ChunkGroup*> group(std::uint64_t number, std::uint64_t& bytesRead) const;

    const IndexReader& reader_;
    ChunkGrid chunks_;
    mutable std::mutex mutex_; // of loading
    std::unique_ptr<std::atomic<const ChunkGroup*>[]> groups_;
};

/// All samples of an index, as the volume that it was built from. Errors: IoError, Corruption, Cancelled.
Result<std::shared_ptr<const ScalarGrid>> readSamples(const IndexReader& reader, const JobControl& job = {});

} // namespace isoslider::index
