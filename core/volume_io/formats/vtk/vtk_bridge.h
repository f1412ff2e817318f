#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

#include <vtkSmartPointer.h>

#include "core/base/result.h"
#include "core/grid/scalar_grid.h"

class vtkDataArray;
class vtkImageData;
class vtkOutputWindow;

// What the readers that rest on VTK share. For the sources of this folder only.

namespace isoslider::io {

class QuietWindow;

/// While it lives, VTK prints nothing and what it complains about is kept. VTK reports through one
/// window for the whole process, so only one session exists at a time: the next waits.
class VtkSession {
public:
    VtkSession();
    ~VtkSession();
    VtkSession(const VtkSession&) = delete;
    VtkSession& operator=(const VtkSession&) = delete;

    /// VTK's first complaint, on one line without class names and addresses; empty if there is none.
    std::string complaint() const;
    /// Likewise the first warning. VTK merely warns where it gives up on text and leaves values unset.
    std::string warning() const;
    /// Corruption, with the complaint or, failing one, `otherwise`.
    Error error(std::string_view otherwise, const std::filesystem::path& path) const;

private:
    std::scoped_lock<std::mutex> lock_;
    vtkSmartPointer<vtkOutputWindow> before_;
    vtkSmartPointer<QuietWindow> window_;
};

/// A copy of one component per point. Unsigned 32-bit and all 64-bit integers become f64.
/// REQUIRES: as many values as `geometry` has points. Errors: InvalidArgument (no type of scalars,
/// or a 64-bit sample without an exact f64).
Result<ScalarGrid> toGrid(const GridGeometry& geometry, vtkDataArray& array, const std::filesystem::path& path);

/// Likewise one component of several, or kMagnitude: f32, or f64 of values beyond 16 bits or f32.
Result<ScalarGrid> componentGrid(const GridGeometry& geometry, vtkDataArray& array, int component,
                                 const std::filesystem::path& path);

/// Where VTK states that an image lies; `dims` are those already checked.
GridGeometry geometryOf(vtkImageData& image, const GridDims& dims);

} // namespace isoslider::io
