#include <algorithm>
#include <atomic>
#include <cstring>
#include <string>

#include "core/index/sample_store.h"
#include "core/index/validation/chunk_layers.h"
#include "core/index/validation/sample_survey.h"

namespace isoslider::index {
namespace {

template <class Sample>
Status readPlanes(const IndexReader& reader, const SampleStore& store, std::atomic<bool>& hasFailed,
                  std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
    const GridDims& dims = reader.info().geometry.dims;
    for (std::int64_t layer = zBegin / kChunkSide; layer * kChunkSide < zEnd; ++layer)
        ISO_TRY(forEachChunkOfLayer<Sample>(
            store, layer, [&](ChunkIndex chunk, const std::vector<Sample>& samples, const Status& read) {
                if (!read.isOk())
                    hasFailed = true;
                const auto at = store.chunks().chunkCoords(chunk);
                const ChunkExtent extent = store.chunks().extent(chunk);
                for (int z = 0; z < extent[2]; ++z) {
                    const std::int64_t plane = layer * kChunkSide + z;
                    if (plane < zBegin || plane >= zEnd)
                        continue;
                    for (int y = 0; y < extent[1]; ++y) {
                        const std::int64_t row = dims[1] * (plane - zBegin) + kChunkSide * at[1] + y;
                        const auto place = static_cast<std::size_t>(dims[0] * row + kChunkSide * at[0]);
                        const auto bytes = static_cast<std::size_t>(extent[0]) * sizeof(Sample);
                        std::byte* to = out.data() + place * sizeof(Sample);
                        if (read.isOk())
                            std::memcpy(to, samples.data() + kChunkSide * (y + kChunkSide * z), bytes);
                        else
                            std::memset(to, 0, bytes);
                    }
                }
            }));
    return {};
}

template <class Sample>
Status compareAs(const IndexReader& reader, const ComparedVolume& volume, FaultList& faults, const JobControl& job) {
    const SampleStore store(reader);
    const GridDims& dims = reader.info().geometry.dims;
    const auto plane = static_cast<std::size_t>(dims[0] * dims[1]);
    std::vector<Sample> there(plane * static_cast<std::size_t>(std::min<std::int64_t>(dims[2], kChunkSide)));
    for (std::int64_t layer = 0; layer < store.chunks().chunks()[2]; ++layer) {
        if (job.isStopRequested())
            return cancelledError();
        const std::int64_t z0 = layer * kChunkSide, z1 = std::min(dims[2], z0 + kChunkSide);
        job.report(static_cast<double>(z0) / static_cast<double>(dims[2]), "comparing samples");
        ISO_TRY(volume.read(z0, z1,
                            std::as_writable_bytes(std::span(there).first(plane * static_cast<std::size_t>(z1 - z0)))));
        ISO_TRY(forEachChunkOfLayer<Sample>(
            store, layer, [&](ChunkIndex chunk, const std::vector<Sample>& samples, const Status& read) {
                const auto at = store.chunks().chunkCoords(chunk);
                const ChunkExtent extent = store.chunks().extent(chunk);
                bool isEqual = read.isOk();
                for (int z = 0; z < extent[2] && isEqual; ++z)
                    for (int y = 0; y < extent[1] && isEqual; ++y) {
                        const auto row = static_cast<std::size_t>(dims[0] * (dims[1] * z + kChunkSide * at[1] + y) +
                                                                  kChunkSide * at[0]);
                        isEqual = std::memcmp(there.data() + row, samples.data() + kChunkSide * (y + kChunkSide * z),
                                              static_cast<std::size_t>(extent[0]) * sizeof(Sample)) == 0;
                    }
                if (isEqual || !read.isOk()) // reported with the checksums
                    return;
                IndexFault fault;
                fault.part = "chunk " + std::to_string(chunk.number());
                fault.problem = "has other samples than the volume";
                fault.box = faults.boxOfChunks(chunk.number(), chunk.number());
                faults.add(std::move(fault));
            }));
    }
    return {};
}

} // namespace

ComparedVolume storedPlanes(const IndexReader& reader, const SampleStore& store, std::atomic<bool>& hasFailed) {
    ComparedVolume planes;
    planes.geometry = reader.info().geometry;
    planes.type = reader.info().type;
    planes.read = [&](std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
        return visitScalarType(reader.info().type, [&](auto sample) {
            return readPlanes<decltype(sample)>(reader, store, hasFailed, zBegin, zEnd, out);
        });
    };
    return planes;
}

Status compareSamples(const IndexReader& reader, const ComparedVolume& volume, FaultList& faults,
                      const JobControl& job) {
    return visitScalarType(reader.info().type,
                           [&](auto sample) { return compareAs<decltype(sample)>(reader, volume, faults, job); });
}

} // namespace isoslider::index
