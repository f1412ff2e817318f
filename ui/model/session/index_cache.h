#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/job_control.h"
#include "ui/model/session/volume_stamp.h"

namespace isoslider::model {

/// Where the indexes of opened volumes are kept between runs. Beside each lies a record of the volume's files; an
/// index counts only for the bytes that it was built from, wherever they have moved and whatever their times state.
/// Copies are of one cache, with one limit.
class IndexCache {
public:
    explicit IndexCache(std::filesystem::path folder)
        : folder_(std::move(folder)), limitBytes_(std::make_shared<std::atomic<std::uint64_t>>(kNoLimit)) {}

    const std::filesystem::path& folder() const { return folder_; }
    /// The index file of a volume at its place; whether it is there, and of these bytes, findFor states.
    /// `layout` distinguishes readings of one file.
    std::filesystem::path pathForFile(const std::filesystem::path& volume, std::string_view layout = {}) const;
    std::filesystem::path pathForSample(std::string_view name) const;

    enum class Finding { None, Fresh, Stale };
    /// Whether the index at pathForFile is of the volume as it is now. Their bytes are read only where the
    /// times of the files do not decide. A volume that has moved here brings its index along. Cancelled: None.
    Finding find(const VolumeStamp& volume, std::string_view layout, const JobControl& job) const;
    /// To be called before an index is built: it is none of what was recorded for its predecessor.
    static void forget(const std::filesystem::path& index);
    /// Reports what the index, just built, was built from. `volume` was taken before a sample of it was read. Reads all
    /// its bytes. Errors: InvalidArgument (they have changed since); those of reading and writing.
    static Status record(const std::filesystem::path& index, VolumeStamp volume, std::string_view layout,
                         const JobControl& job);

    /// What lies in the folder, unfinished indexes included.
    struct Usage {
        std::size_t indexes = 0;
        std::uint64_t bytes = 0;
    };
    Usage usage() const;
    /// The index counts as the one used last.
    static void noteUse(const std::filesystem::path& index);
    /// How many bytes trim leaves. Any thread may set it.
    void setLimit(std::uint64_t bytes) const { *limitBytes_ = bytes; }
    std::uint64_t limitBytes() const { return *limitBytes_; }
    /// Removes indexes until no more than the limit is left, those first that were not used for longest. `inUse`
    /// stays, and what another program is just building. Reports what is left.
    Usage trim(const std::filesystem::path& inUse) const;
    /// Removes all but the same.
    Usage clear(const std::filesystem::path& inUse) const;

    static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

private:
    Usage shrink(std::uint64_t mostBytes, const std::filesystem::path& inUse) const;
    std::filesystem::path pathForKey(std::string_view stem, std::string key) const;
    bool takeMoved(const VolumeStamp& volume, std::string_view layout, const JobControl& job) const;

    std::filesystem::path folder_;
    std::shared_ptr<std::atomic<std::uint64_t>> limitBytes_;
};

} // namespace isoslider::model
