#include "core/topology/analysis/strip_cut.h"

#include <algorithm>
#include <cmath>

namespace isoslider::topology {
namespace {

// Where rows or planes are very long layers are thinner: nobody has gigabytes for one. A strip has kMostPoints at
// most, whatever is asked for.
constexpr std::int64_t kStripSamples = 1 << 17, kMostStripSamples = 1 << 20, kMostLayerSamples = 1 << 26,
                       kMostPoints = 1 << 30;
constexpr std::int64_t kUsualPlanes = 16, kFewestPlanes = 3, kFewestRows = 24;

} // namespace

StripCut::StripCut(const GridDims& dims, const Wanted& wanted)
    : dims_{std::max<std::int64_t>(1, dims[0]), std::max<std::int64_t>(1, dims[1]), dims[2]}, wanted_(wanted) {
    const std::int64_t mostPlanes =
        std::max(kFewestPlanes, std::min(kUsualPlanes, kMostPoints / (dims_[0] * dims_[1]) - 2));
    planes_ = wanted.planes > 0 ? std::clamp(wanted.planes, kFewestPlanes, mostPlanes) : usualPlanes();
    rows_ = rowsFor(planes_);
}

std::int64_t StripCut::usualPlanes() const {
    const std::int64_t plane = dims_[0] * dims_[1];
    const std::int64_t fitting =
        wanted_.isWhole ? kStripSamples / plane
                        : std::min(kMostStripSamples / (kFewestRows * dims_[0]), kMostLayerSamples / plane);
    return std::clamp(fitting, kFewestPlanes, kUsualPlanes);
}

std::int64_t StripCut::rowsFor(std::int64_t planes) const {
    const std::int64_t all = std::max<std::int64_t>(1, dims_[1] - 1);
    if (wanted_.isWhole)
        return all;
    const std::int64_t usual = std::max(kFewestRows, kStripSamples / (planes * dims_[0]));
    return std::clamp<std::int64_t>(wanted_.rows > 0 ? wanted_.rows : usual, 1, all);
}

std::int64_t StripCut::stripCount() const { return (dims_[1] - 2 + rows_) / rows_; }

Strip StripCut::stripAt(std::int64_t number) const {
    const auto rowAt = [this](std::int64_t strip) { return (dims_[1] - 1) * strip / stripCount(); };
    return {rowAt(number), rowAt(number + 1)};
}

double StripCut::samplesOfStrip() const {
    return static_cast<double>(dims_[0] * std::min(dims_[1], rows_ + 1) * std::min(dims_[2], planes_ + 2));
}

double StripCut::layersBytes(double strips, std::size_t sampleBytes) const {
    const double layers = strips > 1.0 ? 2.0 + std::floor((strips - 2.0) / static_cast<double>(stripCount())) : 1.0;
    const auto plane = static_cast<double>(dims_[0] * dims_[1]);
    return layers * layerBytes(plane * static_cast<double>(std::min(dims_[2], planes_ + 2)), sampleBytes) +
           planeBytes(plane);
}

double StripCut::stripsBytes(double strips, const Findings& ofCell) const {
    return bytesOfStrips(strips, stripBytes(samplesOfStrip(), ofCell * samplesOfStrip()));
}

// Seeds of grid points in two planes, and in two rows between each strip and the next.
double StripCut::betweenBytes(const Findings& ofCell) const {
    if (wanted_.isWhole)
        return coarseBytes(static_cast<double>(dims_[0] * dims_[1]), ofCell * samplesOfStrip());
    const std::int64_t shared = 2 * dims_[0] * (dims_[1] + (stripCount() - 1) * std::min(dims_[2], planes_ + 1));
    return openBytes(ofCell * static_cast<double>(shared));
}

double StripCut::bytes(double strips, std::size_t sampleBytes, const Findings& ofCell) const {
    return layersBytes(strips, sampleBytes) + stripsBytes(strips, ofCell) + betweenBytes(ofCell);
}

bool StripCut::shrink(double strips, std::size_t sampleBytes, const Findings& ofCell) {
    const bool mayBeThinner = wanted_.planes == 0 && planes_ > kFewestPlanes;
    const bool mayBeNarrower = wanted_.rows == 0 && !wanted_.isWhole && rows_ > kFewestRows;
    const bool areStripsMost = stripsBytes(strips, ofCell) > layersBytes(strips, sampleBytes);
    if (mayBeNarrower && (areStripsMost || !mayBeThinner))
        rows_ = std::max(kFewestRows, rows_ / 2);
    else if (mayBeThinner && areStripsMost)
        --planes_;
    else if (mayBeThinner)
        rows_ = rowsFor(--planes_);
    else
        return false;
    return true;
}

} // namespace isoslider::topology
