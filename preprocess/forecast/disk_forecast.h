#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "core/base/file_system.h"

namespace isoslider::preprocess {

/// What a build takes of the disk, estimated before its long passes: blocks of the volume are encoded as they will be,
/// and what they need is extrapolated.
struct DiskForecast {
    std::uint64_t indexBytes = 0; ///< of the complete index; off by less than 15 % as a rule
    std::uint64_t temporaryBytes = 0; ///< beside it while it is built: an upper bound, about
    std::uint64_t topologyBytes = 0; ///< behind it once it is built: off by a fifth as a rule; 0: none is wanted

    /// Of an unfinished build: what is still to come.
    DiskForecast less(const DiskForecast& there) const {
        return {indexBytes - std::min(indexBytes, there.indexBytes),
                temporaryBytes - std::min(temporaryBytes, there.temporaryBytes), topologyBytes};
    }
};

/// Whether both folders have room for that. Where the system does not state how much is free, there is.
/// Errors: OutOfSpace, stating what is needed and what is free.
Status checkRoom(const DiskForecast& needed, const std::filesystem::path& indexPath,
                 const std::filesystem::path& temporaryPath, FileSystem& fileSystem);

/// A part of `total` things spread over them: one from each of `count` equal runs, at places that do not repeat from
/// run to run. All of them when there are no more.
class SpreadSample {
public:
    SpreadSample(std::uint64_t total, std::uint64_t count) : total_(total), count_(std::min(total, count)) {}
    std::uint64_t count() const { return count_; }
    std::uint64_t at(std::uint64_t run, std::uint64_t variation = 0) const;

private:
    std::uint64_t total_, count_;
};

} // namespace isoslider::preprocess
