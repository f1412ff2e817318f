#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/extract/live/leaves_around.h"
#include "core/extract/sources/edge_block_source.h"

namespace isoslider::extract {

/// What a thread changes bricks in.
template <class Sample>
struct EdgeBlockSource<Sample>::Scratch {
    BrickDraft<Live> draft;
    Points points; ///< of a brick that gets new ones
    // Changes of the partition at hand, brick by brick.
    std::vector<CrossedPoint<Key>> crossed;
    std::vector<CrossedNormals> normals;
    std::vector<ChangedEdge> edges;
    std::vector<TouchedBrick> byBrick; // of a partition, by place in it; nothing between uses
    bool isByBrickInUse = false;
    std::vector<BrickIndex> arriving; // bricks that have no slot yet
    ToggledEdges toggled; // of the brick at hand
    ChangedBrick changed; // likewise
    LeavesAround around;
    std::vector<std::pair<BrickSlot, BrickLeaves>> otherLeaves; // bricks whose leaves change, and what they were
    std::vector<BrickSlot> emptied;
    std::optional<Error> error;
    bool isConsistent = true;

    /// Of a brick of the partition at hand, before whose changes there are so many.
    Changes changesOf(const TouchedBrick& brick, std::size_t pointsBefore, std::size_t edgesBefore) const {
        Changes changes;
        changes.points = std::span(crossed).subspan(pointsBefore, brick.points);
        if (!normals.empty())
            changes.normals = std::span(normals).subspan(pointsBefore, brick.points);
        changes.edges = std::span(edges).subspan(edgesBefore, brick.edges);
        changes.hasActivated = brick.hasActivated;
        return changes;
    }
    void beginMove() {
        draft.beginMove();
        if (isByBrickInUse) // a move has failed, for want of memory
            byBrick.clear();
        isByBrickInUse = false;
        arriving.clear();
        emptied.clear();
        otherLeaves.clear();
        error.reset();
        isConsistent = true;
    }
};

// Calls visit(brick, edge) for the closed bricks that hold the edge: where it lies on a brick's lower face, the brick
// below does, too.
template <class Sample>
template <class Visit>
void EdgeBlockSource<Sample>::forEachHolder(PointId start, int axis, const Visit& visit) const {
    const BrickGrid& grid = reader_.grid();
    const BrickIndex brick = brickOf(start);
    const int local = localOf(start).number();
    const std::array<int, 3> c{local & 7, local >> 3 & 7, local >> 6};
    const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
    const ClosedEdge base = closedEdge(axis, closedPoint(c[0], c[1], c[2]));
    const auto at = grid.brickCoords(brick);
    for (int k = 0; k < 4; ++k) {
        const bool isBelowU = k & 1, isBelowV = k >> 1;
        if ((isBelowU && (c[u] > 0 || at[u] == 0)) || (isBelowV && (c[v] > 0 || at[v] == 0)))
            continue;
        const bool hasCells =
            at[u] - isBelowU < cellBricks_[static_cast<int>(u)] && at[v] - isBelowV < cellBricks_[static_cast<int>(v)];
        if (!hasCells)
            continue;
        const BrickIndex holder = brick - ((isBelowU ? grid.brickStride(static_cast<int>(u)) : 0) +
                                           (isBelowV ? grid.brickStride(static_cast<int>(v)) : 0));
        const ClosedEdge edge =
            base + ((isBelowU ? kCellSide * kPointStride[u] : 0) + (isBelowV ? kCellSide * kPointStride[v] : 0));
        visit(holder, edge);
    }
}

} // namespace isoslider::extract
