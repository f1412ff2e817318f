#pragma once

#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/grid/scalar_grid.h"
#include "core/volume_io/sources/volume_source.h"
#include "preprocess/build_index.h"

namespace isoslider::test {

/// A volume from a function of the grid point, cast to the sample type.
template <class Sample, class Function>
std::shared_ptr<const ScalarGrid> makeVolume(ScalarType type, const GridGeometry& geometry, Function&& valueAt) {
    std::vector<Sample> values;
    values.reserve(static_cast<std::size_t>(pointCount(geometry.dims)));
    for (std::int64_t z = 0; z < geometry.dims[2]; ++z)
        for (std::int64_t y = 0; y < geometry.dims[1]; ++y)
            for (std::int64_t x = 0; x < geometry.dims[0]; ++x)
                values.push_back(static_cast<Sample>(valueAt(x, y, z)));
    return std::make_shared<const ScalarGrid>(ScalarGrid::fromValues<Sample>(geometry, type, values));
}

inline GridGeometry cubeGeometry(std::int64_t side) {
    GridGeometry geometry;
    geometry.dims = {side, side, side};
    return geometry;
}

inline Result<preprocess::BuildReport> buildIndexOf(const std::shared_ptr<const ScalarGrid>& grid,
                                                    const std::filesystem::path& path,
                                                    const preprocess::BuildOptions& options = {},
                                                    const JobControl& job = {}) {
    const auto source = io::makeMemorySource(grid);
    return preprocess::buildIndex(*source, path, options, job);
}

/// u8 noise of a few values: many ties, many ambiguous cells, edges redundant at every level.
inline std::shared_ptr<const ScalarGrid> noiseVolume(const GridDims& dims, unsigned seed, unsigned values = 20) {
    GridGeometry geometry;
    geometry.dims = dims;
    std::mt19937 random(seed);
    return makeVolume<std::uint8_t>(ScalarType::U8, geometry, [&](auto, auto, auto) { return random() % values; });
}

/// Two smooth hills and a slope, in the range 0 to 1000 or so.
inline std::shared_ptr<const ScalarGrid> hillsVolume(const GridDims& dims) {
    GridGeometry geometry;
    geometry.dims = dims;
    return makeVolume<std::uint16_t>(ScalarType::U16, geometry, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
        const auto hill = [&](double cx, double cy, double cz) {
            const double u = static_cast<double>(x) / static_cast<double>(dims[0]) - cx;
            const double v = static_cast<double>(y) / static_cast<double>(dims[1]) - cy;
            const double w = static_cast<double>(z) / static_cast<double>(dims[2]) - cz;
            return 900.0 * std::exp(-8.0 * (u * u + v * v + w * w));
        };
        return hill(0.3, 0.4, 0.5) + hill(0.7, 0.6, 0.4) + static_cast<double>(x);
    });
}

} // namespace isoslider::test
