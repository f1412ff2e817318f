#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/grid/brick_grid.h"
#include "core/grid/classification.h"
#include "core/grid/edge_cells.h"
#include "core/grid/scalar_key.h"
#include "preprocess/edges/slab_window.h"

namespace isoslider::preprocess {

/// The planes of a layer of bricks and one on either side, prepared once: keys, missing flags.
template <class Sample>
class PreparedLayer {
public:
    using Key = KeyOf<Sample>;

    PreparedLayer(const SlabWindow<Sample>& window, const GridGeometry& geometry, std::int64_t layer)
        : dims_(geometry.dims), plane_(dims_[0] * dims_[1]) {
        begin_ = std::max<std::int64_t>(0, layer * kBrickSide - 1);
        end_ = std::min(dims_[2], (layer + 1) * kBrickSide + 1);
        const std::size_t count = static_cast<std::size_t>((end_ - begin_) * plane_);
        keys_.resize(count);
        missing_.resize(count);
        tbb::parallel_for(begin_, end_, [&](std::int64_t z) { preparePlane(window.plane(z), z); });
        hasMissing_ = std::any_of(missing_.begin(), missing_.end(), [](std::uint8_t m) { return m != 0; });
    }

    std::size_t at(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return static_cast<std::size_t>(x + dims_[0] * y + plane_ * (z - begin_));
    }
    Key key(std::size_t i) const { return keys_[i]; }
    const Key* keysFrom(std::size_t i) const { return keys_.data() + i; }
    bool missing(std::size_t i) const { return missing_[i] != 0; }
    bool hasMissing() const { return hasMissing_; }
    const GridDims& dims() const { return dims_; }
    std::ptrdiff_t stride(int axis) const {
        return axis == 0 ? 1 : axis == 1 ? static_cast<std::ptrdiff_t>(dims_[0]) : static_cast<std::ptrdiff_t>(plane_);
    }

    // A cell whose planes are here; outside the box no cell is valid.
    bool isCellValid(std::int64_t x, std::int64_t y, std::int64_t z) const {
        if (x < 0 || y < 0 || z < 0 || x + 1 >= dims_[0] || y + 1 >= dims_[1] || z + 1 >= dims_[2])
            return false;
        const std::size_t i = at(x, y, z);
        for (int c = 0; c < 8; ++c)
            if (missing_[i + static_cast<std::size_t>((c & 1) + (c >> 1 & 1) * stride(1) + (c >> 2) * stride(2))])
                return false;
        return true;
    }

    bool hasValidCell(std::int64_t x, std::int64_t y, std::int64_t z, int axis) const {
        return isoslider::hasValidCell(x, y, z, axis, [this](auto... cell) { return isCellValid(cell...); });
    }

private:
    void preparePlane(const Sample* sample, std::int64_t z) {
        const std::size_t first = at(0, 0, z);
        for (std::size_t i = first; i < first + static_cast<std::size_t>(plane_); ++i, ++sample) {
            missing_[i] = isMissing(*sample);
            if (!missing_[i])
                keys_[i] = keyOf(*sample);
        }
    }

    GridDims dims_;
    std::int64_t plane_;
    std::int64_t begin_ = 0;
    std::int64_t end_ = 0;
    bool hasMissing_ = false;
    std::vector<Key> keys_;
    std::vector<std::uint8_t> missing_;
};

} // namespace isoslider::preprocess
