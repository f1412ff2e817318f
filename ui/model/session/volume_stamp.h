#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file_stamp.h"
#include "core/base/job_control.h"

namespace isoslider::model {

/// One file as it was at some moment.
struct StampedFile {
    std::filesystem::path path; ///< absolute, or relative to the folder that is the volume
    FileStamp stamp;
    std::uint64_t hash = 0; ///< of the bytes; only of a stamp with hashes
};

/// Reports whether a volume's files are those that they were. Taking it reads no bytes of them; equal stamps mean
/// equal contents, unequal ones leave it to the hashes. A modification time alone would not do: programs set it.
class VolumeStamp {
public:
    /// Of a volume's file, or of every file in its folder, and of `dataFiles` beside it. Errors: IoError, NotFound
    /// (one cannot be looked at), InvalidArgument (a folder of too many files).
    static Result<VolumeStamp> of(const std::filesystem::path& volume,
                                  const std::vector<std::filesystem::path>& dataFiles = {});

    const std::filesystem::path& volume() const { return volume_; }
    /// Absolute. REQUIRES: the stamp was taken, not read from a text.
    std::vector<std::filesystem::path> files() const;
    /// Sizes and times are those of `other`, of files that had settled.
    bool looksLike(const VolumeStamp& other) const;
    /// The same names and sizes, wherever the volume lies: worth comparing bytes.
    bool couldBe(const VolumeStamp& other) const;
    /// Reads all bytes. REQUIRES: the stamp was taken, not read from a text. Errors: Cancelled; those of reading;
    /// InvalidArgument (a file changed meanwhile).
    Status hash(const JobControl& job);
    /// REQUIRES: both have hashes.
    bool hasContentOf(const VolumeStamp& other) const;

    /// A JSON object. fromText gives nothing for what it did not write.
    std::string toText() const;
    static std::optional<VolumeStamp> fromText(const std::string& text);

private:
    std::filesystem::path volume_; ///< absolute
    std::filesystem::path root_; ///< what the files' paths are relative to; of one that was just taken
    std::vector<StampedFile> files_; ///< in the order of their paths, but the volume's own first
};

} // namespace isoslider::model
