#pragma once

#include <cstdint>
#include <memory>

#include "core/base/result.h"
#include "core/extract/brick_table.h"
#include "core/extract/change_source.h"
#include "core/extract/hidden_scalars.h"
#include "core/extract/run_allocator.h"
#include "core/extract/slow_cells.h"
#include "core/extract/surface_frame.h"
#include "core/extract/surface_mesh.h"
#include "core/extract/virtual_array.h"

namespace isoslider::extract {

/// The live surface: the paper's E, I (in buckets), V, N, H_E, H_C (3.2), kept per brick of 8^3
/// cells so that what changes together lies together. Knows nothing of where changes come from.
///
/// Layout. E, V, N are shared arrays in which each active brick owns one run with some room to grow;
/// a vertex index is the brick's begin plus the edge's slot. I is a shared array of triangles in
/// which each brick owns a run cut into buckets. Slots and runs do not move unless something is
/// deleted, so the triangles of cells that did not change stay as they are. Bricks with ambiguous cells
/// have a list of them (slow_cells.h), and those with inner vertices a further run of V and N.
///
/// A move is three steps, each parallel over bricks with nothing shared but the list of bricks:
///  1. edges: per brick, deletions, then additions into the holes, then compaction from the end
///     (paper 3.3); notes which edges changed or moved, and lists the bricks whose cells they touch;
///  2. triangles: bricks with a cell that crosses a saddle join the list; per listed brick, find the cells
///     at touched edges and their signs, 64 cells to a machine word, decide ambiguous ones that changed
///     or crossed, and patch them bucket by bucket, or lay the brick out anew when many changed or a
///     bucket is full. Both cells of a face decide it from its four scalars in the same move;
///  3. interpolation of V and N over all bricks, then inner vertices.
/// Work of 1 and 2 is in proportion to the change; of 3 to the active edges.
template <class Live>
class ActiveSurface {
public:
    /// `missingCells` and `hidden` must outlive the surface; missing cells are sorted by brick.
    ActiveSurface(const GridGeometry& geometry, const std::vector<index::MissingCells>& missingCells, HiddenScalars& hidden);
    ~ActiveSurface();

    /// Drops everything: the empty surface.
    void clear();
    /// Steps 1 and 2: to `isovalue`, which the changes lead to. Errors: Corruption when a change contradicts
    /// the live state (an active edge activated, an inactive one deactivated, a face with an odd number);
    /// those of HiddenScalars. Call clear() then.
    Status apply(const ChangeSet<Live>& changes, double isovalue, SlideStats& stats);
    /// Step 3.
    void interpolate(double isovalue);

    std::uint64_t activeEdges() const { return activeEdges_; }
    std::uint64_t triangles() const { return triangles_; }
    bool isEmpty() const { return table_.bricks().empty(); }
    /// Bytes of the live state: arrays as far as they are used, bricks, tables.
    std::uint64_t memoryBytes() const;

    void copyFrame(SurfaceFrame& frame) const;
    SurfaceMesh mesh(double isovalue) const;

private:
    struct Neighbourhood;
    struct Scratch;

    void chainChanges(const ChangeSet<Live>& changes, unsigned partition, Scratch& scratch);
    bool applyToBrick(Brick& brick, Scratch& scratch);
    void growVertices(Brick& brick, std::uint32_t count);
    void activate(Brick& brick, const ActivatedEdge<Live>& change, std::uint32_t slot);
    void clearBrick(Brick& brick, Scratch& scratch);
    void closeHoles(Brick& brick, Scratch& scratch);
    void listBricks(Brick& brick, Scratch& scratch);

    void listCrossedBricks(double isovalue);
    Neighbourhood neighbourhood(const Brick& brick) const;
    void retriangulate(Brick& brick, double isovalue, Scratch& scratch);
    bool findStates(Brick& brick, const Neighbourhood& around, double isovalue, Scratch& scratch);
    bool findSigns(Brick& brick, const Neighbourhood& around, Scratch& scratch) const;
    int solveSigns(const Neighbourhood& around, LocalPoint cell) const;
    void keepDecided(Brick& brick, double isovalue, Scratch& scratch) const;
    bool decide(Brick& brick, const Neighbourhood& around, LocalPoint cell, double isovalue, Scratch& scratch);
    bool resolveAmbiguous(Brick& brick, const Neighbourhood& around, double isovalue, Scratch& scratch);
    cell::CornerScalars scalarsOf(const Neighbourhood& around, LocalPoint cell, std::uint8_t signs) const;
    void assignInnerVertices(Brick& brick, Scratch& scratch);
    bool isLowerEndBelow(const Brick& brick, LocalEdge edge) const;
    void placeInnerVertices(const SlowCells& slow, double isovalue);
    bool patchCells(Brick& brick, const Neighbourhood& around, Scratch& scratch);
    void layOutBrick(Brick& brick, const Neighbourhood& around);
    void removeRun(Brick& brick, LocalPoint cell, int bucket);
    void releaseInnerRun(SlowCells& slow);
    void releaseEmptyBricks(const std::vector<Brick*>& candidates);

    GridGeometry geometry_;
    glm::vec3 inverseSpacing_;
    HiddenScalars& hidden_;
    BrickTable table_;
    SlowCellTable slowCells_;

    // E
    VirtualArray<Live> scalars1_, scalars2_;
    VirtualArray<std::uint32_t> edgeNormals_;
    VirtualArray<LocalEdge> edges_;
    // V, N, I; the cell that each first triangle of a run belongs to
    VirtualArray<glm::vec3> positions_, normals_;
    VirtualArray<std::uint32_t> indices_;
    VirtualArray<LocalPoint> runOwners_;

    RunAllocator vertexRuns_;
    RunAllocator triangleRuns_;
    std::uint64_t activeEdges_ = 0;
    std::uint64_t triangles_ = 0;
    std::uint64_t ambiguousCells_ = 0;
    std::vector<Brick*> dirtyBricks_; ///< of the last move: what glows
    tbb::enumerable_thread_specific<Scratch> scratches_;
};

extern template class ActiveSurface<float>;
extern template class ActiveSurface<double>;

} // namespace isoslider::extract
