#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/file_system.h"
#include "core/base/job_control.h"
#include "core/index/point_record.h"

namespace isoslider::preprocess {

/// Sorts point records by (key, id) within a memory budget, by distribution: keys are cut into
/// partitions known beforehand, records are appended to their partition (in memory, spilled to one
/// temporary file when the budget is reached), and each partition is then sorted on its own. Every
/// record is written and read at most once.
///
/// Records must come in id order. Then a partition only needs a stable sort by key, and one that
/// holds a single key is sorted already, so it may be larger than memory.
template <class Key>
class ExternalSort {
public:
    using Record = index::PointRecord<Key>;

    /// `countsByPrefix`: points by key >> keyShift, an upper bound on the records to come.
    ExternalSort(const std::vector<std::uint64_t>& countsByPrefix, int keyShift, std::uint64_t memoryBytes,
                 std::filesystem::path spillPath, FileSystem& fileSystem = defaultFileSystem());
    ~ExternalSort();

    /// Errors: OutOfSpace, IoError.
    Status add(std::span<const Record> records);

    /// Hands all records to `consume` in (key, id) order, in runs of bounded size. Call once.
    Status drain(const std::function<Status(std::span<const Record>)>& consume, const JobControl& job);

    std::uint64_t recordCount() const { return recordCount_; }
    std::uint64_t spilledBytes() const { return spilledBytes_; }
    std::size_t partitionCount() const { return partitions_.size(); }

private:
    struct SpilledRun {
        std::uint64_t offset = 0;
        std::uint64_t records = 0;
    };
    struct Partition {
        std::vector<Record> buffer;
        std::vector<SpilledRun> runs;
        std::uint64_t records = 0;
        bool hasOneKey = false;
    };

    Status spill();
    Status load(Partition& partition, std::vector<Record>& out);
    Status streamOneKey(Partition& partition, const std::function<Status(std::span<const Record>)>& consume);
    Status readRun(const SpilledRun& run, std::uint64_t first, std::span<Record> out);

    int keyShift_;
    std::uint64_t memoryBytes_;
    std::filesystem::path spillPath_;
    FileSystem& fileSystem_;
    std::unique_ptr<WritableFile> spillOut_;
    std::unique_ptr<RandomAccessFile> spillIn_;
    std::vector<std::uint32_t> partitionOfPrefix_;
    std::vector<Partition> partitions_;
    std::uint64_t bufferedBytes_ = 0;
    std::uint64_t spilledBytes_ = 0;
    std::uint64_t recordCount_ = 0;
};

extern template class ExternalSort<std::uint16_t>;
extern template class ExternalSort<std::uint32_t>;
extern template class ExternalSort<std::uint64_t>;

} // namespace isoslider::preprocess
