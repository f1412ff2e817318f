#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/analysis/link_collector.h"

namespace isoslider::topology {

/// Of a grid point without a cell.
inline constexpr std::uint32_t kNoSeed = std::numeric_limits<std::uint32_t>::max();

/// A grid point at which components meet.
struct PointMeeting {
    std::uint32_t at; ///< from the strip's first grid point
    std::uint8_t apart; ///< neighbours along edges: one of each component but that which the point leads to
};

/// The components of one side within one strip, and what ties them to those around it.
struct StripComponents {
    ComponentGraph graph; ///< what may still matter
    std::vector<std::uint32_t> bottom, top; ///< the seed that each grid point of the outer planes leads to
    std::vector<std::uint32_t> front, back; ///< and of the first and the last row, plane by plane
    std::vector<double> opens; ///< by seed: the earliest isovalue of those of the upper plane; NaN: none
    ComponentHistory settled; ///< what came and went within the strip
};

/// One side of a strip while it is worked on; after that of the next one, which finds what memory it takes. Every grid
/// point leads to a seed along neighbours that come ever earlier: what it joins first, so that no other of its links
/// matters until then. Links between seeds follow.
class StripSide {
public:
    explicit StripSide(Side side) : side_(side), links_(side) {}

    /// Finds seeds, and links along edges of the grid. O(points), nearly.
    template <class Sample>
    void flood(const LayerWindow<Sample>& window, const Strip& strip);
    /// Whether a link of two grid points with cells could matter. Places count from the strip's first grid point.
    bool areApart(std::int64_t a, std::int64_t b) const {
        return leadsTo_[static_cast<std::size_t>(a)] != leadsTo_[static_cast<std::size_t>(b)];
    }
    void join(double isovalue, Cause cause, std::int64_t a, std::int64_t b) {
        links_.add(isovalue, cause, leadsTo_[static_cast<std::size_t>(a)], leadsTo_[static_cast<std::size_t>(b)]);
    }
    std::size_t seedCount() const { return seeds_.size(); }
    std::size_t linkCount() const { return links_.count(); }
    /// All seeds, and the links between them that matter; nothing settled, no `opens`.
    StripComponents takeForest();
    /// What other strips may have a part in, and the rest as settled. REQUIRES: that which was flooded.
    template <class Sample>
    StripComponents takeSettled(const LayerWindow<Sample>& window, const Strip& strip);

private:
    StripComponents sidesOf() const;

    Side side_;
    std::size_t row_ = 0, plane_ = 0; ///< points of each
    std::vector<std::uint32_t> leadsTo_; ///< by grid point: a seed
    std::vector<PointMeeting> meetings_;
    std::vector<Seed> seeds_;
    LinkCollector links_;
    ComponentGraph graph_; ///< while it is settled
};

} // namespace isoslider::topology
