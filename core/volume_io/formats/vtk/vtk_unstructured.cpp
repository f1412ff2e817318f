#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>

#include <tbb/parallel_for.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include "core/volume_io/formats/vtk/vtk_dataset.h"
#include "core/volume_io/parsing/header_checks.h"

// Each cell of the mesh fills the grid points inside it, by VTK's own interpolation in cells of its type. Not
// vtkProbeFilter: it neither stops on request nor states how far it is.

namespace isoslider::io {
namespace {

constexpr std::int64_t kSlabPlanes = 4;
constexpr double kTolerance = 1e-6; // of a spacing: neighbours share their faces but for rounding
constexpr std::size_t kMaxCellPoints = 27;

/// Cells with a volume and with a fixed number of points.
struct CellKind {
    int type;
    vtkIdType points;
};
constexpr CellKind kCellKinds[] = {{VTK_TETRA, 4},
                                   {VTK_VOXEL, 8},
                                   {VTK_HEXAHEDRON, 8},
                                   {VTK_WEDGE, 6},
                                   {VTK_PYRAMID, 5},
                                   {VTK_PENTAGONAL_PRISM, 10},
                                   {VTK_HEXAGONAL_PRISM, 12},
                                   {VTK_QUADRATIC_TETRA, 10},
                                   {VTK_QUADRATIC_HEXAHEDRON, 20},
                                   {VTK_QUADRATIC_WEDGE, 15},
                                   {VTK_QUADRATIC_PYRAMID, 13},
                                   {VTK_TRIQUADRATIC_HEXAHEDRON, 27},
                                   {VTK_QUADRATIC_LINEAR_WEDGE, 12},
                                   {VTK_BIQUADRATIC_QUADRATIC_WEDGE, 18},
                                   {VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, 24}};

vtkIdType pointsOfKind(int type) {
    const auto* found = std::find_if(std::begin(kCellKinds), std::end(kCellKinds),
                                     [type](const CellKind& kind) { return kind.type == type; });
    return found == std::end(kCellKinds) ? 0 : found->points;
}

/// VTK takes wedges and curved tetrahedra for cubes when it states whether a place is inside them.
bool isInTriangle(int type, const double* place) {
    constexpr double kVtkTolerance = 1e-3; // what VTK itself lets pass at the other sides
    switch (type) {
        case VTK_WEDGE:
        case VTK_QUADRATIC_WEDGE:
        case VTK_QUADRATIC_LINEAR_WEDGE:
        case VTK_BIQUADRATIC_QUADRATIC_WEDGE: return place[0] + place[1] <= 1.0 + kVtkTolerance;
        case VTK_QUADRATIC_TETRA: return place[0] + place[1] + place[2] <= 1.0 + kVtkTolerance;
        default: return true;
    }
}

/// A cell and the box it may fill, in index units of the output.
struct BoxedCell {
    vtkIdType id;
    glm::dvec3 low, high;
};

struct Range {
    std::int64_t begin, end;
};
Range indexRange(double low, double high, std::int64_t begin, std::int64_t end) {
    const double first = std::max(std::ceil(low - kTolerance), static_cast<double>(begin));
    const double last = std::min(std::floor(high + kTolerance), static_cast<double>(end - 1));
    if (!(first <= last))
        return {begin, begin};
    return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(last) + 1};
}

class UnstructuredMesh final : public SourceMesh {
public:
    UnstructuredMesh(vtkSmartPointer<vtkUnstructuredGrid> grid, std::vector<float> values, std::vector<vtkIdType> cells)
        : grid_(std::move(grid)), values_(std::move(values)), cells_(std::move(cells)) {}

    std::span<const float> values() const override { return values_; }
    glm::dvec3 point(std::size_t index) const override {
        double p[3];
        grid_->GetPoints()->GetPoint(static_cast<vtkIdType>(index), p);
        return {p[0], p[1], p[2]};
    }

    Result<ScalarGrid> resample(const GridGeometry& geometry, const JobControl& job) override {
        const VtkSession session; // VTK prints warnings about inverted cells
        const auto boxes = boxesIn(geometry);
        const vtkNew<vtkGenericCell> first; // VTK prepares what it needs on the first call, by one thread
        if (!cells_.empty())
            grid_->GetCell(cells_[0], first);
        std::vector<float> samples(static_cast<std::size_t>(pointCount(geometry.dims)),
                                   std::numeric_limits<float>::quiet_NaN());
        const std::int64_t slabs = (geometry.dims[2] + kSlabPlanes - 1) / kSlabPlanes;
        std::atomic<std::int64_t> finished = 0;
        std::mutex progressMutex;
        tbb::parallel_for(std::int64_t{0}, slabs, [&](std::int64_t slab) {
            const vtkNew<vtkGenericCell> cell;
            const Range planes{slab * kSlabPlanes, std::min((slab + 1) * kSlabPlanes, geometry.dims[2])};
            for (const BoxedCell& box : boxes) {
                const Range z = indexRange(box.low.z, box.high.z, planes.begin, planes.end);
                if (job.isStopRequested())
                    return;
                if (z.begin < z.end)
                    fill(box, z, geometry, *cell, samples);
            }
            const std::scoped_lock lock(progressMutex);
            job.report(static_cast<double>(++finished) / static_cast<double>(slabs), "resampling");
        });
        if (job.isStopRequested())
            return cancelledError();
        return ScalarGrid::fromValues<float>(geometry, ScalarType::F32, samples);
    }

private:
    std::vector<BoxedCell> boxesIn(const GridGeometry& geometry) const {
        std::vector<BoxedCell> boxes;
        boxes.reserve(cells_.size());
        for (const vtkIdType id : cells_) {
            vtkIdType count = 0;
            const vtkIdType* points = nullptr;
            grid_->GetCellPoints(id, count, points);
            BoxedCell box{id, glm::dvec3(std::numeric_limits<double>::infinity()),
                          glm::dvec3(-std::numeric_limits<double>::infinity())};
            for (vtkIdType i = 0; i < count; ++i) {
                const glm::dvec3 at = (point(static_cast<std::size_t>(points[i])) - geometry.origin) / geometry.spacing;
                box.low = glm::min(box.low, at);
                box.high = glm::max(box.high, at);
            }
            boxes.push_back(box);
        }
        return boxes;
    }

    void fill(const BoxedCell& box, const Range& z, const GridGeometry& geometry, vtkGenericCell& cell,
              std::vector<float>& samples) const {
        const Range x = indexRange(box.low.x, box.high.x, 0, geometry.dims[0]);
        const Range y = indexRange(box.low.y, box.high.y, 0, geometry.dims[1]);
        if (x.begin >= x.end || y.begin >= y.end)
            return;
        grid_->GetCell(box.id, &cell);
        const double tolerance = kTolerance * std::min({geometry.spacing.x, geometry.spacing.y, geometry.spacing.z});
        for (std::int64_t k = z.begin; k < z.end; ++k)
            for (std::int64_t j = y.begin; j < y.end; ++j)
                for (std::int64_t i = x.begin; i < x.end; ++i) {
                    float& sample =
                        samples[static_cast<std::size_t>(i + geometry.dims[0] * (j + geometry.dims[1] * k))];
                    if (!std::isnan(sample))
                        continue; // the first cell counts
                    const glm::dvec3 at = geometry.origin + geometry.spacing * glm::dvec3(i, j, k);
                    sample = valueIn(cell, at, tolerance * tolerance);
                }
    }

    /// NaN outside the cell.
    float valueIn(vtkGenericCell& cell, const glm::dvec3& at, double tolerance2) const {
        const double x[3] = {at.x, at.y, at.z};
        double closest[3], place[3], distance2 = 0.0;
        std::array<double, kMaxCellPoints> weights{};
        int part = 0;
        const int inside = cell.EvaluatePosition(x, closest, part, place, distance2, weights.data());
        if (inside < 0 || (inside == 0 && !(distance2 <= tolerance2)) || !isInTriangle(cell.GetCellType(), place))
            return std::numeric_limits<float>::quiet_NaN();
        double sum = 0.0;
        for (vtkIdType i = 0; i < cell.GetNumberOfPoints(); ++i)
            sum += weights[static_cast<std::size_t>(i)] *
                   static_cast<double>(values_[static_cast<std::size_t>(cell.GetPointId(static_cast<int>(i)))]);
        return static_cast<float>(sum);
    }

    vtkSmartPointer<vtkUnstructuredGrid> grid_;
    std::vector<float> values_;
    std::vector<vtkIdType> cells_; ///< those with a volume
};

/// VTK trusts all of this.
Status checkCells(vtkUnstructuredGrid& grid, const std::filesystem::path& path) {
    const auto damaged = [&](const std::string& problem) {
        return makeError(ErrorCode::Corruption, "Cells: " + problem, path);
    };
    vtkCellArray* cells = grid.GetCells();
    if (cells == nullptr || grid.GetCellTypesArray() == nullptr ||
        grid.GetCellTypesArray()->GetNumberOfValues() != grid.GetNumberOfCells())
        return damaged("not one type for each");
    vtkDataArray* offsets = cells->GetOffsetsArray();
    if (offsets == nullptr || offsets->GetNumberOfTuples() != grid.GetNumberOfCells() + 1 ||
        offsets->GetComponent(0, 0) != 0.0)
        return damaged("not one list of points for each");
    vtkIdType last = 0;
    const vtkIdType entries = cells->GetNumberOfConnectivityIds();
    for (vtkIdType id = 0; id < grid.GetNumberOfCells(); ++id) {
        const auto end = static_cast<vtkIdType>(offsets->GetComponent(id + 1, 0));
        if (end < last || end > entries)
            return damaged("cell " + std::to_string(id) + " has no usable list of points");
        last = end;
        vtkIdType count = 0;
        const vtkIdType* points = nullptr;
        cells->GetCellAtId(id, count, points);
        for (vtkIdType i = 0; i < count; ++i)
            if (points[i] < 0 || points[i] >= grid.GetNumberOfPoints())
                return damaged("cell " + std::to_string(id) + " refers to point " + std::to_string(points[i]) + " of " +
                               std::to_string(grid.GetNumberOfPoints()));
        const vtkIdType expected = pointsOfKind(grid.GetCellType(id));
        if (expected > 0 && count != expected)
            return damaged("cell " + std::to_string(id) + " has " + std::to_string(count) + " points, its type " +
                           std::to_string(expected));
    }
    return {};
}

} // namespace

Result<std::unique_ptr<SourceMesh>> makeUnstructuredMesh(vtkSmartPointer<vtkUnstructuredGrid> grid,
                                                         std::vector<float> values, std::vector<std::string>& notes,
                                                         const std::filesystem::path& path) {
    ISO_TRY(checkCells(*grid, path));
    std::vector<vtkIdType> cells;
    for (vtkIdType id = 0; id < grid->GetNumberOfCells(); ++id)
        if (pointsOfKind(grid->GetCellType(id)) > 0)
            cells.push_back(id);
    if (cells.empty())
        return refuseField("Cells",
                           "none has a volume and a type that is read (tetrahedra, hexahedra, wedges, "
                           "pyramids, prisms)",
                           path);
    const auto left = grid->GetNumberOfCells() - static_cast<vtkIdType>(cells.size());
    if (left > 0)
        notes.push_back(std::to_string(left) + " cells without volume, or of a type that is not read, are left out");
    return std::unique_ptr<SourceMesh>(
        std::make_unique<UnstructuredMesh>(std::move(grid), std::move(values), std::move(cells)));
}

} // namespace isoslider::io
