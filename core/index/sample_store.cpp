#include "core/index/sample_store.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/index/index_places.h"

namespace isoslider::index {

SampleStore::SampleStore(const IndexReader& reader) : reader_(reader), chunks_(reader.info().geometry.dims) {
    ISO_CHECK(hasSampleChunks(reader.info()));
    groups_ = std::make_unique<std::atomic<const ChunkGroup*>[]>(reader.meta().chunkGroups.size());
}

SampleStore::~SampleStore() {
    for (std::size_t i = 0; i < reader_.meta().chunkGroups.size(); ++i)
        delete groups_[i].load(std::memory_order_relaxed);
}

Result<const SampleStore::ChunkGroup*> SampleStore::group(std::uint64_t number, std::uint64_t& bytesRead) const {
    if (const ChunkGroup* there = groups_[number].load(std::memory_order_acquire))
        return there;
    const std::lock_guard lock(mutex_);
    if (const ChunkGroup* there = groups_[number].load(std::memory_order_relaxed))
        return there;
    const ChunkGroupEntry& entry = reader_.meta().chunkGroups[number];
    const std::size_t count = chunksInGroup(chunks_, number);
    const std::uint64_t tableAt = entry.offset + entry.chunkBytes;
    std::vector<std::byte> bytes;
    if (Status read = reader_.readPart(tableAt, count * kGroupEntryBytes, entry.checksum, bytes); !read.isOk())
        return inChunkGroup(reader_, number, std::move(read).error());
    bytesRead += bytes.size();
    auto group = std::make_unique<ChunkGroup>();
    group->places.resize(count);
    if (!getChunkPlaces(bytes, entry.offset, tableAt, group->places))
        return inChunkGroup(reader_, number,
                            makeError(ErrorCode::Corruption, "index page disagrees with the bytes of its chunks",
                                      reader_.pathString(), tableAt));
    const ChunkGroup* kept = group.release();
    groups_[number].store(kept, std::memory_order_release);
    return kept;
}

Result<ChunkPlace> SampleStore::find(ChunkIndex chunk, std::uint64_t& bytesRead) const {
    const auto found = group(chunk.number() / kGroupChunks, bytesRead);
    if (!found.isOk())
        return found.error();
    return found.value()->places[chunk.number() % kGroupChunks];
}

template <class Sample>
Status SampleStore::read(ChunkIndex chunk, std::span<Sample, kChunkSamples> out, std::uint64_t& bytesRead) const {
    const auto place = find(chunk, bytesRead);
    if (!place.isOk())
        return place.error();
    thread_local std::vector<std::byte> bytes;
    if (Status read = reader_.readPart(place.value().offset, place.value().bytes, place.value().checksum, bytes);
        !read.isOk())
        return inChunk(reader_, chunk, std::move(read).error());
    bytesRead += bytes.size();
    const ChunkExtent extent = chunks_.extent(chunk);
    const std::size_t samples =
        static_cast<std::size_t>(extent[0]) * static_cast<std::size_t>(extent[1]) * static_cast<std::size_t>(extent[2]);
    const bool isWhole = samples == kChunkSamples;
    thread_local std::vector<Sample> packed;
    packed.resize(isWhole ? 0 : samples);
    if (!decodeChunk<Sample>(bytes, extent, isWhole ? std::span<Sample>(out) : std::span<Sample>(packed)))
        return inChunk(reader_, chunk,
                       makeError(ErrorCode::Corruption, "index page is damaged: its values cannot be decoded",
                                 reader_.pathString(), place.value().offset));
    if (isWhole)
        return {};
    const Sample* row = packed.data();
    for (int z = 0; z < extent[2]; ++z)
        for (int y = 0; y < extent[1]; ++y, row += extent[0])
            std::copy_n(row, extent[0], out.data() + kChunkSide * (y + kChunkSide * z));
    return {};
}

void SampleStore::willNeed(std::span<const ChunkIndex> chunks, std::uint64_t& bytesRead, std::stop_token stop) const {
    // Neighbours on disk are asked for together; a gap of a few pages is cheaper than another request.
    constexpr std::uint64_t kGapBytes = 1u << 15;
    std::uint64_t begin = 0, end = 0;
    for (const ChunkIndex chunk : chunks) {
        if (stop.stop_requested())
            return;
        const auto place = find(chunk, bytesRead);
        if (!place.isOk())
            return; // reading will state what is wrong
        const std::uint64_t offset = place.value().offset;
        if (end == 0 || offset < begin || offset > end + kGapBytes) {
            if (end > begin)
                reader_.willNeed(begin, end - begin);
            begin = offset;
        }
        end = offset + place.value().bytes;
    }
    if (end > begin)
        reader_.willNeed(begin, end - begin);
}

namespace {

// Those of all chunks, as points of the grid.
template <class Sample>
Result<std::vector<Sample>> readAll(const IndexReader& reader, const JobControl& job) {
    const SampleStore store(reader);
    const GridDims& dims = reader.info().geometry.dims;
    std::vector<Sample> samples(static_cast<std::size_t>(pointCount(dims)));
    std::vector<Sample> chunk(SampleStore::kChunkSamples);
    std::uint64_t bytesRead = 0;
    const std::uint64_t count = store.chunks().chunkCount();
    for (const ChunkIndex index : firstIds<ChunkIndex>(count)) {
        if (job.isStopRequested())
            return cancelledError();
        ISO_TRY(store.read<Sample>(index, std::span<Sample, SampleStore::kChunkSamples>(chunk), bytesRead));
        const auto at = store.chunks().chunkCoords(index);
        const ChunkExtent extent = store.chunks().extent(index);
        for (int z = 0; z < extent[2]; ++z)
            for (int y = 0; y < extent[1]; ++y)
                std::copy_n(chunk.data() + kChunkSide * (y + kChunkSide * z), extent[0],
                            samples.data() + kChunkSide * at[0] +
                                dims[0] * (kChunkSide * at[1] + y + dims[1] * (kChunkSide * at[2] + z)));
        if (index.number() % 64 == 0)
            job.report(static_cast<double>(index.number()) / static_cast<double>(count), "reading samples");
    }
    return samples;
}

} // namespace

Result<std::shared_ptr<const ScalarGrid>> readSamples(const IndexReader& reader, const JobControl& job) {
    return visitScalarType(reader.info().type, [&](auto sample) -> Result<std::shared_ptr<const ScalarGrid>> {
        const auto samples = readAll<decltype(sample)>(reader, job);
        if (!samples.isOk())
            return samples.error();
        return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<decltype(sample)>(
            reader.info().geometry, reader.info().type, std::span<const decltype(sample)>(samples.value())));
    });
}

#define ISO_INSTANTIATE(Sample, Name) \
    template Status SampleStore::read(ChunkIndex, std::span<Sample, kChunkSamples>, std::uint64_t&) const;
ISO_FOR_EACH_SAMPLE_TYPE(ISO_INSTANTIATE)
#undef ISO_INSTANTIATE

} // namespace isoslider::index
