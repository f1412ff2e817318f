#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "core/base/file_system.h"
#include "core/base/job_control.h"

namespace isoslider {

/// XXH3 with 64 bits, over bytes that come in pieces. Distinguishes contents; no protection against forgery.
class ContentHash {
public:
    ContentHash();
    ~ContentHash();
    ContentHash(const ContentHash&) = delete;
    ContentHash& operator=(const ContentHash&) = delete;

    void add(std::span<const std::byte> bytes);
    /// Of all that was added so far.
    std::uint64_t value() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Of all bytes of a regular file, read in pieces. Errors: those of openForReading, IoError; Cancelled.
Result<std::uint64_t> hashFile(const std::filesystem::path& path, const JobControl& job = {},
                               FileSystem& fileSystem = defaultFileSystem());

} // namespace isoslider
