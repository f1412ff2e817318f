#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/file_system.h"
#include "core/grid/grid_geometry.h"

// What the fuzz targets share.

namespace isoslider::fuzz {

/// Volumes of more samples are opened but not read: an input is to take milliseconds.
inline constexpr std::int64_t kMaxSamples = std::int64_t{1} << 18;

[[noreturn]] void broken(const char* promise, std::string_view detail, const char* file, int line);

/// Aborts with the promise that was broken; `detail`, a text, states by what.
#define ISO_REQUIRE(promise, detail) \
    do { \
        if (!(promise)) \
            broken(#promise, detail, __FILE__, __LINE__); \
    } while (false)

/// Is one line for people: neither empty nor with control characters in it.
void requireLine(std::string_view text);
void requireGoodError(const Error& error);

/// Positive dims and spacing; all that is finite has to be.
void requireGoodGeometry(const GridGeometry& geometry);

/// An input as a file that is in memory only. `bytes` must outlive it.
class BytesFile final : public RandomAccessFile {
public:
    explicit BytesFile(std::span<const std::byte> bytes, std::filesystem::path path = "input")
        : bytes_(bytes), path_(std::move(path)) {}

    const std::filesystem::path& path() const override { return path_; }
    std::uint64_t sizeBytes() const override { return bytes_.size(); }
    Result<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> out) const override;

private:
    std::span<const std::byte> bytes_;
    std::filesystem::path path_;
};

/// Writes an input for readers that want a path: into a folder of this process, in memory where the system has one
/// there. The next input of that name replaces it.
std::filesystem::path writeInput(std::string_view name, std::span<const std::byte> bytes);

} // namespace isoslider::fuzz
