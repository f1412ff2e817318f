#include "core/index/index_distribution.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <optional>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "core/index/sample_store.h"

namespace isoslider::index {
namespace {

template <class Sample>
class SomeChunks {
public:
    using Take = std::function<void(std::span<const Sample>)>;

    SomeChunks(const IndexReader& reader, std::uint64_t mostSamples, const JobControl& job)
        : store_(reader), job_(job) {
        const std::uint64_t chunks = store_.chunks().chunkCount();
        const std::uint64_t wanted =
            std::clamp<std::uint64_t>(mostSamples / SampleStore::kChunkSamples, 1, std::max<std::uint64_t>(chunks, 1));
        const std::uint64_t samples = static_cast<std::uint64_t>(pointCount(reader.info().geometry.dims));
        stride_ = samples <= mostSamples ? 1 : (chunks + wanted - 1) / wanted;
        count_ = (chunks + stride_ - 1) / stride_;
    }

    bool isAll() const { return stride_ == 1; }

    Status visit(const Take& take) const {
        std::mutex mutex;
        std::optional<Error> failure;
        std::atomic<bool> stops{false};
        tbb::enumerable_thread_specific<std::vector<Sample>> buffers(SampleStore::kChunkSamples);
        tbb::parallel_for(std::uint64_t{0}, count_, [&](std::uint64_t number) {
            if (stops.load(std::memory_order_relaxed) || job_.isStopRequested())
                return;
            auto status = visitChunk(number, buffers.local(), take);
            if (status.isOk())
                return;
            stops = true;
            const std::lock_guard lock(mutex);
            failure = std::move(status).error();
        });
        if (failure)
            return *failure;
        return job_.isStopRequested() ? Status(cancelledError()) : Status();
    }

private:
    Status visitChunk(std::uint64_t number, std::vector<Sample>& buffer, const Take& take) const {
        // Not at the same place of each row of chunks, whatever the stride.
        const std::uint64_t chunk = number * stride_ + number * 2654435761u % stride_;
        const ChunkIndex at(std::min(chunk, store_.chunks().chunkCount() - 1));
        std::uint64_t bytesRead = 0;
        ISO_TRY(store_.template read<Sample>(
            at, std::span<Sample, SampleStore::kChunkSamples>(buffer.data(), SampleStore::kChunkSamples), bytesRead));
        const ChunkExtent extent = store_.chunks().extent(at);
        for (int z = 0; z < extent[2]; ++z) {
            const Sample* plane = buffer.data() + kChunkSide * kChunkSide * z;
            if (extent[0] == kChunkSide) {
                take({plane, static_cast<std::size_t>(kChunkSide * extent[1])});
                continue;
            }
            for (int y = 0; y < extent[1]; ++y)
                take({plane + kChunkSide * y, static_cast<std::size_t>(extent[0])});
        }
        return {};
    }

    SampleStore store_;
    const JobControl& job_;
    std::uint64_t stride_ = 1;
    std::uint64_t count_ = 0;
};

template <class Sample>
Result<ValueDistribution> distributionAs(const IndexReader& reader, std::uint64_t mostSamples, const JobControl& job) {
    const SomeChunks<Sample> chunks(reader, mostSamples, job);
    const IndexInfo& info = reader.info();
    const SampleSpans<Sample> spans = [&chunks](const typename SomeChunks<Sample>::Take& take) {
        return chunks.visit(take);
    };
    auto found = isoslider::distributionOf<Sample>(spans, info.min, info.max, job);
    if (!found.isOk() || chunks.isAll())
        return found;
    ValueDistribution some = std::move(found).value();
    if (some.isEmpty()) // only missing samples were met
        return isoslider::distributionOf(info.histogram, info.type);
    some.spread.isExact = false;
    some.isEachValue = some.isEachValue && some.spacing > 0.0; // others may have further values
    const auto finite = static_cast<double>(static_cast<std::uint64_t>(pointCount(info.geometry.dims)) - info.nanCount);
    some.weight = std::max(1.0, finite / static_cast<double>(some.counted()));
    return some;
}

template <class Sample>
Result<ValueSpread> spreadAs(const IndexReader& reader, const JobControl& job) {
    const SomeChunks<Sample> chunks(reader, std::numeric_limits<std::uint64_t>::max(), job);
    tbb::enumerable_thread_specific<SpreadSum> sums;
    ISO_TRY(chunks.visit([&sums](std::span<const Sample> samples) { sums.local().add(samples); }));
    return SpreadSum::spreadOfAll(sums);
}

} // namespace

Result<ValueSpread> spreadOf(const IndexReader& reader, const JobControl& job) {
    const IndexInfo& info = reader.info();
    if (!hasSampleChunks(info))
        return isoslider::distributionOf(info.histogram, info.type).spread;
    return visitScalarType(info.type, [&](auto sample) { return spreadAs<decltype(sample)>(reader, job); });
}

Result<ValueDistribution> distributionOf(const IndexReader& reader, std::uint64_t mostSamples, const JobControl& job) {
    const IndexInfo& info = reader.info();
    if (!hasSampleChunks(info))
        return isoslider::distributionOf(info.histogram, info.type);
    return visitScalarType(info.type,
                           [&](auto sample) { return distributionAs<decltype(sample)>(reader, mostSamples, job); });
}

} // namespace isoslider::index
