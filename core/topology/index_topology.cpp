#include "core/topology/index_topology.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/index/sample_store.h"
#include "core/topology/stored_topology.h"

namespace isoslider::topology {
namespace {

// Reads a layer of chunks at a time, on all threads, and keeps it for the planes that follow.
template <class Sample>
class ChunkPlanes {
public:
    explicit ChunkPlanes(const index::IndexReader& reader) : store_(reader), dims_(reader.info().geometry.dims) {}

    Status read(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
        const std::int64_t plane = dims_[0] * dims_[1];
        auto* to = reinterpret_cast<Sample*>(out.data());
        for (std::int64_t z = zBegin; z < zEnd; ++z, to += plane) {
            const std::int64_t layer = z / index::kChunkSide;
            if (layer != layer_)
                ISO_TRY(decode(layer));
            std::copy_n(samples_.data() + plane * (z - layer * index::kChunkSide), plane, to);
        }
        return {};
    }

private:
    Status decode(std::int64_t layer) {
        const std::int64_t plane = dims_[0] * dims_[1];
        samples_.resize(static_cast<std::size_t>(plane * index::kChunkSide));
        layer_ = -1;
        const GridDims& chunks = store_.chunks().chunks();
        std::vector<Status> rows(static_cast<std::size_t>(chunks[1]));
        tbb::parallel_for(std::int64_t{0}, chunks[1], [&](std::int64_t cy) {
            Status& status = rows[static_cast<std::size_t>(cy)];
            std::vector<Sample> chunk(index::SampleStore::kChunkSamples);
            std::uint64_t bytesRead = 0;
            for (std::int64_t cx = 0; cx < chunks[0] && status.isOk(); ++cx) {
                const index::ChunkIndex at = store_.chunks().chunkAt(cx, cy, layer);
                status = store_.template read<Sample>(at, std::span<Sample, index::SampleStore::kChunkSamples>(chunk),
                                                      bytesRead);
                if (!status.isOk())
                    return;
                const index::ChunkExtent extent = store_.chunks().extent(at);
                for (int z = 0; z < extent[2]; ++z)
                    for (int y = 0; y < extent[1]; ++y)
                        std::copy_n(chunk.data() + index::kChunkSide * (y + index::kChunkSide * z), extent[0],
                                    samples_.data() + index::kChunkSide * cx + dims_[0] * (index::kChunkSide * cy + y) +
                                        plane * z);
            }
        });
        for (Status& status : rows)
            ISO_TRY(status);
        layer_ = layer;
        return {};
    }

    index::SampleStore store_;
    GridDims dims_;
    std::int64_t layer_ = -1;
    std::vector<Sample> samples_;
};

} // namespace

std::filesystem::path scratchPathOf(const std::filesystem::path& index) {
    std::filesystem::path path = index;
    path += ".topology.partial";
    return path;
}

PlaneSource planesOf(const index::IndexReader& reader) {
    PlaneSource source{reader.info().geometry, reader.info().type, {}};
    const GridDims& dims = source.geometry.dims;
    source.heldBytes =
        static_cast<std::uint64_t>(dims[0] * dims[1] * std::min<std::int64_t>(dims[2], index::kChunkSide)) *
        scalarTypeSizeBytes(source.type);
    visitScalarType(source.type, [&](auto sample) {
        source.read = [planes = std::make_shared<ChunkPlanes<decltype(sample)>>(reader)](
                          std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) {
            return planes->read(zBegin, zEnd, out);
        };
    });
    return source;
}

Result<TopologyCurve> analyseIndex(const index::IndexReader& reader, AnalysisOptions options, const JobControl& job) {
    auto plan = planMeasures(planesOf(reader), reader.info().min, reader.info().max, job);
    if (!plan.isOk())
        return std::move(plan).error();
    options.measures = std::move(plan).value();
    if (options.scratch.empty())
        options.scratch = scratchPathOf(reader.pathString());
    return analyseTopology(planesOf(reader), options, job);
}

namespace {

Result<IndexTopology> analyseAndStore(const std::filesystem::path& index, const AnalysisOptions& options, bool replaces,
                                      const JobControl& job) {
    const auto reader = index::IndexReader::open(index);
    if (!reader.isOk())
        return reader.error();
    auto curve = analyseIndex(*reader.value(), options, job);
    if (!curve.isOk())
        return std::move(curve).error();
    const auto analysed = std::make_shared<TopologyCurve>(std::move(curve).value());
    IndexTopology found{analysed, {}, true};
    found.storing = storeTopology(*reader.value(), *analysed, replaces);
    // Read from the disk from now on: what was analysed need not stay in memory.
    if (found.storing.isOk())
        if (auto again = openTopology(index); again.isOk() && again.value())
            found.summary = std::move(again).value();
    return found;
}

} // namespace

Result<IndexTopology> topologyOfIndex(const std::filesystem::path& index, const AnalysisOptions& options,
                                      const JobControl& job) {
    auto stored = openTopology(index);
    bool isDamaged = !stored.isOk() && stored.error().code == ErrorCode::Corruption;
    if (!stored.isOk() && !isDamaged)
        return std::move(stored).error();
    if (stored.isOk() && stored.value()) {
        // Every page is looked at once: a damaged one is made again.
        const Status status = stored.value()->visitEvents([&](const TopologyEvent&) { return !job.isStopRequested(); });
        isDamaged = !status.isOk() && status.error().code == ErrorCode::Corruption;
        if (!isDamaged) {
            ISO_TRY(status);
            return IndexTopology{std::move(stored).value(), {}, false};
        }
    }
    return analyseAndStore(index, options, isDamaged, job);
}

Result<IndexTopology> addEvents(const std::filesystem::path& index, AnalysisOptions options, const JobControl& job) {
    options.mayLackEvents = false;
    return analyseAndStore(index, options, true, job);
}

} // namespace isoslider::topology
