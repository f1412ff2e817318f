#include "preprocess/levels/external_sort.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "preprocess/levels/radix_sort.h"

namespace isoslider::preprocess {
namespace {

constexpr std::uint64_t kMaxPartitions = 1024;
constexpr std::size_t kPartitionsPerBatch = 4; // sorted side by side
constexpr std::uint64_t kMaxPartitionRecords = 1u << 18;
constexpr std::uint64_t kLeastRecordsAtOnce = 4096; // however small the budget
constexpr std::size_t kStreamRecords = 1u << 14;

} // namespace

template <class Key>
ExternalSort<Key>::ExternalSort(const std::vector<KeyCount>& counts, std::uint64_t memoryBytes,
                                std::filesystem::path spillPath, FileSystem& fileSystem)
    : ExternalSort(makePartitions(counts, memoryBytes), memoryBytes, std::move(spillPath), fileSystem) {}

template <class Key>
ExternalSort<Key>::ExternalSort(KeyIntervals intervals, std::uint64_t memoryBytes, std::filesystem::path spillPath,
                                FileSystem& fileSystem)
    : memoryBytes_(memoryBytes),
      // Records are held twice while they are sorted, keys and places besides.
      mostRecordsAtOnce_(std::max(kLeastRecordsAtOnce, memoryBytes / (4 * sizeof(Record)))),
      spillPath_(std::move(spillPath)),
      fileSystem_(fileSystem),
      intervals_(std::move(intervals)),
      partitions_(intervals_.count()) {}

// A key with many records gets a separate partition.
template <class Key>
KeyIntervals ExternalSort<Key>::makePartitions(const std::vector<KeyCount>& counts, std::uint64_t memoryBytes) {
    std::uint64_t total = 0;
    for (const KeyCount& count : counts)
        total += count.points;
    const std::uint64_t byMemory = memoryBytes / (4 * (kPartitionsPerBatch + 1) * sizeof(Record));
    const std::uint64_t target = std::max(total / kMaxPartitions + 1, std::min(byMemory, kMaxPartitionRecords));
    std::vector<std::uint64_t> begins{0};
    std::uint64_t inPartition = 0;
    for (const KeyCount& count : counts) {
        if (count.key > begins.back() && (count.points > target || inPartition + count.points > target)) {
            begins.push_back(count.key);
            inPartition = 0;
        }
        inPartition += count.points;
        if (count.points > target && count.key < std::numeric_limits<Key>::max()) {
            begins.push_back(count.key + 1);
            inPartition = 0;
        }
    }
    return KeyIntervals(std::move(begins));
}

template <class Key>
ExternalSort<Key>::~ExternalSort() {
    if (!spillOut_ || keepsUnfinished_)
        return;
    (void)spillOut_->close();
    spillIn_.reset();
    (void)fileSystem_.removeFile(spillPath_);
}

template <class Key>
Status ExternalSort<Key>::add(std::span<const Record> records) {
    for (const Record& record : records) {
        Partition& partition = partitions_[intervals_.find(record.key)];
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
void ExternalSort<Key>::state(StateArchive& archive) {
    for (Partition& partition : partitions_) {
        archive(partition.runs);
        archive(partition.records);
    }
    archive(spilledBytes_);
    archive(recordCount_);
}

template <class Key>
Status ExternalSort<Key>::suspend(StateArchive& archive) {
    ISO_TRY(spill());
    ISO_TRY(spillOut_->sync());
    std::vector<std::uint64_t> begins;
    for (std::size_t i = 0; i < intervals_.count(); ++i)
        begins.push_back(intervals_.begin(i));
    archive(begins);
    std::uint64_t bytes = spillOut_->sizeBytes();
    archive(bytes);
    state(archive);
    return {};
}

template <class Key>
Result<std::unique_ptr<ExternalSort<Key>>> ExternalSort<Key>::resume(StateArchive& archive, std::uint64_t memoryBytes,
                                                                     std::filesystem::path spillPath,
                                                                     FileSystem& fileSystem) {
    std::vector<std::uint64_t> begins;
    std::uint64_t bytes = 0;
    archive(begins);
    archive(bytes);
    if (archive.hasFailed() || begins.empty())
        return makeError(ErrorCode::Corruption, "the state of an unfinished build is damaged", spillPath.string());
    std::unique_ptr<ExternalSort> sort(
        new ExternalSort(KeyIntervals(std::move(begins)), memoryBytes, std::move(spillPath), fileSystem));
    sort->state(archive);
    auto file = fileSystem.extend(sort->spillPath_, {}, bytes);
    if (!file.isOk())
        return std::move(file).error();
    sort->keepsUnfinished_ = true;
    sort->spillOut_ = std::move(file).value();
    ISO_TRY(sort->spillOut_->cut(bytes));
    return sort;
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
Status ExternalSort<Key>::stream(Partition& partition, const Consume& consume) {
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

template <class Key>
Status ExternalSort<Key>::sortAgain(Partition& partition, const Consume& consume, const JobControl& job) {
    KeyCounter<Key> counter(partition.records);
    ISO_TRY(stream(partition, [&](std::span<const Record> records) -> Status {
        for (const Record& record : records)
            counter.add(record.key);
        return {};
    }));
    std::filesystem::path spillPath = spillPath_;
    spillPath += ".again";
    ExternalSort again(counter.takeCounts(), memoryBytes_, std::move(spillPath), fileSystem_);
    ISO_TRY(stream(partition, [&](std::span<const Record> records) { return again.add(records); }));
    return again.drain(consume, job);
}

template <class Key>
std::size_t ExternalSort<Key>::endOfBatch(std::size_t first) const {
    std::uint64_t records = 0;
    std::size_t end = first;
    while (end < partitions_.size() && end - first < kPartitionsPerBatch && !intervals_.hasOneKey(end) &&
           records + partitions_[end].records <= mostRecordsAtOnce_)
        records += partitions_[end++].records;
    return end;
}

template <class Key>
Status ExternalSort<Key>::sortBatch(std::size_t begin, std::size_t end, const Consume& consume) {
    std::vector<std::vector<Record>> batch(end - begin);
    for (std::size_t i = 0; i < batch.size(); ++i)
        ISO_TRY(load(partitions_[begin + i], batch[i]));
    // Stable: records came in id order.
    tbb::parallel_for(std::size_t{0}, batch.size(),
                      [&](std::size_t i) { sortRecords(batch[i], [](const Record& record) { return record.key; }); });
    for (std::vector<Record>& records : batch) {
        ISO_TRY(consume(records));
        std::vector<Record>().swap(records);
    }
    return {};
}

template <class Key>
Status ExternalSort<Key>::drain(const Consume& consume, const JobControl& job, Place begin, const Between& between) {
    // What is large must be read more than once, and the rest goes to disk with it: drained partitions must fit
    // beside nothing else.
    if (spillOut_ ||
        std::any_of(partitions_.begin(), partitions_.end(), [this](const auto& p) { return isTooLarge(p); })) {
        ISO_TRY(spill());
        auto file = fileSystem_.openForReading(spillPath_);
        if (!file.isOk())
            return std::move(file).error();
        spillIn_ = std::move(file).value();
    }
    std::uint64_t done = begin.records;
    const auto consumeAndCount = [&](std::span<const Record> records) -> Status {
        if (job.isStopRequested())
            return cancelledError();
        done += records.size();
        job.report(static_cast<double>(done) / static_cast<double>(recordCount_), "sorting and writing blocks");
        return consume(records);
    };
    for (std::size_t next = begin.partition; next < partitions_.size();) {
        if (job.isStopRequested())
            return cancelledError();
        if (between && spillOut_)
            ISO_TRY(between({next, done}));
        const std::size_t end = endOfBatch(next);
        if (end == next) {
            Partition& partition = partitions_[next];
            JobControl silent;
            silent.stop = job.stop;
            ISO_TRY(intervals_.hasOneKey(next) ? stream(partition, consumeAndCount)
                                               : sortAgain(partition, consumeAndCount, silent));
            ++next;
            continue;
        }
        ISO_TRY(sortBatch(next, end, consumeAndCount));
        next = end;
    }
    return {};
}

template class ExternalSort<std::uint16_t>;
template class ExternalSort<std::uint32_t>;
template class ExternalSort<std::uint64_t>;

} // namespace isoslider::preprocess
