#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/index/sample_store.h"

namespace isoslider::index {

/// Decodes a layer of chunks, and hands each on: take(chunk, samples, whether they could be read).
template <class Sample, class Take>
Status forEachChunkOfLayer(const SampleStore& store, std::int64_t layer, const Take& take) {
    const GridDims& sides = store.chunks().chunks();
    std::vector<Status> outcomes(static_cast<std::size_t>(sides[1]));
    tbb::parallel_for(std::int64_t{0}, sides[1], [&](std::int64_t cy) {
        thread_local std::vector<Sample> samples(SampleStore::kChunkSamples);
        for (std::int64_t cx = 0; cx < sides[0]; ++cx) {
            const ChunkIndex chunk = store.chunks().chunkAt(cx, cy, layer);
            std::uint64_t bytesRead = 0;
            const Status read =
                store.read<Sample>(chunk, std::span<Sample, SampleStore::kChunkSamples>(samples), bytesRead);
            if (!read.isOk() && read.error().code != ErrorCode::Corruption) {
                outcomes[static_cast<std::size_t>(cy)] = read;
                return;
            }
            take(chunk, samples, read);
        }
    });
    for (const Status& outcome : outcomes)
        ISO_TRY(outcome);
    return {};
}

} // namespace isoslider::index
