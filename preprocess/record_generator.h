#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/scalar_key.h"
#include "core/index/hidden_corner_codec.h"
#include "core/index/index_format.h"
#include "core/index/point_record.h"
#include "preprocess/block_intervals.h"
#include "preprocess/slab_window.h"

namespace isoslider::preprocess {

/// What one layer of bricks (8 z planes) turns into.
template <class Key>
struct LayerRecords {
    /// One list per brick of the layer, in brick order; each in point id order.
    std::vector<std::vector<index::PointRecord<Key>>> bricks;
    /// Likewise; ascending by place.
    std::vector<std::vector<index::HiddenCorner>> hiddenCorners;
    std::vector<index::MissingCells> missingCells;
    /// Keys of points without a record though a neighbour differs or is missing: they have no usable
    /// edge, and would be overlooked when distinct values are counted.
    std::vector<std::uint64_t> lonelyKeys;
};

/// Planes below and above a layer that its records depend on: neighbours, and their gradients.
inline constexpr std::int64_t kLayerApron = 2;

/// Generates the records of brick layer `layer` (paper 3.1, "we consider all edges connected to the
/// corresponding point"). A point has a record when it has at least one usable edge to an unequal
/// scalar; an edge is usable when both ends are finite and one of its four cells is whole.
/// REQUIRES: `window` holds the layer's planes and the apron, cut off at the box.
/// Brick-parallel; the result does not depend on the number of threads. Adds every edge once to
/// `histogram`.
template <class Sample>
void generateLayer(const SlabWindow<Sample>& window, const GridGeometry& geometry, std::int64_t layer,
                   const SpanBins& bins, SpanHistogram& histogram, LayerRecords<KeyOf<Sample>>& out);

} // namespace isoslider::preprocess
