#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell/cell_states.h"
#include "core/cell/undecided_cells.h"
#include "core/extract/live/active_bits.h"
#include "core/extract/live/brick_bits.h"
#include "core/extract/live/brick_points.h"
#include "core/extract/live/brick_slot.h"
#include "core/extract/live/cell_triangles.h"
#include "core/extract/live/edge_record.h"
#include "core/extract/live/merged_cells.h"
#include "core/extract/live/retired_runs.h"
#include "core/extract/live/run_arena.h"
#include "core/extract/live/vertex_code.h"
#include "core/extract/live/vertex_kernels.h"
#include "core/extract/merged/merge_bound.h"

namespace isoslider::extract {

/// An active cell whose signs do not determine its surface, and the isovalues between which its state lasts: face
/// saddles and body saddles change it where no edge changes.
struct AmbiguousCell {
    cell::StateInterval interval{};
    ClosedPoint cell{};
    cell::StateId state = 0;
    std::uint8_t signs = 0, innerVertices = 0; ///< of the state
};
static_assert(sizeof(AmbiguousCell) == 24);

/// The corner scalars of ambiguous cells, from wherever a brick's contents come.
class CornerScalarsOfBrick {
public:
    virtual ~CornerScalarsOfBrick() = default;
    virtual cell::CornerScalars scalarsOf(ClosedPoint cell) const = 0;
    /// The same of the first cells of `undecided`.
    virtual void fill(std::span<const ClosedPoint> cells, cell::UndecidedCells& undecided) const = 0;
};

/// Ambiguous cells of a brick that have not kept their states.
struct UndecidedOfBrick {
    cell::UndecidedCells cells;
    std::array<ClosedPoint, cell::UndecidedCells::kMost> places;
    std::array<std::uint16_t, cell::UndecidedCells::kMost> numbers; ///< in the brick's list of ambiguous cells
    std::array<std::int32_t, cell::UndecidedCells::kMost> before; ///< their last states; -1: none
    std::array<cell::ResolvedCell, cell::UndecidedCells::kMost> resolved;
};

/// What is made of a brick before it takes its place in the live surface: scratch memory of one thread.
template <class Live>
struct BrickDraft {
    BitString above; ///< points at or above the isovalue
    ActiveBits active; ///< of merged cells only the edges that have a vertex
    MergedCells merged;
    BitString changed; ///< cells to point out as changed; a superset of the active ones will do
    std::uint32_t ownedEdges = 0;
    std::uint32_t edgeVertices = 0;
    /// Of the active edges, in their order; room for those inside cells.
    alignas(64) std::array<VertexCode, kMaxEdgeCodes + CellList::kMost * cell::kMaxInnerVertices> codes;
    VertexTable vertices; ///< their numbers
    const PointLine* newPoints = nullptr; ///< null where the brick's points stay as they are

    // Filled by the surface from what stands above.
    CellList cells;
    std::vector<std::uint16_t> indices;
    std::uint32_t indexCount = 0;
    std::vector<AmbiguousCell> ambiguous;
    UndecidedOfBrick undecided;
    std::array<EdgeRecord<Live>, kMaxBrickEdges> records; ///< where there are vertices inside merged cells
    std::array<VertexGroup<Live>, groupCount(kMaxBrickEdges)> groups; ///< where the surface keeps them
    std::vector<InnerRecord> inner;
    struct { ///< vertices on edges that those inside cells depend on
        std::vector<VertexCode> codes;
        std::vector<glm::vec3> positions, normals;
    } innerEdges;
    std::vector<BrickSlot> replaced; ///< slots, since the move began
    std::vector<RetiredRuns> retired; ///< likewise: what pictures still refer to
    struct Counts { ///< since the move began
        std::int64_t activeEdges = 0, triangles = 0, ambiguousCells = 0; ///< differences
        std::array<std::int64_t, kMaxMergeLevel + 1> leaves{}; ///< likewise, by level
        std::uint64_t cellsDecided = 0, cellsChanged = 0;
    } counts;
    ShortArena::Ahead verticesAhead, indicesAhead; ///< runs of this thread's next bricks

    void beginMove() {
        verticesAhead.clear(); // after a move that has failed they are of no arena
        indicesAhead.clear();
        replaced.clear();
        retired.clear();
        counts = {};
    }
};

} // namespace isoslider::extract
