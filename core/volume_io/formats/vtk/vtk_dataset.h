#pragma once

#include <vtkSmartPointer.h>

#include "core/volume_io/formats/format_readers.h"
#include "core/volume_io/formats/vtk/vtk_bridge.h"
#include "core/volume_io/formats/vtk/vtk_kind.h"
#include "core/volume_io/resampling/resampled_source.h"

class vtkDataSet;
class vtkUnstructuredGrid;

// From what VTK has read to a source. For the sources of this folder only.

namespace isoslider::io {

/// One component of the point array, or its magnitude, as samples of a uniform grid: those of an image as they are, of
/// a rectilinear grid too if its axes are even, else resampled. Without options, what is resampled has as many
/// points as the grid of the file: a rectilinear one the same along each axis, others evenly spaced. A structured grid
/// whose points are a lattice is one of an image. REQUIRES: as many tuples as `data` has points, within a session.
/// Errors: InvalidArgument, Corruption, OutOfSpace.
Result<std::unique_ptr<VolumeSource>> sourceOf(vtkDataSet& data, vtkDataArray& array, int component, VolumeInfo info,
                                               const ReadOptions& options, const std::filesystem::path& path);

/// What sourceOf would make of a grid, found from the places of its points alone.
struct VtkOutlook {
    GridDims dims{0, 0, 0};
    bool isResampled = false;
};
/// Errors: as sourceOf.
Result<VtkOutlook> outlookOf(vtkDataSet& data, const ReadOptions& options, const std::filesystem::path& path);

/// Cells of an unstructured grid, with one value per point. States in `notes` which cells are left out.
/// Errors: Corruption (cells that refer to points which are not there), InvalidArgument (no cells with a volume).
Result<std::unique_ptr<SourceMesh>> makeUnstructuredMesh(vtkSmartPointer<vtkUnstructuredGrid> grid,
                                                         std::vector<float> values, std::vector<std::string>& notes,
                                                         const std::filesystem::path& path);

} // namespace isoslider::io
