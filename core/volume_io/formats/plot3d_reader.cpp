#include <array>
#include <cmath>
#include <limits>

#include <vtkDataArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkMultiBlockPLOT3DReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStructuredGrid.h>

#include "core/base/file_system.h"
#include "core/volume_io/curvilinear_resampler.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/header_checks.h"
#include "core/volume_io/formats/vtk_bridge.h"
#include "core/volume_io/resampled_source.h"

// VTK reads the pair once its layout is known and its sizes are proved. PLOT3D files say nothing of
// byte order, precision or record marks: each combination implies a file size and the marks' values,
// and the one that fits is taken. VTK's own detection looks at the grid file alone and knows no padding.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr GridDims kDefaultDims{256, 256, 256};
constexpr std::int64_t kMaxVtkValues = std::numeric_limits<std::int32_t>::max(); ///< VTK counts them in an int

/// One scalar of the solution, as VTK names it.
struct Field {
    std::string_view name, otherName;
    const char* vtkArray;
    int vtkComponent;
};
constexpr Field kFields[] = {{"density", "density", "Density", 0},
                             {"x momentum", "momentum x", "Momentum", 0},
                             {"y momentum", "momentum y", "Momentum", 1},
                             {"z momentum", "momentum z", "Momentum", 2},
                             {"energy", "stagnation energy", "StagnationEnergy", 0}};

struct Files {
    fs::path grid, solution;
};

/// How one file of a single block is laid out.
struct Layout {
    GridDims dims{0, 0, 0};
    bool isBigEndian = false;
    bool hasMarks = false;  ///< Fortran's byte counts around each record
    bool hasCount = false;  ///< the number of blocks, 1, comes first
    bool isDouble = false;
    bool hasBlanking = false; ///< an integer per point behind the coordinates
};

/// Bytes of each record, without its marks.
std::vector<std::uint64_t> recordsOf(const Layout& layout, bool isGrid) {
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
/// around each that say its size: VTK trusts them.
Result<bool> hasRecords(const RandomAccessFile& file, const Layout& layout, bool isGrid, std::uint64_t padding) {
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
Result<GridDims> dimsOf(const RandomAccessFile& file, const Layout& layout) {
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

Result<Layout> detectLayout(const RandomAccessFile& file, bool isGrid) {
    for (unsigned combination = 0; combination < 64; ++combination) {
        // Some old files are padded to whole disk sectors; an exact fit is preferred.
        const std::uint64_t padding = combination < 32 ? 0 : 511;
        Layout layout;
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

/// The field of that name, the first one for none; null if there is none such.
const Field* findField(std::string_view name) {
    const std::string lower = lowerCase(name);
    for (const Field& field : kFields)
        if (lower.empty() || lower == field.name || lower == field.otherName)
            return &field;
    return nullptr;
}

Result<Files> findPair(const fs::path& path) {
    constexpr std::string_view kEndings[][2] = {{"xyz.bin", "q.bin"}, {".xyz", ".q"}};
    const std::string name = path.filename().string();
    Files files;
    for (const auto& [gridEnd, solutionEnd] : kEndings) {
        if (name.ends_with(gridEnd))
            files = {path, path.parent_path() / (name.substr(0, name.size() - gridEnd.size()) + std::string(solutionEnd))};
        else if (name.ends_with(solutionEnd))
            files = {path.parent_path() / (name.substr(0, name.size() - solutionEnd.size()) + std::string(gridEnd)), path};
    }
    if (files.grid.empty())
        return makeError(ErrorCode::InvalidArgument, "is not named as one of a PLOT3D pair (xyz.bin and q.bin)", path);
    const fs::path& partner = files.grid == path ? files.solution : files.grid;
    std::error_code ignored;
    if (!fs::exists(partner, ignored))
        return makeError(ErrorCode::NotFound, "the other file of the PLOT3D pair is missing", partner);
    return files;
}

/// Proves the sizes of both files. VTK has one setting for the two, so their layouts must agree.
Result<Layout> checkPair(const Files& files) {
    auto grid = defaultFileSystem().openForReading(files.grid);
    auto solution = defaultFileSystem().openForReading(files.solution);
    if (!grid.isOk() || !solution.isOk())
        return grid.isOk() ? std::move(solution).error() : std::move(grid).error();
    const auto gridLayout = detectLayout(*grid.value(), true);
    const auto solutionLayout = detectLayout(*solution.value(), false);
    if (!gridLayout.isOk() || !solutionLayout.isOk())
        return gridLayout.isOk() ? solutionLayout.error() : gridLayout.error();
    const Layout& a = gridLayout.value();
    const Layout& b = solutionLayout.value();
    if (a.dims != b.dims)
        return makeError(ErrorCode::InvalidArgument, "dims: the two files of the PLOT3D pair disagree", files.solution);
    if (a.isBigEndian != b.isBigEndian || a.hasMarks != b.hasMarks || a.hasCount != b.hasCount ||
        a.isDouble != b.isDouble)
        return makeError(ErrorCode::InvalidArgument,
                         "layout: the two files of the PLOT3D pair differ in byte order, precision or record marks",
                         files.solution);
    const std::uint64_t inCurvilinear = sizeof(glm::dvec3) + sizeof(float);
    ISO_TRY(checkFitsMemory(grid.value()->sizeBytes() + solution.value()->sizeBytes() +
                                inCurvilinear * static_cast<std::uint64_t>(pointCount(a.dims)),
                            files.solution));
    return a;
}

Result<CurvilinearGrid> convert(vtkStructuredGrid& block, vtkDataArray& values, int component, const fs::path& path) {
    CurvilinearGrid out;
    const vtkIdType points = block.GetNumberOfPoints();
    out.points.reserve(static_cast<std::size_t>(points));
    out.values.reserve(static_cast<std::size_t>(points));
    for (vtkIdType i = 0; i < points; ++i) {
        std::array<double, 3> p{};
        block.GetPoints()->GetPoint(i, p.data());
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
            return makeError(ErrorCode::InvalidArgument, "point " + std::to_string(i) + " is not finite", path);
        out.points.emplace_back(p[0], p[1], p[2]);
        out.values.push_back(static_cast<float>(values.GetComponent(i, component)));
    }
    return out;
}

Result<CurvilinearGrid> readPair(const Files& files, const Field& field) {
    const auto layout = checkPair(files);
    if (!layout.isOk())
        return layout.error();
    const VtkSession session;
    const vtkNew<vtkMultiBlockPLOT3DReader> reader;
    reader->SetXYZFileName(files.grid.c_str());
    reader->SetQFileName(files.solution.c_str());
    reader->SetByteOrder(layout.value().isBigEndian ? vtkMultiBlockPLOT3DReader::FILE_BIG_ENDIAN
                                                    : vtkMultiBlockPLOT3DReader::FILE_LITTLE_ENDIAN);
    reader->SetHasByteCount(layout.value().hasMarks);
    reader->SetMultiGrid(layout.value().hasCount);
    reader->SetDoublePrecision(layout.value().isDouble);
    reader->SetIBlanking(layout.value().hasBlanking);
    reader->ForceReadOn(); // the sizes are checked; VTK's own check refuses padding
    reader->Update();
    vtkMultiBlockDataSet* blocks = reader->GetOutput();
    auto* block = blocks != nullptr && blocks->GetNumberOfBlocks() == 1
                      ? vtkStructuredGrid::SafeDownCast(blocks->GetBlock(0))
                      : nullptr;
    if (!session.complaint().empty() || block == nullptr)
        return session.error("no single block", files.solution);
    vtkDataArray* values = block->GetPointData()->GetArray(field.vtkArray);
    const GridDims& dims = layout.value().dims;
    if (values == nullptr || values->GetNumberOfComponents() <= field.vtkComponent ||
        values->GetNumberOfTuples() != pointCount(dims) || block->GetNumberOfPoints() != pointCount(dims))
        return session.error("not one value per point", files.solution);
    auto out = convert(*block, *values, field.vtkComponent, files.grid);
    if (out.isOk())
        out.value().dims = dims;
    return out;
}

} // namespace

Result<VolumeContents> listPlot3d(const fs::path& path, const ReadOptions& options) {
    const auto files = findPair(path);
    if (!files.isOk())
        return files.error();
    const auto layout = checkPair(files.value());
    if (!layout.isOk())
        return layout.error();
    VolumeContents contents;
    contents.format = "PLOT3D";
    contents.isPreferredChosen = true; // density, which every solution has and which needs no frame of reference
    for (const Field& field : kFields) {
        VolumeField listed;
        listed.name = std::string(field.name);
        listed.dims = options.resampleDims == GridDims{0, 0, 0} ? kDefaultDims : options.resampleDims;
        listed.typeName = layout.value().isDouble ? "float64" : "float32";
        listed.isResampled = true;
        contents.fields.push_back(std::move(listed));
    }
    return contents;
}

Result<std::unique_ptr<VolumeSource>> openPlot3d(const fs::path& path, const ReadOptions& options) {
    const Field* field = findField(options.field);
    if (field == nullptr)
        return refuseField("field", "density, x momentum, y momentum, z momentum or energy expected, found " +
                                        inQuotes(options.field), path);
    const auto files = findPair(path);
    if (!files.isOk())
        return files.error();
    auto curvilinear = readPair(files.value(), *field);
    if (!curvilinear.isOk())
        return std::move(curvilinear).error();
    const auto dims = resampledDims(options, kDefaultDims, path);
    if (!dims.isOk())
        return dims.error();
    VolumeInfo info;
    info.format = "PLOT3D";
    info.dataFiles = filesBeside(path, {{files.value().grid, 0}, {files.value().solution, 0}});
    info.fieldName = std::string(field->name);
    info.geometry = boundingGeometry(curvilinear.value().points, dims.value());
    ISO_TRY(checkGeometry(info.geometry, "grid points", path));
    return makeResampledSource(std::move(info), makeCurvilinearMesh(std::move(curvilinear).value()));
}

} // namespace isoslider::io
