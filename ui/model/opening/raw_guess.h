#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "core/volume_io/volume_reader.h"

namespace isoslider::model {

/// True for suffixes of files that hold samples and nothing else: .raw, .dat.
bool isHeaderlessSuffix(const std::filesystem::path& path);

/// Bytes that a layout asks for, skipped ones included. REQUIRES: dims within kMaxDim.
std::uint64_t layoutBytes(const io::RawLayout& layout);

/// What a name like "skull_256x256x113_uint8.raw" states.
struct NamedLayout {
    GridDims dims{0, 0, 0}; ///< zeros if not named
    std::optional<ScalarType> type;
    std::optional<bool> isBigEndian;
};
NamedLayout layoutInName(std::string_view fileName);

/// What a headerless file most likely holds, from its name ("skull_256x256x113_uint8.raw") and its
/// size: dims named, or a cube, or square slices; all zero dims if nothing fits.
io::RawLayout guessRawLayout(std::string_view fileName, std::uint64_t fileBytes);

} // namespace isoslider::model
