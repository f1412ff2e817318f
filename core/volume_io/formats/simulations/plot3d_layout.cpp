#include "core/volume_io/formats/simulations/plot3d_layout.h"

#include <array>
#include <limits>
#include <vector>

namespace isoslider::io {
namespace {

constexpr std::int64_t kMaxVtkValues = std::numeric_limits<std::int32_t>::max(); ///< VTK counts them in an int

/// Bytes of each record, without its marks.
std::vector<std::uint64_t> recordsOf(const Plot3dLayout& layout, bool isGrid) {
    const std::uint64_t real = layout.isDouble ? 8 : 4;
    const auto points = static_cast<std::uint64_t>(pointCount(layout.dims));
    std::vector<std::uint64_t> records;
    if (layout.hasCount)
        records.push_back(4);
    records.push_back(12);
    if (!isGrid) // Mach number, angle, Reynolds number, time
        records.push_back(4 * real);
    records.push_back(points * real * (isGrid ? 3 : 5) + (layout.hasBlanking ? 4 * points : 0));
    return records;
}

Result<std::uint32_t> integerAt(const RandomAccessFile& file, std::uint64_t at, bool isBigEndian) {
    std::array<std::byte, 4> bytes{};
    ISO_TRY(file.readExactlyAt(at, bytes));
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
        value |= std::to_integer<std::uint32_t>(bytes[i]) << 8 * (isBigEndian ? 3 - i : i);
    return value;
}

/// Whether the file has the records of the layout, up to `padding` bytes behind them, and marks
/// around each that state its size: VTK trusts them.
Result<bool> hasRecords(const RandomAccessFile& file, const Plot3dLayout& layout, bool isGrid, std::uint64_t padding) {
    const auto records = recordsOf(layout, isGrid);
    const std::uint64_t mark = layout.hasMarks ? 4 : 0;
    std::uint64_t size = 0;
    for (const std::uint64_t record : records)
        size += record + 2 * mark;
    if (file.sizeBytes() < size || file.sizeBytes() > size + padding)
        return false;
    std::uint64_t at = 0;
    for (const std::uint64_t record : records) {
        for (const std::uint64_t place : {at, at + mark + record}) {
            const auto value = layout.hasMarks ? integerAt(file, place, layout.isBigEndian) : std::uint32_t{0};
            if (!value.isOk())
                return value.error();
            if (layout.hasMarks && value.value() != record)
                return false;
        }
        at += record + 2 * mark;
    }
    return true;
}

/// The dims at the start of a file, if it may be laid out so; zeros if it cannot.
Result<GridDims> dimsOf(const RandomAccessFile& file, const Plot3dLayout& layout) {
    const std::uint64_t mark = layout.hasMarks ? 4 : 0;
    const std::uint64_t begin = (layout.hasCount ? 4 + 2 * mark : 0) + mark;
    if (file.sizeBytes() < begin + 12)
        return GridDims{0, 0, 0};
    if (layout.hasCount) {
        const auto count = integerAt(file, mark, layout.isBigEndian);
        if (!count.isOk() || count.value() != 1)
            return count.isOk() ? Result<GridDims>(GridDims{0, 0, 0}) : count.error();
    }
    GridDims dims{0, 0, 0};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto value = integerAt(file, begin + 4 * axis, layout.isBigEndian);
        if (!value.isOk())
            return value.error();
        dims[axis] = value.value();
        if (dims[axis] < 2 || dims[axis] > 100'000)
            return GridDims{0, 0, 0};
    }
    return 5 * pointCount(dims) <= kMaxVtkValues ? dims : GridDims{0, 0, 0};
}

} // namespace

Result<Plot3dLayout> detectPlot3dLayout(const RandomAccessFile& file, bool isGrid) {
    for (unsigned combination = 0; combination < 64; ++combination) {
        // Some old files are padded to whole disk sectors; an exact fit is preferred.
        const std::uint64_t padding = combination < 32 ? 0 : 511;
        Plot3dLayout layout;
        layout.isBigEndian = (combination & 1) == 0; // the usual one for binary files comes first
        layout.hasCount = (combination & 2) != 0;
        layout.isDouble = (combination & 4) != 0;
        layout.hasBlanking = (combination & 8) != 0;
        layout.hasMarks = (combination & 16) == 0; // marks that agree prove more than a size does
        if (layout.hasBlanking && !isGrid)
            continue;
        const auto dims = dimsOf(file, layout);
        if (!dims.isOk())
            return dims.error();
        layout.dims = dims.value();
        if (layout.dims == GridDims{0, 0, 0})
            continue;
        const auto fits = hasRecords(file, layout, isGrid, padding);
        if (!fits.isOk())
            return fits.error();
        if (fits.value())
            return layout;
    }
    return makeError(ErrorCode::InvalidArgument,
                     std::string("is not a PLOT3D ") + (isGrid ? "grid" : "solution") +
                         " file: no dims of a single block at its start agree with its size of " +
                         std::to_string(file.sizeBytes()) + " bytes",
                     file.path());
}

Result<Plot3dLayout> detectPlot3dPair(const RandomAccessFile& grid, const RandomAccessFile& solution) {
    const auto gridLayout = detectPlot3dLayout(grid, true);
    const auto solutionLayout = detectPlot3dLayout(solution, false);
    if (!gridLayout.isOk() || !solutionLayout.isOk())
        return gridLayout.isOk() ? solutionLayout.error() : gridLayout.error();
    const Plot3dLayout& a = gridLayout.value();
    const Plot3dLayout& b = solutionLayout.value();
    if (a.dims != b.dims)
        return makeError(ErrorCode::InvalidArgument, "dims: the two files of the PLOT3D pair disagree",
                         solution.path());
    if (a.isBigEndian != b.isBigEndian || a.hasMarks != b.hasMarks || a.hasCount != b.hasCount ||
        a.isDouble != b.isDouble)
        return makeError(ErrorCode::InvalidArgument,
                         "layout: the two files of the PLOT3D pair differ in byte order, precision or record marks",
                         solution.path());
    return a;
}

} // namespace isoslider::io
