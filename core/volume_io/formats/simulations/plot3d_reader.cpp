#include <array>
#include <cmath>

#include <vtkDataArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkMultiBlockPLOT3DReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkStructuredGrid.h>

#include "core/base/file_system.h"
#include "core/base/folders.h"
#include "core/volume_io/formats/data_files.h"
#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/simulations/plot3d_layout.h"
#include "core/volume_io/formats/vtk/vtk_bridge.h"
#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/resampling/curvilinear_resampler.h"
#include "core/volume_io/resampling/point_lattice.h"
#include "core/volume_io/resampling/resampled_source.h"

// VTK reads the pair once its layout is known and its sizes are proved. VTK's own detection looks at the grid file
// alone and knows no padding.

namespace isoslider::io {
namespace fs = std::filesystem;
namespace {

constexpr GridDims kDefaultDims{256, 256, 256};

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
            files = {path,
                     path.parent_path() / (name.substr(0, name.size() - gridEnd.size()) + std::string(solutionEnd))};
        else if (name.ends_with(solutionEnd))
            files = {path.parent_path() / (name.substr(0, name.size() - solutionEnd.size()) + std::string(gridEnd)),
                     path};
    }
    if (files.grid.empty())
        return makeError(ErrorCode::InvalidArgument, "is not named as one of a PLOT3D pair (xyz.bin and q.bin)", path);
    const fs::path& partner = files.grid == path ? files.solution : files.grid;
    if (!isPresent(partner))
        return makeError(ErrorCode::NotFound, "the other file of the PLOT3D pair is missing", partner);
    return files;
}

/// Proves the sizes of both files.
Result<Plot3dLayout> checkPair(const Files& files, std::uint64_t memoryBytes) {
    auto grid = defaultFileSystem().openForReading(files.grid);
    auto solution = defaultFileSystem().openForReading(files.solution);
    if (!grid.isOk() || !solution.isOk())
        return grid.isOk() ? std::move(solution).error() : std::move(grid).error();
    auto layout = detectPlot3dPair(*grid.value(), *solution.value());
    if (!layout.isOk())
        return layout;
    const std::uint64_t inCurvilinear = sizeof(glm::dvec3) + sizeof(float);
    ISO_TRY(checkFitsMemory(grid.value()->sizeBytes() + solution.value()->sizeBytes() +
                                inCurvilinear * static_cast<std::uint64_t>(pointCount(layout.value().dims)),
                            memoryBytes, files.solution));
    return layout;
}

Result<std::vector<glm::dvec3>> pointsOf(vtkStructuredGrid& block, const fs::path& path) {
    std::vector<glm::dvec3> out;
    const vtkIdType points = block.GetNumberOfPoints();
    out.reserve(static_cast<std::size_t>(points));
    for (vtkIdType i = 0; i < points; ++i) {
        std::array<double, 3> p{};
        block.GetPoints()->GetPoint(i, p.data());
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
            return makeError(ErrorCode::InvalidArgument, "point " + std::to_string(i) + " is not finite", path);
        out.emplace_back(p[0], p[1], p[2]);
    }
    return out;
}

/// The one block of a pair, without the solution unless it is asked for. Within a session.
Result<vtkSmartPointer<vtkStructuredGrid>> readBlock(const VtkSession& session, const Files& files,
                                                     const Plot3dLayout& layout, bool hasSolution) {
    const vtkNew<vtkMultiBlockPLOT3DReader> reader;
    reader->SetXYZFileName(files.grid.c_str());
    if (hasSolution)
        reader->SetQFileName(files.solution.c_str());
    reader->SetByteOrder(layout.isBigEndian ? vtkMultiBlockPLOT3DReader::FILE_BIG_ENDIAN
                                            : vtkMultiBlockPLOT3DReader::FILE_LITTLE_ENDIAN);
    reader->SetHasByteCount(layout.hasMarks);
    reader->SetMultiGrid(layout.hasCount);
    reader->SetDoublePrecision(layout.isDouble);
    reader->SetIBlanking(layout.hasBlanking);
    reader->ForceReadOn(); // the sizes are checked; VTK's own check refuses padding
    reader->Update();
    vtkMultiBlockDataSet* blocks = reader->GetOutput();
    vtkSmartPointer<vtkStructuredGrid> block = blocks != nullptr && blocks->GetNumberOfBlocks() == 1
                                                   ? vtkStructuredGrid::SafeDownCast(blocks->GetBlock(0))
                                                   : nullptr;
    if (!session.complaint().empty() || block == nullptr || block->GetNumberOfPoints() != pointCount(layout.dims))
        return session.error("no single block", hasSolution ? files.solution : files.grid);
    return block;
}

/// Where the points of a pair lie in a uniform grid; none if they do not.
Result<std::optional<GridGeometry>> latticeIn(const Files& files, const Plot3dLayout& layout) {
    const VtkSession session;
    const auto block = readBlock(session, files, layout, false);
    if (!block.isOk())
        return block.error();
    const auto points = pointsOf(*block.value(), files.grid);
    return points.isOk() ? Result<std::optional<GridGeometry>>(latticeOf(points.value(), layout.dims)) : points.error();
}

/// A uniform grid as it is, all others resampled.
Result<std::unique_ptr<VolumeSource>> sourceOf(vtkStructuredGrid& block, const Field& field, const GridDims& own,
                                               VolumeInfo info, const ReadOptions& options, const Files& files,
                                               const VtkSession& session) {
    vtkDataArray* values = block.GetPointData()->GetArray(field.vtkArray);
    if (values == nullptr || values->GetNumberOfComponents() <= field.vtkComponent ||
        values->GetNumberOfTuples() != pointCount(own))
        return session.error("not one value per point", files.solution);
    auto points = pointsOf(block, files.grid);
    if (!points.isOk())
        return std::move(points).error();
    if (const auto lattice = latticeOf(points.value(), own)) {
        ISO_TRY(checkGeometry(*lattice, "grid points", files.grid));
        auto grid = componentGrid(*lattice, *values, field.vtkComponent, files.solution);
        if (!grid.isOk())
            return std::move(grid).error();
        return makeMemorySource(std::make_shared<const ScalarGrid>(std::move(grid).value()), std::move(info));
    }
    const auto dims = resampledDims(options, kDefaultDims, files.solution);
    if (!dims.isOk())
        return dims.error();
    CurvilinearGrid curvilinear{own, std::move(points).value(), {}};
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
        curvilinear.values.push_back(static_cast<float>(values->GetComponent(i, field.vtkComponent)));
    info.geometry = boundingGeometry(curvilinear.points, dims.value());
    ISO_TRY(checkGeometry(info.geometry, "grid points", files.grid));
    return makeResampledSource(std::move(info), makeCurvilinearMesh(std::move(curvilinear)));
}

} // namespace

Result<VolumeContents> listPlot3d(const fs::path& path, const ReadOptions& options) {
    const auto files = findPair(path);
    if (!files.isOk())
        return files.error();
    const auto layout = checkPair(files.value(), options.memoryBytes);
    if (!layout.isOk())
        return layout.error();
    const auto lattice = latticeIn(files.value(), layout.value());
    if (!lattice.isOk())
        return lattice.error();
    VolumeContents contents;
    contents.format = "PLOT3D";
    contents.isPreferredChosen = true; // density, which every solution has and which needs no frame of reference
    for (const Field& field : kFields) {
        VolumeField listed;
        listed.name = std::string(field.name);
        listed.dims = lattice.value()                             ? layout.value().dims
                      : options.resampleDims == GridDims{0, 0, 0} ? kDefaultDims
                                                                  : options.resampleDims;
        listed.typeName = layout.value().isDouble ? "float64" : "float32";
        listed.isResampled = !lattice.value();
        contents.fields.push_back(std::move(listed));
    }
    return contents;
}

Result<std::unique_ptr<VolumeSource>> openPlot3d(const fs::path& path, const ReadOptions& options) {
    const Field* field = findField(options.field);
    if (field == nullptr)
        return refuseField(
            "field", "density, x momentum, y momentum, z momentum or energy expected, found " + inQuotes(options.field),
            path);
    const auto files = findPair(path);
    if (!files.isOk())
        return files.error();
    const auto layout = checkPair(files.value(), options.memoryBytes);
    if (!layout.isOk())
        return layout.error();
    VolumeInfo info;
    info.format = "PLOT3D";
    info.dataFiles = filesBeside(path, {{files.value().grid, 0}, {files.value().solution, 0}});
    info.fieldName = std::string(field->name);
    const VtkSession session;
    const auto block = readBlock(session, files.value(), layout.value(), true);
    if (!block.isOk())
        return block.error();
    return sourceOf(*block.value(), *field, layout.value().dims, std::move(info), options, files.value(), session);
}

} // namespace isoslider::io
