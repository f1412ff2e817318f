#pragma once

#include <vector>

#include "core/grid/normal_codec.h"
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

/// A chunk of an index of edges whose points have no normals.
inline std::vector<std::byte> blankNormals(const index::ChunkExtent& extent) {
    const std::vector<NormalCode> none(static_cast<std::size_t>(extent[0] * extent[1] * extent[2]), kNoNormal);
    return index::encodeChunk<NormalCode>(none, extent);
}

/// All chunks of such an index.
inline Status addBlankNormals(const GridDims& dims, index::IndexWriter& writer) {
    const index::ChunkGrid chunks(dims);
    for (const index::ChunkIndex chunk : firstIds<index::ChunkIndex>(chunks.chunkCount()))
        ISO_TRY(writer.addChunk(blankNormals(chunks.extent(chunk))));
    return writer.endChunks();
}

} // namespace isoslider::test
