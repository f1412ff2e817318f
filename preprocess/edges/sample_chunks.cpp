#include "preprocess/edges/sample_chunks.h"

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
std::vector<std::byte> encodeSamples(const SampleView<Sample>& view, const std::array<std::int64_t, 3>& begin,
                                     const index::ChunkExtent& extent) {
    thread_local std::vector<Sample> samples;
    samples.clear();
    for (int z = 0; z < extent[2]; ++z)
        for (int y = 0; y < extent[1]; ++y) {
            const Sample* row = view.samples + view.offset(begin[0], begin[1] + y, begin[2] + z);
            samples.insert(samples.end(), row, row + extent[0]);
        }
    return index::encodeChunk<Sample>(samples, extent);
}

template <class Sample>
Status writeSamples(io::VolumeSource& source, index::IndexWriter& writer, std::int64_t firstSlab, const JobControl& job,
                    const std::function<Status(std::int64_t next)>& betweenSlabs) {
    const GridDims& dims = source.info().geometry.dims;
    const index::ChunkGrid chunks(dims);
    SlabWindow<Sample> window(source, kSlabPlanes);
    const std::int64_t slabs = chunks.chunks()[2], inSlab = chunks.chunks()[0] * chunks.chunks()[1];
    std::vector<std::vector<std::byte>> encoded(static_cast<std::size_t>(std::min(inSlab, kChunksAtOnce)));
    for (std::int64_t slab = firstSlab; slab < slabs; ++slab) {
        if (job.isStopRequested())
            return cancelledError();
        if (slab > firstSlab)
            ISO_TRY(betweenSlabs(slab));
        job.report(static_cast<double>(slab) / static_cast<double>(slabs), "storing samples");
        const std::int64_t z0 = slab * index::kChunkSide, z1 = std::min(dims[2], z0 + index::kChunkSide);
        ISO_TRY(window.advance(z0, z1));
        const SampleView<Sample> view{window.plane(z0), {dims[0], dims[1], z1 - z0}};
        for (std::int64_t first = 0; first < inSlab; first += kChunksAtOnce) {
            const std::int64_t count = std::min(kChunksAtOnce, inSlab - first);
            tbb::parallel_for(std::int64_t{0}, count, [&](std::int64_t i) {
                const index::ChunkIndex chunk(slab * inSlab + first + i);
                const auto c = chunks.chunkCoords(chunk);
                encoded[static_cast<std::size_t>(i)] = encodeSamples<Sample>(
                    view, {c[0] * index::kChunkSide, c[1] * index::kChunkSide, 0}, chunks.extent(chunk));
            });
            for (std::int64_t i = 0; i < count; ++i)
                ISO_TRY(writer.addChunk(encoded[static_cast<std::size_t>(i)]));
        }
    }
    return writer.endChunks();
}

#define ISO_INSTANTIATE(Sample, Name) \
    template std::vector<std::byte> encodeSamples<Sample>( \
        const SampleView<Sample>&, const std::array<std::int64_t, 3>&, const index::ChunkExtent&); \
    template Status writeSamples<Sample>(io::VolumeSource&, index::IndexWriter&, std::int64_t, const JobControl&, \
                                         const std::function<Status(std::int64_t)>&);
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::preprocess
