#pragma once

#include <cstddef>
#include <cstdint>

#include "core/grid/grid_geometry.h"
#include "core/topology/analysis/analysis_memory.h"
#include "core/topology/analysis/layer_window.h"

namespace isoslider::topology {

/// How a volume is cut into layers and these into strips: large enough that little is said twice, small enough for the
/// caches and for the memory there is.
class StripCut {
public:
    /// What is asked for; 0: as is best.
    struct Wanted {
        std::int64_t planes = 0; ///< of cells in a layer; 3 to 16, fewer where planes are very large
        std::int64_t rows = 0; ///< of cells in a strip
        bool isWhole = false; ///< a strip is all of its layer
    };
    StripCut(const GridDims& dims, const Wanted& wanted);

    std::int64_t planes() const { return planes_; }
    std::int64_t stripCount() const;
    /// REQUIRES: 0 <= number < stripCount().
    Strip stripAt(std::int64_t number) const;

    /// Bytes of so many strips worked on at once, of the layers that they are part of, and of what is left of strips
    /// until their layer is there. `ofCell`: what is found in a cell, on average.
    double bytes(double strips, std::size_t sampleBytes, const Findings& ofCell) const;
    /// Takes less for what takes most. False: there is nothing that may be less.
    bool shrink(double strips, std::size_t sampleBytes, const Findings& ofCell);

private:
    std::int64_t usualPlanes() const;
    std::int64_t rowsFor(std::int64_t planes) const;
    double layersBytes(double strips, std::size_t sampleBytes) const;
    double stripsBytes(double strips, const Findings& ofCell) const;
    double betweenBytes(const Findings& ofCell) const;
    double samplesOfStrip() const;

    GridDims dims_;
    Wanted wanted_;
    std::int64_t planes_ = 0, rows_ = 0; ///< of cells
};

} // namespace isoslider::topology
