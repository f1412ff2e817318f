#include "preprocess/external_sort.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace isoslider::preprocess {
namespace {

constexpr std::size_t kMaxPartitions = 1024;
constexpr std::size_t kPartitionsPerBatch = 4; // sorted side by side
constexpr std::size_t kStreamRecords = 1u << 16;

} // namespace

template <class Key>
ExternalSort<Key>::ExternalSort(const std::vector<std::uint64_t>& countsByPrefix, int keyShift, std::uint64_t memoryBytes,
                                std::filesystem::path spillPath, FileSystem& fileSystem)
    : keyShift_(keyShift), memoryBytes_(memoryBytes), spillPath_(std::move(spillPath)), fileSystem_(fileSystem) {
    std::uint64_t total = 0;
    for (const std::uint64_t count : countsByPrefix)
        total += count;
    // A batch of partitions is held twice while it is sorted.
    const std::uint64_t byMemory = memoryBytes / (2 * kPartitionsPerBatch * 2 * sizeof(Record));
    const std::uint64_t target = std::max<std::uint64_t>({1, total / kMaxPartitions + 1, std::min<std::uint64_t>(byMemory, 1u << 18)});
    partitionOfPrefix_.resize(countsByPrefix.size());
    std::uint64_t inPartition = 0;
    std::uint64_t prefixesIn = 0;
    for (std::size_t prefix = 0; prefix < countsByPrefix.size(); ++prefix) {
        const std::uint64_t count = countsByPrefix[prefix];
        if (partitions_.empty() || (count > 0 && inPartition > 0 && inPartition + count > target)) {
            if (!partitions_.empty())
                partitions_.back().hasOneKey = keyShift == 0 && prefixesIn == 1;
            partitions_.emplace_back();
            inPartition = 0;
            prefixesIn = 0;
        }
        inPartition += count;
        prefixesIn += count > 0;
        partitionOfPrefix_[prefix] = static_cast<std::uint32_t>(partitions_.size() - 1);
    }
    partitions_.back().hasOneKey = keyShift == 0 && prefixesIn == 1;
}

template <class Key>
ExternalSort<Key>::~ExternalSort() {
    if (!spillOut_)
        return;
    (void)spillOut_->close();
    spillIn_.reset();
    (void)fileSystem_.removeFile(spillPath_);
}

template <class Key>
Status ExternalSort<Key>::add(std::span<const Record> records) {
    for (const Record& record : records) {
        Partition& partition = partitions_[partitionOfPrefix_[static_cast<std::size_t>(std::uint64_t{record.key} >> keyShift_)]];
        if (partition.buffer.size() == partition.buffer.capacity()) {
            const std::size_t grown = std::max<std::size_t>(64, partition.buffer.capacity() * 3 / 2);
            bufferedBytes_ += (grown - partition.buffer.capacity()) * sizeof(Record);
            partition.buffer.reserve(grown);
        }
        partition.buffer.push_back(record);
        ++partition.records;
    }
    recordCount_ += records.size();
    return bufferedBytes_ > memoryBytes_ ? spill() : Status{};
}

template <class Key>
Status ExternalSort<Key>::spill() {
    if (!spillOut_) {
        auto file = fileSystem_.create(spillPath_);
        if (!file.isOk())
            return std::move(file).error();
        spillOut_ = std::move(file).value();
    }
    for (Partition& partition : partitions_) {
        if (!partition.buffer.empty()) {
            partition.runs.push_back({spillOut_->sizeBytes(), partition.buffer.size()});
            ISO_TRY(spillOut_->writeAll(std::as_bytes(std::span(partition.buffer))));
            spilledBytes_ += partition.buffer.size() * sizeof(Record);
        }
        std::vector<Record>().swap(partition.buffer);
    }
    bufferedBytes_ = 0;
    return {};
}

template <class Key>
Status ExternalSort<Key>::readRun(const SpilledRun& run, std::uint64_t first, std::span<Record> out) {
    return spillIn_->readExactlyAt(run.offset + first * sizeof(Record), std::as_writable_bytes(out));
}

template <class Key>
Status ExternalSort<Key>::load(Partition& partition, std::vector<Record>& out) {
    out.resize(partition.records);
    std::size_t at = 0;
    for (const SpilledRun& run : partition.runs) {
        ISO_TRY(readRun(run, 0, std::span(out).subspan(at, run.records)));
        at += run.records;
    }
    std::copy(partition.buffer.begin(), partition.buffer.end(), out.begin() + static_cast<std::ptrdiff_t>(at));
    std::vector<Record>().swap(partition.buffer);
    return {};
}

template <class Key>
Status ExternalSort<Key>::streamOneKey(Partition& partition, const std::function<Status(std::span<const Record>)>& consume) {
    std::vector<Record> chunk;
    for (const SpilledRun& run : partition.runs)
        for (std::uint64_t first = 0; first < run.records; first += kStreamRecords) {
            chunk.resize(std::min<std::uint64_t>(kStreamRecords, run.records - first));
            ISO_TRY(readRun(run, first, chunk));
            ISO_TRY(consume(chunk));
        }
    ISO_TRY(consume(partition.buffer));
    std::vector<Record>().swap(partition.buffer);
    return {};
}

namespace {

// Stable by key: positions break ties, and records came in id order.
template <class Record>
void sortByKey(std::vector<Record>& records, std::vector<Record>& scratch) {
    struct Entry {
        decltype(Record::key) key;
        std::uint32_t position;
    };
    std::vector<Entry> entries(records.size());
    for (std::size_t i = 0; i < records.size(); ++i)
        entries[i] = {records[i].key, static_cast<std::uint32_t>(i)};
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return a.key != b.key ? a.key < b.key : a.position < b.position;
    });
    scratch.resize(records.size());
    for (std::size_t i = 0; i < records.size(); ++i)
        scratch[i] = records[entries[i].position];
    records.swap(scratch);
}

} // namespace

template <class Key>
Status ExternalSort<Key>::drain(const std::function<Status(std::span<const Record>)>& consume, const JobControl& job) {
    if (spillOut_) {
        // The rest goes to disk too: drained partitions must fit beside nothing else.
        ISO_TRY(spill());
        auto file = fileSystem_.openForReading(spillPath_);
        if (!file.isOk())
            return std::move(file).error();
        spillIn_ = std::move(file).value();
    }
    std::uint64_t done = 0;
    std::vector<std::vector<Record>> batch(kPartitionsPerBatch), scratch(kPartitionsPerBatch);
    for (std::size_t next = 0; next < partitions_.size();) {
        if (job.isStopRequested())
            return cancelledError();
        job.report(recordCount_ ? static_cast<double>(done) / static_cast<double>(recordCount_) : 1.0, "sorting and writing blocks");
        if (partitions_[next].hasOneKey) {
            done += partitions_[next].records;
            ISO_TRY(streamOneKey(partitions_[next++], consume));
            continue;
        }
        std::size_t count = 0;
        while (count < kPartitionsPerBatch && next + count < partitions_.size() && !partitions_[next + count].hasOneKey) {
            ISO_TRY(load(partitions_[next + count], batch[count]));
            ++count;
        }
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { sortByKey(batch[i], scratch[i]); });
        for (std::size_t i = 0; i < count; ++i) {
            ISO_TRY(consume(batch[i]));
            done += batch[i].size();
        }
        next += count;
    }
    return {};
}

template class ExternalSort<std::uint16_t>;
template class ExternalSort<std::uint32_t>;
template class ExternalSort<std::uint64_t>;

} // namespace isoslider::preprocess
