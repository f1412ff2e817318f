#include "preprocess/edges/normal_chunks.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "core/grid/scalar_grid.h"
#include "core/index/format/chunk_grid.h"
#include "preprocess/edges/slab_window.h"

namespace isoslider::preprocess {
namespace {

constexpr std::int64_t kChunksAtOnce = 64; // encoded side by side, then written in order

} // namespace

template <class Sample>
std::vector<std::byte> encodeNormals(const SampleView<Sample>& view, const std::array<std::int64_t, 3>& begin,
                                     const index::ChunkExtent& extent, const glm::vec3& inverseSpacing) {
    thread_local std::vector<NormalCode> normals;
    normals.resize(static_cast<std::size_t>(extent[0]) * static_cast<std::size_t>(extent[1]) *
                   static_cast<std::size_t>(extent[2]));
    findNormals(view, begin, extent, inverseSpacing, normals.data());
    return index::encodeChunk<NormalCode>(normals, extent);
}

template <class Sample>
Status writeNormals(io::VolumeSource& source, index::IndexWriter& writer, std::int64_t firstSlab, const JobControl& job,
                    const std::function<Status(std::int64_t next)>& betweenSlabs) {
    const GridGeometry& geometry = source.info().geometry;
    const index::ChunkGrid chunks(geometry.dims);
    const glm::vec3 inverseSpacing = inverseSpacingOf(geometry);
    SlabWindow<Sample> window(source, kNormalPlanes);
    const std::int64_t slabs = chunks.chunks()[2], inSlab = chunks.chunks()[0] * chunks.chunks()[1];
    std::vector<std::vector<std::byte>> encoded(static_cast<std::size_t>(std::min(inSlab, kChunksAtOnce)));
    for (std::int64_t slab = firstSlab; slab < slabs; ++slab) {
        if (job.isStopRequested())
            return cancelledError();
        if (slab > firstSlab)
            ISO_TRY(betweenSlabs(slab));
        job.report(static_cast<double>(slab) / static_cast<double>(slabs), "storing normals");
        const std::int64_t z0 = slab * index::kChunkSide, z1 = std::min(geometry.dims[2], z0 + index::kChunkSide);
        ISO_TRY(window.advance(std::max<std::int64_t>(0, z0 - 1), std::min(geometry.dims[2], z1 + 1)));
        const SampleView<Sample> view{window.plane(window.begin()),
                                      {geometry.dims[0], geometry.dims[1], window.end() - window.begin()}};
        for (std::int64_t first = 0; first < inSlab; first += kChunksAtOnce) {
            const std::int64_t count = std::min(kChunksAtOnce, inSlab - first);
            tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t i) {
                const index::ChunkIndex chunk(slab * inSlab + first + i);
                const auto c = chunks.chunkCoords(chunk);
                encoded[static_cast<std::size_t>(i)] = encodeNormals<Sample>(
                    view, {c[0] * index::kChunkSide, c[1] * index::kChunkSide, z0 - window.begin()},
                    chunks.extent(chunk), inverseSpacing);
            });
            for (std::int64_t i = 0; i < count; ++i)
                ISO_TRY(writer.addChunk(encoded[static_cast<std::size_t>(i)]));
        }
    }
    return writer.endChunks();
}

#define ISO_INSTANTIATE(Sample, Name) \
    template std::vector<std::byte> encodeNormals<Sample>( \
        const SampleView<Sample>&, const std::array<std::int64_t, 3>&, const index::ChunkExtent&, const glm::vec3&); \
    template Status writeNormals<Sample>(io::VolumeSource&, index::IndexWriter&, std::int64_t, const JobControl&, \
                                         const std::function<Status(std::int64_t)>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
