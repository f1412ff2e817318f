#include "core/volume_io/formats/vtk/vtk_dataset.h"

#include <cmath>

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnstructuredGrid.h>

#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/resampling/point_lattice.h"
#include "core/volume_io/resampling/rectilinear_resampler.h"

namespace isoslider::io {
namespace {

using Opened = Result<std::unique_ptr<VolumeSource>>;

std::vector<float> floatsOf(vtkDataArray& array, int component) {
    std::vector<float> values(static_cast<std::size_t>(array.GetNumberOfTuples()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto tuple = static_cast<vtkIdType>(i);
        double value = 0.0;
        if (component != kMagnitude) {
            value = array.GetComponent(tuple, component);
        } else {
            for (int c = 0; c < array.GetNumberOfComponents(); ++c)
                value = std::hypot(value, array.GetComponent(tuple, c));
        }
        values[i] = static_cast<float>(value);
    }
    return values;
}

Result<std::vector<glm::dvec3>> pointsOf(vtkPoints* points, vtkIdType count, const std::filesystem::path& path) {
    if (points == nullptr || points->GetNumberOfPoints() != count)
        return refuseField("Points", "not as many as the grid has", path);
    std::vector<glm::dvec3> out;
    out.reserve(static_cast<std::size_t>(count));
    for (vtkIdType i = 0; i < count; ++i) {
        double p[3];
        points->GetPoint(i, p);
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
            return makeError(ErrorCode::InvalidArgument, "point " + std::to_string(i) + " is not finite", path);
        out.emplace_back(p[0], p[1], p[2]);
    }
    return out;
}

/// The uniform grid over the points' box, as the options state.
Result<GridGeometry> boxOf(const std::vector<glm::dvec3>& points, const ReadOptions& options,
                           const std::filesystem::path& path) {
    const GridGeometry corners = boundingGeometry(points, {2, 2, 2});
    const glm::dvec3 high = corners.origin + corners.spacing;
    const auto dims =
        resampledDims(options, evenDims(corners.origin, high, static_cast<std::int64_t>(points.size())), path);
    if (!dims.isOk())
        return dims.error();
    GridGeometry geometry = boundingGeometry(points, dims.value());
    ISO_TRY(checkGeometry(geometry, "Points", path));
    return geometry;
}

Opened ofImage(vtkImageData& image, vtkDataArray& array, int component, VolumeInfo info,
               const std::filesystem::path& path) {
    const int* sizes = image.GetDimensions();
    info.geometry = geometryOf(image, {sizes[0], sizes[1], sizes[2]});
    ISO_TRY(checkGeometry(info.geometry, "Spacing, Origin, Direction", path));
    auto grid = componentGrid(info.geometry, array, component, path);
    if (!grid.isOk())
        return std::move(grid).error();
    return makeMemorySource(std::make_shared<const ScalarGrid>(std::move(grid).value()), std::move(info));
}

Result<std::array<GridAxis, 3>> axesOf(vtkRectilinearGrid& rectilinear, const std::filesystem::path& path) {
    constexpr const char* kNames[] = {"X coordinates", "Y coordinates", "Z coordinates"};
    vtkDataArray* coordinates[] = {rectilinear.GetXCoordinates(), rectilinear.GetYCoordinates(),
                                   rectilinear.GetZCoordinates()};
    int sizes[3];
    rectilinear.GetDimensions(sizes);
    std::array<GridAxis, 3> axes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (coordinates[axis] == nullptr || sizes[axis] < 1 || coordinates[axis]->GetNumberOfTuples() != sizes[axis])
            return refuseField(kNames[axis], "not as many as the grid has points", path);
        std::vector<double> places;
        for (vtkIdType i = 0; i < sizes[axis]; ++i)
            places.push_back(coordinates[axis]->GetComponent(i, 0));
        auto made = makeAxis(std::move(places), kNames[axis], path);
        if (!made.isOk())
            return std::move(made).error();
        if (made.value().isDescending) // VTK itself takes only ascending ones
            return refuseField(kNames[axis], "descend; ascending ones are expected", path);
        axes[axis] = std::move(made).value();
    }
    return axes;
}

Opened ofRectilinear(vtkRectilinearGrid& rectilinear, vtkDataArray& array, int component, VolumeInfo info,
                     const ReadOptions& options, const std::filesystem::path& path) {
    auto axes = axesOf(rectilinear, path);
    if (!axes.isOk())
        return std::move(axes).error();
    int sizes[3];
    rectilinear.GetDimensions(sizes);
    info.geometry.dims = {sizes[0], sizes[1], sizes[2]};
    auto grid = componentGrid(info.geometry, array, component, path);
    if (!grid.isOk())
        return std::move(grid).error();
    auto source = makeMemorySource(std::make_shared<const ScalarGrid>(std::move(grid).value()), std::move(info));
    return placeOnAxes(std::move(source), std::move(axes).value(), options, path);
}

Opened ofStructured(vtkStructuredGrid& structured, vtkDataArray& array, int component, VolumeInfo info,
                    const ReadOptions& options, const std::filesystem::path& path) {
    int sizes[3];
    structured.GetDimensions(sizes);
    CurvilinearGrid grid;
    grid.dims = {sizes[0], sizes[1], sizes[2]};
    if (sizes[0] < 2 || sizes[1] < 2 || sizes[2] < 2)
        return refuseField("dims", "the grid is a surface: it has no cells with a volume", path);
    auto points = pointsOf(structured.GetPoints(), array.GetNumberOfTuples(), path);
    if (!points.isOk())
        return std::move(points).error();
    if (const auto lattice = latticeOf(points.value(), grid.dims)) { // it is uniform already
        ISO_TRY(checkGeometry(*lattice, "Points", path));
        auto samples = componentGrid(*lattice, array, component, path);
        if (!samples.isOk())
            return std::move(samples).error();
        return makeMemorySource(std::make_shared<const ScalarGrid>(std::move(samples).value()), std::move(info));
    }
    const auto geometry = boxOf(points.value(), options, path);
    if (!geometry.isOk())
        return geometry.error();
    info.geometry = geometry.value();
    grid.points = std::move(points).value();
    grid.values = floatsOf(array, component);
    return makeResampledSource(std::move(info), makeCurvilinearMesh(std::move(grid)));
}

Opened ofUnstructured(vtkUnstructuredGrid& grid, vtkDataArray& array, int component, VolumeInfo info,
                      const ReadOptions& options, const std::filesystem::path& path) {
    const auto points = pointsOf(grid.GetPoints(), array.GetNumberOfTuples(), path);
    if (!points.isOk())
        return points.error();
    if (points.value().empty())
        return refuseField("Points", "there are none", path);
    const auto geometry = boxOf(points.value(), options, path);
    if (!geometry.isOk())
        return geometry.error();
    info.geometry = geometry.value();
    auto mesh = makeUnstructuredMesh(&grid, floatsOf(array, component), info.notes, path);
    if (!mesh.isOk())
        return std::move(mesh).error();
    return makeResampledSource(std::move(info), std::move(mesh).value());
}

} // namespace

Opened sourceOf(vtkDataSet& data, vtkDataArray& array, int component, VolumeInfo info, const ReadOptions& options,
                const std::filesystem::path& path) {
    if (auto* image = vtkImageData::SafeDownCast(&data))
        return ofImage(*image, array, component, std::move(info), path);
    if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&data))
        return ofRectilinear(*rectilinear, array, component, std::move(info), options, path);
    if (auto* structured = vtkStructuredGrid::SafeDownCast(&data))
        return ofStructured(*structured, array, component, std::move(info), options, path);
    if (auto* unstructured = vtkUnstructuredGrid::SafeDownCast(&data))
        return ofUnstructured(*unstructured, array, component, std::move(info), options, path);
    return refuseField("type", "is not a kind of grid that is read", path);
}

Result<VtkOutlook> outlookOf(vtkDataSet& data, const ReadOptions& options, const std::filesystem::path& path) {
    int sizes[3] = {0, 0, 0};
    if (auto* image = vtkImageData::SafeDownCast(&data))
        image->GetDimensions(sizes);
    if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&data)) {
        rectilinear->GetDimensions(sizes);
        const auto axes = axesOf(*rectilinear, path);
        if (!axes.isOk())
            return axes.error();
        if (!(axes.value()[0].isEven && axes.value()[1].isEven && axes.value()[2].isEven)) {
            const auto dims = resampledDims(options, defaultDims(axes.value(), options.memoryBytes), path);
            return dims.isOk() ? Result<VtkOutlook>(VtkOutlook{dims.value(), true}) : dims.error();
        }
    }
    if (auto* pointSet = vtkPointSet::SafeDownCast(&data)) {
        const auto points = pointsOf(pointSet->GetPoints(), data.GetNumberOfPoints(), path);
        if (!points.isOk())
            return points.error();
        if (points.value().empty())
            return refuseField("Points", "there are none", path);
        if (auto* structured = vtkStructuredGrid::SafeDownCast(&data)) {
            structured->GetDimensions(sizes);
            if (latticeOf(points.value(), {sizes[0], sizes[1], sizes[2]}))
                return VtkOutlook{{sizes[0], sizes[1], sizes[2]}, false};
        }
        const auto geometry = boxOf(points.value(), options, path);
        return geometry.isOk() ? Result<VtkOutlook>(VtkOutlook{geometry.value().dims, true}) : geometry.error();
    }
    return VtkOutlook{{sizes[0], sizes[1], sizes[2]}, false};
}

} // namespace isoslider::io
