#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "core/base/job_control.h"
#include "core/extract/slide_engine.h"
#include "core/extract/surface_frame.h"
#include "core/extract/surface_mesh.h"
#include "core/grid/scalar_grid.h"
#include "ui/model/jobs/index_builder.h"

namespace isoslider::model {

/// Where the slide worker gets surfaces from: a volume in memory, an index, or a test's fake.
/// One thread at a time.
class SurfaceSource {
public:
    virtual ~SurfaceSource() = default;

    /// Moves to `isovalue` and fills `frame`, whose buffers may hold an older picture to be
    /// overwritten, whose `marksChanges` states whether the changed triangles are wanted, and whose `mergeBound` how
    /// far merged cells may differ; a source that cannot merge sets that to none. Its `region` states where the surface
    /// is wanted; it is none afterwards where pieces are wanted, which are of the whole, or the source has no other.
    /// With `findsPieces`, its `geometry` and `pieces` are those of the frame before. On failure the frame's content is
    /// unspecified, and the next move starts without a surface. Errors: Cancelled, IoError, Corruption,
    /// InvalidArgument, OutOfSpace.
    virtual Status moveTo(double isovalue, const JobControl& job, extract::SurfaceFrame& frame) = 0;
    /// The whole surface at the isovalue of the last move, welded.
    virtual Result<extract::SurfaceMesh> mesh(const JobControl& job) = 0;
};

/// Extracts the whole surface at every move: for the time before an index is there.
std::unique_ptr<SurfaceSource> makeFullExtractionSource(std::shared_ptr<const ScalarGrid> grid);
/// Slides on the volume in memory, with an engine that is made at the first move; extracts the whole surface
/// where `builder` is null or has none.
std::unique_ptr<SurfaceSource> makeMemorySource(std::shared_ptr<const ScalarGrid> grid,
                                                std::shared_ptr<IndexBuilder> builder);
/// Slides along an index.
std::unique_ptr<SurfaceSource> makeIndexSource(std::unique_ptr<extract::SlideEngine> engine);

/// Makes another source of the same volume each time; on any thread.
using SourceOpener = std::function<Result<std::unique_ptr<SurfaceSource>>(const JobControl&)>;
SourceOpener openerOfIndex(std::filesystem::path index);
SourceOpener openerOfMemory(std::shared_ptr<const ScalarGrid> grid, std::shared_ptr<IndexBuilder> builder);

} // namespace isoslider::model
