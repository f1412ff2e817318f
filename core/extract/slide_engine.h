#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/base/job_control.h"
#include "core/extract/merged/merge_bound.h"
#include "core/extract/surface_frame.h"
#include "core/extract/surface_mesh.h"
#include "core/grid/brick_box.h"
#include "core/grid/scalar_grid.h"
#include "core/index/format/index_info.h"
#include "core/index/index_reader.h"

namespace isoslider::extract {

/// What is kept of an index in memory unless it is stated otherwise: a 16th of what the process may use, between 256 MB
/// and 4 GB. And where little is read again.
std::uint64_t indexCacheBytes();
inline constexpr std::uint64_t kSmallCacheBytes = std::uint64_t{64} << 20;

struct SlideOptions {
    std::optional<std::uint64_t> cacheBytes; ///< bound on decoded pages, samples and points kept in memory
    bool readsAhead = true; ///< between moves, what the next one in the same direction would need is read
    /// Skip levels that jumps come to need are built in the background, and kept beside the index.
    bool buildsLevels = true;
    /// What each vertex is made from is kept side by side, 16 bytes: for who wants all of them as floats after every
    /// move (expandVertices()). Where scalars live as double it always is.
    bool keepsGroups = false;
};

/// What a frame is to hold beside the surface.
struct FrameContents {
    bool changes = false; ///< the triangles that the last move has changed, unless all are new
    bool pieces = false; ///< which triangles are connected; none in a frame for which there was no memory
    /// Of a frame of the same grid, of another engine or surface: their numbers are kept. Null: those of the last
    /// frame.
    std::shared_ptr<const SurfacePieces> piecesBefore;
};

/// Within which the cells of an index were merged when it was built.
MergeError builtError(const index::IndexInfo& info);

/// The live surface over one index or volume: moves from isovalue to isovalue and keeps the arrays current.
/// One thread at a time (it uses TBB inside). After a failed or cancelled move the engine holds no
/// surface; the next move builds it again.
class SlideEngine {
public:
    /// Errors: NotFound, IoError, Corruption, UnsupportedVersion.
    static Result<std::unique_ptr<SlideEngine>> open(const std::filesystem::path& indexPath,
                                                     const SlideOptions& options = {});
    /// On a volume in memory; `brickList` is the skip list of its bricks (preprocess/metacells/brick_list.h makes
    /// both).
    static std::unique_ptr<SlideEngine> onVolume(std::shared_ptr<const ScalarGrid> grid,
                                                 std::unique_ptr<index::IndexReader> brickList,
                                                 const SlideOptions& options = {});
    virtual ~SlideEngine() = default;

    virtual const index::IndexInfo& info() const = 0;

    /// Moves the surface to `isovalue`. O(log N + K), K the edges that change, plus interpolation of
    /// the active edges. Errors: Cancelled, IoError, Corruption, InvalidArgument (NaN); the surface is empty after all
    /// but the last, and the next move begins from there.
    virtual Result<SlideStats> slideTo(double isovalue, const JobControl& job = {}) = 0;

    /// Of the surface as it is.
    virtual MergeBound mergeBound() const = 0;
    /// From the next move on, cells are merged within the bound (PAPER 2.2), to the size of a brick at most; the
    /// surface is then extractMerged()'s. Until then within that which the index was built with.
    virtual void setMergeBound(const MergeBound& bound) = 0;

    /// In which the surface is as it stands; none: in all of the volume.
    virtual std::optional<BrickBox> region() const = 0;
    /// From the next move on, the surface has whole bricks of the region and nothing else: a move costs what changes
    /// there. To merged cells of bricks at its border, what lies beyond is as fine as the grid. The first move after it
    /// looks at all active bricks.
    virtual void setRegion(const std::optional<BrickBox>& region) = 0;

    /// Waits until nothing is read ahead any more, and no level is built.
    virtual void waitForPrefetch() = 0;
    /// Forgets what is kept of the index. The surface stays; the next move reads again what it needs.
    virtual void dropCaches() = 0;

    /// The surface as the window needs it: its bricks, or arrays where scalars are kept as double. Pieces keep their
    /// numbers from frame to frame as long as every one of them asks for pieces.
    virtual void copyFrame(SurfaceFrame& frame, const FrameContents& contents = {}) = 0;
    /// The surface, as far as it lies in the region, welded and compacted, in grid order: comparable with extractFull,
    /// extractMerged.
    /// Errors: Cancelled, OutOfSpace (more than 2^32 vertices). O(n log n).
    virtual Result<SurfaceMesh> mesh(const JobControl& job = {}) const = 0;
};

} // namespace isoslider::extract
