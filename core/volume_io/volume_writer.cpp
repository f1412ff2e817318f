#include "core/volume_io/volume_writer.h"

#include <algorithm>
#include <bit>
#include <charconv>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

static_assert(std::endian::native == std::endian::little, "samples are written as they lie in memory");

std::string_view metaType(ScalarType type) {
    switch (type) {
        case ScalarType::U8: return "MET_UCHAR";
        case ScalarType::I8: return "MET_CHAR";
        case ScalarType::U16: return "MET_USHORT";
        case ScalarType::I16: return "MET_SHORT";
        case ScalarType::I32: return "MET_INT";
        case ScalarType::F32: return "MET_FLOAT";
        case ScalarType::F64: return "MET_DOUBLE";
    }
    checkFailed("known ScalarType", __FILE__, __LINE__);
}

void addNumber(std::string& text, double value) {
    char digits[40];
    text += ' ';
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

void addVector(std::string& text, std::string_view key, const glm::dvec3& vector) {
    text += std::string(key) + " =";
    for (int axis = 0; axis < 3; ++axis)
        addNumber(text, vector[axis]);
    text += '\n';
}

std::string headerOf(const ScalarGrid& grid, std::string_view lengthUnit) {
    const GridGeometry& geometry = grid.geometry();
    std::string text = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                       "CompressedData = False\nTransformMatrix =";
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            addNumber(text, geometry.direction[column][row]);
    text += '\n';
    addVector(text, "Offset", geometry.origin);
    addVector(text, "ElementSpacing", geometry.spacing);
    if (lengthUnit == "mm" || lengthUnit == "cm" || lengthUnit == "µm")
        text += "DistanceUnits = " + std::string(lengthUnit == "µm" ? "um" : lengthUnit) + "\n";
    text += "DimSize =";
    for (const std::int64_t size : geometry.dims)
        text += ' ' + std::to_string(size);
    return text + "\nElementType = " + std::string(metaType(grid.type())) + "\nElementDataFile = LOCAL\n";
}

} // namespace

Status writeVolume(const ScalarGrid& grid, const std::filesystem::path& path, std::string_view lengthUnit,
                   const JobControl& job, FileSystem& fileSystem) {
    if (lowerCase(path.extension().string()) != ".mha")
        return makeError(ErrorCode::InvalidArgument, "volumes are written as .mha", path);
    auto file = AtomicFile::create(path, fileSystem);
    if (!file.isOk())
        return std::move(file).error();
    const std::string header = headerOf(grid, lengthUnit);
    ISO_TRY(file.value()->writeAll(std::as_bytes(std::span(header))));
    constexpr std::size_t kChunk = std::size_t{64} << 20;
    const auto bytes = grid.bytes();
    for (std::size_t done = 0; done < bytes.size(); done += kChunk) {
        if (job.isStopRequested())
            return cancelledError();
        ISO_TRY(file.value()->writeAll(bytes.subspan(done, std::min(kChunk, bytes.size() - done))));
        job.report(static_cast<double>(done) / static_cast<double>(bytes.size()), "writing");
    }
    return file.value()->publish();
}

} // namespace isoslider::io
