#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/extract/live/run_arena.h"
#include "core/extract/virtual_array.h"
#include "core/grid/brick_grid.h"

namespace isoslider::extract {

/// Runs of points whose bricks have left the surface, up to a number of them: a handle that comes back finds them, and
/// those who draw need not send them again. The ones that left first are given up first. put() and take() are O(1).
class KeptPoints {
public:
    struct Kept {
        ArenaRun run;
        std::uint32_t version = 0; ///< the move that put the points where they are
    };

    explicit KeptPoints(std::uint64_t brickCount) : linkOf_(brickCount) {}

    std::size_t bound() const { return bound_; }
    /// Where more are kept, giveUp() them.
    void setBound(std::size_t count) { bound_ = count; }
    std::size_t count() const { return count_; }

    /// REQUIRES: none of the brick are kept; the bound is not 0, and no more are kept. Returns the run that is given up
    /// for it, if any. Throws std::bad_alloc.
    std::optional<ArenaRun> put(BrickIndex brick, const Kept& kept);
    /// Gives back what is kept of the brick.
    std::optional<Kept> take(BrickIndex brick);
    /// Gives up the one that left first. REQUIRES: some are kept.
    ArenaRun giveUp();
    void clear() noexcept;
    /// Calls visit(Kept&) for each.
    template <class Visit>
    void forEach(const Visit& visit) {
        for (Node& node : nodes_)
            if (node.isUsed)
                visit(node.kept);
    }

private:
    using Link = std::uint32_t; ///< one more than a node's place; 0 for none
    struct Node {
        Kept kept;
        BrickIndex brick;
        Link newer = 0, older = 0;
        bool isUsed = false;
    };
    void unlink(Link link);
    Kept remove(Link link);

    std::size_t bound_ = 0, count_ = 0;
    VirtualArray<Link> linkOf_; ///< by brick
    std::vector<Node> nodes_;
    std::vector<Link> free_;
    Link newest_ = 0, oldest_ = 0;
};

} // namespace isoslider::extract
