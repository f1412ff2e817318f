#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/base/state_archive.h"
#include "core/index/format/point_record.h"
#include "preprocess/levels/key_intervals.h"

namespace isoslider::preprocess {

/// Sorts point records by (key, id) within a memory budget, by distribution: keys are cut into
/// partitions of about equally many records, records are appended to their partition (in memory, spilled to one
/// temporary file when the budget is reached), and each partition is then sorted on its own. A partition
/// that is too large for that is distributed once more, among partitions for its keys only; others are written and
/// read at most once.
///
/// Records must come in id order. Then a partition only needs a stable sort by key, and one that
/// holds a single key is sorted already, so it may be larger than memory.
template <class Key>
class ExternalSort {
public:
    using Record = index::PointRecord<Key>;
    using Consume = std::function<Status(std::span<const Record>)>;

    /// `counts`: the keys to come, about; how well they fit decides how equal the partitions are, no more.
    ExternalSort(const std::vector<KeyCount>& counts, std::uint64_t memoryBytes, std::filesystem::path spillPath,
                 FileSystem& fileSystem = defaultFileSystem());
    /// Goes on with one that was suspended, whose runs are at `spillPath`. Errors: those of FileSystem::extend;
    /// Corruption.
    static Result<std::unique_ptr<ExternalSort>> resume(StateArchive& archive, std::uint64_t memoryBytes,
                                                        std::filesystem::path spillPath,
                                                        FileSystem& fileSystem = defaultFileSystem());
    ~ExternalSort();
    /// Leaves the runs on disk: they will be gone on with.
    void keepUnfinished() { keepsUnfinished_ = true; }
    /// They are not needed any more.
    void removeRuns() { keepsUnfinished_ = false; }

    /// Writes all records that are in memory, syncs, and saves where they lie.
    Status suspend(StateArchive& archive);

    /// Errors: OutOfSpace, IoError.
    Status add(std::span<const Record> records);

    /// Where a drain stands, between partitions.
    struct Place {
        std::uint64_t partition = 0, records = 0; ///< the next one; handed over before
    };
    using Between = std::function<Status(const Place&)>;
    /// Hands all records from `begin` on to `consume` in (key, id) order, in runs of bounded size. Call once. Calls
    /// `between`, if it is not empty, between partitions where all that is left is on the disk.
    Status drain(const Consume& consume, const JobControl& job, Place begin = {}, const Between& between = {});

    std::uint64_t recordCount() const { return recordCount_; }
    std::uint64_t spilledBytes() const { return spilledBytes_; }

private:
    struct SpilledRun {
        std::uint64_t offset = 0;
        std::uint64_t records = 0;
    };
    struct Partition {
        std::vector<Record> buffer;
        std::vector<SpilledRun> runs;
        std::uint64_t records = 0;
    };
    ExternalSort(KeyIntervals intervals, std::uint64_t memoryBytes, std::filesystem::path spillPath,
                 FileSystem& fileSystem);
    void state(StateArchive& archive);
    static KeyIntervals makePartitions(const std::vector<KeyCount>& counts, std::uint64_t memoryBytes);

    Status spill();
    Status load(Partition& partition, std::vector<Record>& out);
    /// Hands over what a partition holds in the order in which it came, and frees it.
    Status stream(Partition& partition, const Consume& consume);
    /// Sorts a partition that is larger than memory, by distributing it once more.
    Status sortAgain(Partition& partition, const Consume& consume, const JobControl& job);
    Status sortBatch(std::size_t begin, std::size_t end, const Consume& consume);
    /// The end of the partitions from `first` on that are sorted side by side: none is too large, nor are they
    /// together.
    std::size_t endOfBatch(std::size_t first) const;
    bool isTooLarge(const Partition& partition) const { return partition.records > mostRecordsAtOnce_; }
    Status readRun(const SpilledRun& run, std::uint64_t first, std::span<Record> out);

    std::uint64_t memoryBytes_;
    std::uint64_t mostRecordsAtOnce_; ///< that are loaded and sorted, in all partitions of a batch
    std::filesystem::path spillPath_;
    FileSystem& fileSystem_;
    std::unique_ptr<WritableFile> spillOut_;
    std::unique_ptr<RandomAccessFile> spillIn_;
    KeyIntervals intervals_;
    std::vector<Partition> partitions_; ///< by interval
    std::uint64_t bufferedBytes_ = 0;
    std::uint64_t spilledBytes_ = 0;
    std::uint64_t recordCount_ = 0;
    bool keepsUnfinished_ = false;
};

extern template class ExternalSort<std::uint16_t>;
extern template class ExternalSort<std::uint32_t>;
extern template class ExternalSort<std::uint64_t>;

} // namespace isoslider::preprocess
