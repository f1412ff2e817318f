#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/file_system.h"
#include "core/base/state_archive.h"
#include "preprocess/build_index.h"

namespace isoslider::preprocess {

/// What must be the same for a build to go on: lines of text, compared as a whole.
struct BuildIdentity {
    std::string input; ///< grid and type of the volume, and what its files state of themselves
    std::string parameters;

    static BuildIdentity of(const io::VolumeSource& source, const BuildOptions& options);
};

/// The checkpoints of one build (RESUME.md), in NAME.resume beside the index. One thread at a time.
class BuildCheckpoints {
public:
    BuildCheckpoints(const std::filesystem::path& indexPath, BuildIdentity identity, const BuildOptions& options);
    /// Removes the checkpoint, unless the build may go on later.
    ~BuildCheckpoints();
    BuildCheckpoints(const BuildCheckpoints&) = delete;
    BuildCheckpoints& operator=(const BuildCheckpoints&) = delete;

    /// The state that an earlier build left; none where there is none that could be gone on with, or where the options
    /// do not ask for it.
    /// Errors: InvalidArgument (it is of another input, of other parameters, of another version, unless the options say
    /// that such a one is replaced), IoError.
    Result<std::optional<std::vector<std::byte>>> load() const;
    /// From now on the checkpoint is this build's: its index's partial file is locked. Removes one that is there,
    /// with its sort runs, unless the build goes on with it.
    void own(bool goesOn);

    /// Whether it is time for one.
    bool isDue() const;
    /// Replaces the one before, in one step. REQUIRES: what it speaks of has been synced; `begin` is when that began.
    /// `indexBytes`: of the partial file, that it speaks of.
    Status save(const std::vector<std::byte>& state, std::uint64_t indexBytes,
                std::chrono::steady_clock::time_point begin);
    /// The index is complete.
    void finish() { isFinished_ = true; }

private:
    std::filesystem::path path_, saving_, partial_; ///< the checkpoint; while it is written; of the index
    std::filesystem::path spill_; ///< sort runs
    BuildIdentity identity_;
    FileSystem& fileSystem_;
    bool resumes_, replacesUnfit_;
    bool isOwner_ = false, isFinished_ = false;
    std::chrono::duration<double> interval_;
    std::chrono::steady_clock::time_point next_;
};

/// Of what checkpoints hold: one is read by the version of the program that wrote it.
std::string checkpointVersion();
/// A file of `body` and its checksum, behind letters that name its kind. Errors: those of AtomicFile.
Status writeChecked(const std::filesystem::path& path, std::string_view magic, const std::vector<std::byte>& body,
                    FileSystem& fileSystem);
/// The body in the bytes of such a file; none unless all of it is as it was written.
std::optional<std::span<const std::byte>> checkedBody(std::span<const std::byte> bytes, std::string_view magic);
/// Where the checkpoint of an index is.
std::filesystem::path checkpointPath(const std::filesystem::path& indexPath);
/// Whether there is one, of whatever build.
bool hasCheckpoint(const std::filesystem::path& indexPath);

} // namespace isoslider::preprocess
