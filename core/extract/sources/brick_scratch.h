#pragma once

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/extract/live/leaves_around.h"
#include "core/extract/sources/brick_source.h"

namespace isoslider::extract {

/// What a thread makes a brick in.
template <class Sample>
struct BrickSource<Sample>::Scratch {
    Points points; ///< of a brick that arrives
    ClassifiedBrick<Stored> found;
    ClassifiedLeafEdges<Stored> foundOnEdges;
    BitString aboveBefore; ///< the signs that the brick had, where the surface does not have them
    BrickDraft<Live> draft;
    std::vector<Job> pending; ///< jobs that want samples which are not ready yet
    std::vector<BrickIndex> read; ///< bricks whose samples were
    LeavesAround around;
    LinesAhead ahead; ///< of a brick that is made soon
    /// Bricks whose leaves are others now, and what they were.
    std::vector<std::pair<BrickSlot, BrickLeaves>> otherLeaves;
    std::uint64_t bricks = 0, edgesAdded = 0, edgesRemoved = 0;
    bool isConsistent = true; ///< the list has as many edges as bricks have
};

// Where the points of the job's brick are: those that it will have from now on.
template <class Sample>
auto BrickSource<Sample>::pointsOf(const LiveSurface<Live>& surface, const Job& job, const Scratch& scratch)
    -> const Points& {
    return scratch.draft.newPoints ? scratch.points : pointsIn<Sample>(surface.points(job.slot));
}

// The corner scalars of cells of one brick.
template <class Sample>
class BrickSource<Sample>::Corners final : public CornerScalarsOfBrick {
public:
    explicit Corners(const Points& points) : points_(points) {}
    cell::CornerScalars scalarsOf(ClosedPoint cell) const override {
        cell::CornerScalars scalars;
        for (unsigned c = 0; c < 8; ++c)
            scalars[c] = scalarAt(cell, c);
        return scalars;
    }
    void fill(std::span<const ClosedPoint> cells, cell::UndecidedCells& undecided) const override {
        for (std::size_t i = 0; i < cells.size(); ++i)
            for (unsigned c = 0; c < 8; ++c)
                undecided.scalars[c][i] = scalarAt(cells[i], c);
    }

private:
    double scalarAt(ClosedPoint cell, unsigned c) const {
        return static_cast<double>(
            sampleOf<Sample>(points_.samples[cell.index() + (c & 1) + 9 * (c >> 1 & 1) + 81 * (c >> 2)]));
    }

    const Points& points_;
};

} // namespace isoslider::extract
