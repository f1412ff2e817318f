#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/plain_text.h"
#include "core/base/result.h"
#include "core/grid/scalar_grid.h"

namespace isoslider::io {

/// Longest text header, and longest line in one, that is looked at.
inline constexpr std::uint64_t kMaxHeaderBytes = std::uint64_t{1} << 20;
inline constexpr std::size_t kMaxHeaderLine = 4000;

/// "field: problem", as InvalidArgument.
Error refuseField(std::string_view field, std::string_view problem, const std::filesystem::path& path);

/// Whole text as one number; the locale plays no part. Accepts a leading '+'.
std::optional<std::int64_t> parseInteger(std::string_view text);
std::optional<double> parseReal(std::string_view text);
bool parseIntegers(std::string_view text, std::vector<std::int64_t>& out);
bool parseReals(std::string_view text, std::vector<double>& out);

std::string_view trimmed(std::string_view text);
std::vector<std::string_view> words(std::string_view text);

/// Checks extents of any number of axes: each within [1, kMaxDim], their product within kMaxPoints.
Status checkExtents(std::span<const std::int64_t> sizes, std::string_view field, const std::filesystem::path& path);

/// The same of a volume's extents as a header gives them: missing ones are 1, those beyond the third have to be.
Result<GridDims> checkDims(std::span<const std::int64_t> sizes, std::string_view field,
                           const std::filesystem::path& path);

/// Finite positive spacing, finite origin, invertible direction.
Status checkGeometry(const GridGeometry& geometry, std::string_view field, const std::filesystem::path& path);

/// Where a data file named in a header really is. Refuses one that lies outside the header's
/// folder once links are followed, unless that is allowed. Errors: InvalidArgument (also
/// where there is none: the header is at fault, not the disk), IoError.
Result<std::filesystem::path> resolveDataFile(const std::filesystem::path& header, std::string_view name,
                                              std::string_view field, bool allowsExternal = false);

/// Up to `maxBytes` from the start of a file, as text.
Result<std::string> readStart(const std::filesystem::path& path, std::uint64_t maxBytes = kMaxHeaderBytes);

/// Refuses a volume that is larger than the memory that reading may hold (ReadOptions::memoryBytes). OutOfSpace.
Status checkFitsMemory(std::uint64_t sizeBytes, std::uint64_t memoryBytes, const std::filesystem::path& path);

} // namespace isoslider::io
