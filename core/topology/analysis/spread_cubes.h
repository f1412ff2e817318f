#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "core/base/job_control.h"
#include "core/topology/analysis/layer_window.h"
#include "core/topology/topology_analysis.h"

namespace isoslider::topology {

/// Cubes to look at: how many, spread over the volume, and how large where it holds them.
struct SpreadCubes {
    std::int64_t levels = 8; ///< along z; fewer in a thin volume
    std::int64_t places = 4; ///< on each
    std::int64_t side = 48, planes = 6; ///< grid points
};

/// What look(window, origin) returns for each as if it were a separate volume, in their order; `window` is prepared.
/// Some are looked at at once. Planes are read in ascending order, once. O(cubes). Errors: those of the source;
/// Cancelled.
template <class Seen, class Sample, class Look>
Result<std::vector<Seen>> lookAtCubes(const PlaneSource& source, const SpreadCubes& cubes, const JobControl& job,
                                      const Look& look) {
    constexpr double kStepX = 0.7548776662, kStepY = 0.5698402910; // no two places in a row or column
    const GridDims& dims = source.geometry.dims;
    const GridDims cube{std::min(dims[0], cubes.side), std::min(dims[1], cubes.side), std::min(dims[2], cubes.planes)};
    std::vector<Seen> seen;
    std::vector<Sample> planes(static_cast<std::size_t>(dims[0] * dims[1] * cube[2]));
    std::int64_t end = 0;
    for (std::int64_t level = 0; level < cubes.levels; ++level) {
        const std::int64_t z = (2 * level + 1) * (dims[2] - cube[2]) / (2 * cubes.levels);
        if (level > 0 && z < end)
            continue;
        end = z + cube[2];
        ISO_TRY(source.read(z, end, std::as_writable_bytes(std::span(planes))));
        const std::size_t first = seen.size();
        seen.resize(first + static_cast<std::size_t>(cubes.places));
        tbb::parallel_for(std::int64_t{0}, cubes.places, [&](std::int64_t i) {
            if (job.isStopRequested())
                return;
            const auto spread = [&](double step, std::int64_t most) {
                const double at = step * static_cast<double>(cubes.places * level + i + 1);
                return static_cast<std::int64_t>((at - std::floor(at)) * static_cast<double>(most + 1));
            };
            const std::array<std::int64_t, 3> origin{spread(kStepX, dims[0] - cube[0]),
                                                     spread(kStepY, dims[1] - cube[1]), z};
            LayerWindow<Sample> window;
            window.dims = cube;
            window.zEnd = cube[2] - 1;
            window.stop = job.stop;
            for (std::int64_t dz = 0; dz < cube[2]; ++dz)
                for (std::int64_t dy = 0; dy < cube[1]; ++dy) {
                    const auto row = planes.begin() + origin[0] + dims[0] * (origin[1] + dy + dims[1] * dz);
                    window.samples.insert(window.samples.end(), row, row + cube[0]);
                }
            window.prepare();
            seen[first + static_cast<std::size_t>(i)] = look(window, origin);
        });
        if (job.isStopRequested())
            return cancelledError();
    }
    return seen;
}

} // namespace isoslider::topology
