#include "core/volume_io/parsing/header_checks.h"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/base/machine.h"
#include "core/volume_io/parsing/reading_memory.h"

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

template <class Number>
bool parseNumbers(std::string_view text, std::vector<Number>& out) {
    out.clear();
    for (const std::string_view word : words(text)) {
        const auto value = parseNumber<Number>(word);
        if (!value)
            return false;
        out.push_back(*value);
    }
    return true;
}

} // namespace

Error refuseField(std::string_view field, std::string_view problem, const fs::path& path) {
    return makeError(ErrorCode::InvalidArgument, std::string(field) + ": " + std::string(problem), path);
}

std::optional<std::int64_t> parseInteger(std::string_view text) { return parseNumber<std::int64_t>(text); }
std::optional<double> parseReal(std::string_view text) { return parseNumber<double>(text); }
bool parseIntegers(std::string_view text, std::vector<std::int64_t>& out) { return parseNumbers(text, out); }
bool parseReals(std::string_view text, std::vector<double>& out) { return parseNumbers(text, out); }

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos)
        return {};
    return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> out;
    while (!(text = trimmed(text)).empty()) {
        const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
        out.push_back(word);
        text.remove_prefix(word.size());
    }
    return out;
}

Status checkExtents(std::span<const std::int64_t> sizes, std::string_view field, const fs::path& path) {
    if (sizes.empty())
        return refuseField(field, "the data has no dimension", path);
    std::int64_t values = 1;
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
        if (sizes[axis] < 1 || sizes[axis] > kMaxDim)
            return refuseField(field,
                               "extent " + std::to_string(sizes[axis]) + " of axis " + std::to_string(axis + 1) +
                                   " is not within 1.." + std::to_string(kMaxDim),
                               path);
        values *= sizes[axis]; // both factors are below 2^41: no overflow before the next test
        if (values > kMaxPoints)
            return refuseField(field, "more than 2^40 grid points in all", path);
    }
    return {};
}

Result<GridDims> checkDims(std::span<const std::int64_t> sizes, std::string_view field, const fs::path& path) {
    ISO_TRY(checkExtents(sizes, field, path));
    GridDims dims{1, 1, 1};
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
        if (axis >= 3 && sizes[axis] != 1)
            return refuseField(field,
                               "the data has " + std::to_string(sizes.size()) +
                                   " dimensions, a series or several components; save one volume of it",
                               path);
        if (axis < 3)
            dims[axis] = sizes[axis];
    }
    return dims;
}

Status checkGeometry(const GridGeometry& geometry, std::string_view field, const fs::path& path) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(geometry.spacing[axis]) || !(geometry.spacing[axis] > 0.0))
            return refuseField(field,
                               "spacing " + std::to_string(geometry.spacing[axis]) + " of axis " +
                                   std::to_string(axis + 1) + " is not a positive number",
                               path);
        if (!std::isfinite(geometry.origin[axis]))
            return refuseField(field, "the origin is not finite", path);
    }
    const double determinant = glm::determinant(geometry.direction);
    if (!std::isfinite(determinant) || std::abs(determinant) < 1e-6)
        return refuseField(field, "the axis directions do not span space", path);
    return {};
}

Result<fs::path> resolveDataFile(const fs::path& header, std::string_view name, std::string_view field,
                                 bool allowsExternal) {
    const auto folder = canonicalPath(header.parent_path());
    if (!folder.isOk())
        return folder.error();
    auto resolved = canonicalPath(folder.value() / fs::path(name));
    if (!resolved.isOk())
        return refuseField(field, inQuotes(name) + ": " + resolved.error().message, header);
    const fs::path& file = resolved.value();
    const auto mismatch = std::mismatch(folder.value().begin(), folder.value().end(), file.begin(), file.end());
    if (!allowsExternal && mismatch.first != folder.value().end())
        return refuseField(
            field, inQuotes(name) + " lies outside the folder of the header (data outside it has to be allowed)",
            header);
    if (!isPresent(file))
        return refuseField(field, "there is no file " + inQuotes(name) + " beside the header", header);
    return resolved;
}

Result<std::string> readStart(const fs::path& path, std::uint64_t maxBytes) {
    auto file = defaultFileSystem().openForReading(path);
    if (!file.isOk())
        return std::move(file).error();
    std::string text(std::min(file.value()->sizeBytes(), maxBytes), '\0');
    ISO_TRY(file.value()->readExactlyAt(0, std::as_writable_bytes(std::span(text))));
    return text;
}

Status checkFitsMemory(std::uint64_t sizeBytes, std::uint64_t memoryBytes, const fs::path& path) {
    const std::uint64_t memory = readingMemoryOf(memoryBytes);
    if (sizeBytes <= memory)
        return {};
    return makeError(ErrorCode::OutOfSpace,
                     "needs " + std::to_string((sizeBytes >> 20) + 1) + " MiB in memory, " +
                         (memoryBytes == 0 ? "this machine has " : "reading may hold half of the memory budget, ") +
                         std::to_string(memory >> 20) + (memoryBytes == 0 ? "" : " MiB"),
                     path);
}

} // namespace isoslider::io
