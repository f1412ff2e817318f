#pragma once

#include <vector>

#include "core/index/format/chunk_codec.h"
#include "core/index/index_writer.h"
#include "core/index/sample_store.h"

namespace isoslider::test {

/// The chunks of another index, as they are.
inline Status copyChunks(const index::IndexReader& from, index::IndexWriter& to) {
    const index::SampleStore store(from);
    std::vector<std::byte> bytes;
    std::uint64_t bytesRead = 0;
    for (const index::ChunkIndex chunk : firstIds<index::ChunkIndex>(store.chunks().chunkCount())) {
        const auto place = store.find(chunk, bytesRead);
        if (!place.isOk())
            return place.error();
        ISO_TRY(from.readPart(place.value().offset, place.value().bytes, place.value().checksum, bytes));
        ISO_TRY(to.addChunk(bytes));
    }
    return to.endChunks();
}

/// A chunk whose samples are all 0.
template <class Sample>
std::vector<std::byte> blankSamples(const index::ChunkExtent& extent) {
    const std::vector<Sample> none(static_cast<std::size_t>(extent[0] * extent[1] * extent[2]));
    return index::encodeChunk<Sample>(none, extent);
}

/// All chunks of an index of such samples.
template <class Sample>
Status addBlankSamples(const GridDims& dims, index::IndexWriter& writer) {
    const index::ChunkGrid chunks(dims);
    for (const index::ChunkIndex chunk : firstIds<index::ChunkIndex>(chunks.chunkCount()))
        ISO_TRY(writer.addChunk(blankSamples<Sample>(chunks.extent(chunk))));
    return writer.endChunks();
}

} // namespace isoslider::test
