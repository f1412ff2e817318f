#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/grid/scalar_key.h"
#include "core/index/format/index_format.h"
#include "core/index/format/point_record.h"
#include "preprocess/edges/merged_layers.h"
#include "preprocess/edges/slab_window.h"
#include "preprocess/levels/block_intervals.h"

namespace isoslider::preprocess {

/// What some bricks of a layer (8 z planes) turn into.
template <class Key>
struct LayerRecords {
    BrickIndex firstBrick;
    /// One list per brick, in brick order; each in point id order.
    std::vector<std::vector<index::PointRecord<Key>>> bricks;
    std::vector<index::MissingCells> missingCells;
    /// Keys of points without a record though a neighbour differs or is missing: they have no usable
    /// edge, and would be overlooked when distinct values are counted.
    std::vector<std::uint64_t> keysWithoutEdges;
};

/// Planes below and above a layer that its records depend on.
inline constexpr std::int64_t kLayerApron = 1;
inline constexpr std::int64_t kLayerPlanes = kBrickSide + 2 * kLayerApron;

/// Bricks whose records are in memory at once.
inline constexpr std::size_t kBricksAtOnce = 256;

template <class Key>
using ConsumeRecords = std::function<Status(const LayerRecords<Key>&)>;

/// Generates the records of brick layer `layer` (PAPER 3.1, "we consider all edges connected to the
/// corresponding point"), and hands them to `consume`, kBricksAtOnce bricks at a time. A point has a record when it has
/// at least one usable edge to an unequal scalar; an edge is usable when both ends are finite and one of its four cells
/// is whole.
/// REQUIRES: `window` holds the layer's planes and the apron, cut off at the box.
/// `merged`, if not null, decides which cells are merged, layer by layer: edges then carry vertices on leaf edges of
/// any level, at times, and the leaves have records, too (record_form); points that are left without edges have a
/// record without any, so that their values are counted. Adds every edge once to one of `histograms`. As many threads
/// as there are of these work side by side; the sum and all else does not depend on their number. Errors: those of
/// `consume`, which end it.
template <class Sample>
Status generateLayer(const SlabWindow<Sample>& window, const GridGeometry& geometry, std::int64_t layer,
                     const KeyIntervals& bins, std::span<SpanHistogram> histograms, MergedLayers<Sample>* merged,
                     const ConsumeRecords<KeyOf<Sample>>& consume);

} // namespace isoslider::preprocess
