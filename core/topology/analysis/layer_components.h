#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/topology/analysis/component_graph.h"
#include "core/topology/analysis/layer_euler.h"
#include "core/topology/analysis/layer_window.h"

namespace isoslider::topology {

/// Of a grid point without a cell.
inline constexpr std::uint32_t kNoSeed = std::numeric_limits<std::uint32_t>::max();

/// The components of one side within one layer, and what ties them to the layers around it.
struct LayerComponents {
    std::vector<Seed> seeds;
    std::vector<Link> links;
    std::vector<std::uint32_t> bottom, top; ///< the seed that each grid point of the outer planes leads to
};

/// Every grid point leads to a seed along neighbours that come ever earlier: what it joins first, so that no other of
/// its links matters until then. Links between seeds follow. O(points), nearly.
template <class Sample>
LayerComponents findLayerComponents(Side side, const LayerWindow<Sample>& window, std::span<const CornerJoin> joins);

} // namespace isoslider::topology
