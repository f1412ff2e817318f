#include "core/index/validation/normal_checks.h"

#include <algorithm>
#include <string>

#include "core/grid/point_normals.h"
#include "core/index/validation/chunk_layers.h"

namespace isoslider::index {
namespace {

template <class Sample>
Status compareNormalsAs(const IndexReader& reader, const ComparedVolume& volume, FaultList& faults,
                        const JobControl& job) {
    const SampleStore store(reader);
    const GridDims& dims = reader.info().geometry.dims;
    const glm::vec3 inverseSpacing = inverseSpacingOf(reader.info().geometry);
    const auto plane = static_cast<std::size_t>(dims[0] * dims[1]);
    std::vector<Sample> planes; // of a layer, and one on either side
    std::int64_t begin = 0, end = 0;
    for (std::int64_t layer = 0; layer < store.chunks().chunks()[2]; ++layer) {
        if (job.isStopRequested())
            return cancelledError();
        const std::int64_t z0 = layer * kChunkSide;
        job.report(static_cast<double>(z0) / static_cast<double>(dims[2]), "comparing normals");
        const std::int64_t nextBegin = std::max<std::int64_t>(0, z0 - 1),
                           nextEnd = std::min<std::int64_t>(dims[2], z0 + kChunkSide + 1);
        planes.erase(planes.begin(), planes.begin() + static_cast<std::ptrdiff_t>(plane) * (nextBegin - begin));
        begin = nextBegin;
        if (end < nextEnd) {
            planes.resize(plane * static_cast<std::size_t>(nextEnd - begin));
            ISO_TRY(volume.read(
                end, nextEnd,
                std::as_writable_bytes(std::span(planes).subspan(plane * static_cast<std::size_t>(end - begin)))));
            end = nextEnd;
        }
        const SampleView<Sample> view{planes.data(), {dims[0], dims[1], end - begin}};
        ISO_TRY(forEachChunkOfLayer<NormalCode>(
            store, layer, [&](ChunkIndex chunk, const std::vector<NormalCode>& stored, const Status& read) {
                if (!read.isOk())
                    return; // reported with the checksums
                const auto at = store.chunks().chunkCoords(chunk);
                const ChunkExtent extent = store.chunks().extent(chunk);
                bool isEqual = true;
                std::array<NormalCode, kChunkSide> row;
                for (int z = 0; z < extent[2] && isEqual; ++z)
                    for (int y = 0; y < extent[1] && isEqual; ++y) {
                        findNormals(view, {kChunkSide * at[0], kChunkSide * at[1] + y, z0 + z - begin},
                                    {extent[0], 1, 1}, inverseSpacing, row.data());
                        isEqual = std::equal(row.begin(), row.begin() + extent[0],
                                             stored.begin() + kChunkSide * (y + kChunkSide * z));
                    }
                if (isEqual)
                    return;
                IndexFault fault;
                fault.part = "chunk " + std::to_string(chunk.number());
                fault.problem = "has other normals than the volume";
                fault.box = faults.boxOfChunks(chunk.number(), chunk.number());
                faults.add(std::move(fault));
            }));
    }
    return {};
}

} // namespace

Status compareNormals(const IndexReader& reader, const ComparedVolume& volume, FaultList& faults,
                      const JobControl& job) {
    return visitScalarType(reader.info().type, [&](auto sample) {
        return compareNormalsAs<decltype(sample)>(reader, volume, faults, job);
    });
}

} // namespace isoslider::index
