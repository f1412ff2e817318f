#include "core/topology/topology_forecast.h"

#include <algorithm>
#include <vector>

#include "core/topology/analysis/distinct_growth.h"
#include "core/topology/analysis/spread_cubes.h"
#include "core/topology/analysis/strip_changes.h"

namespace isoslider::topology {
namespace {

// As encoded: measured on scans, simulations and functions.
constexpr double kCurvesBytes = 8192.0, kBytesPerEvent = 13.3, kBytesPerPreciseEvent = 15.0;

// The isovalues of an event each, in one cube. What the cube's own sides bring about is left out; where these are the
// volume's, it counts.
template <class Sample>
class CubeEvents {
public:
    CubeEvents(const GridDims& dims, const std::array<std::int64_t, 3>& origin, const GridDims& cube) : cube_(cube) {
        for (std::size_t a = 0; a < 3; ++a) {
            begin_[a] = origin[a] == 0 ? 0 : 1;
            end_[a] = origin[a] + cube[a] == dims[a] ? cube[a] : cube[a] - 1;
        }
    }
    double points() const {
        double product = 1.0;
        for (std::size_t a = 0; a < 3; ++a)
            product *= static_cast<double>(std::max<std::int64_t>(0, end_[a] - begin_[a]));
        return product;
    }
    std::vector<double> isovalues(const LayerWindow<Sample>& window) const {
        const Strip whole = window.wholeStrip();
        StripSide above(Side::Above), below(Side::Below);
        above.flood(window, whole);
        below.flood(window, whole);
        std::vector<double> found;
        for (const EulerChange& change : findStripChanges(window, whole, above, below).euler) {
            if (change.euler() == 0)
                continue;
            const auto point = static_cast<std::int64_t>(change.cause().point());
            const std::array<std::int64_t, 3> at{point % cube_[0], point / cube_[0] % cube_[1],
                                                 point / (cube_[0] * cube_[1])};
            bool isOwn = true;
            for (std::size_t a = 0; a < 3; ++a)
                isOwn = isOwn && at[a] >= begin_[a] && at[a] < end_[a];
            if (isOwn)
                found.push_back(change.isovalue);
        }
        return found;
    }

private:
    GridDims cube_;
    std::array<std::int64_t, 3> begin_{}, end_{};
};

template <class Sample>
Result<std::uint64_t> forecast(const PlaneSource& source, const JobControl& job) {
    const GridDims& dims = source.geometry.dims;
    if (std::min({dims[0], dims[1], dims[2]}) < 2 || dims[0] * dims[1] >= kMostPlaneSamples)
        return std::uint64_t{0};
    struct Seen {
        double points = 0.0;
        std::vector<double> isovalues;
    };
    auto cubes = lookAtCubes<Seen, Sample>(
        source, {.levels = 8, .places = 16, .side = 18, .planes = 10}, job,
        [&](const LayerWindow<Sample>& window, const std::array<std::int64_t, 3>& origin) -> Seen {
            const CubeEvents<Sample> events(dims, origin, window.dims);
            return {events.points(), events.isovalues(window)};
        });
    if (!cubes.isOk())
        return std::move(cubes).error();
    std::vector<std::vector<double>> isovalues;
    double points = 0.0;
    for (Seen& seen : cubes.value()) {
        points += seen.points;
        isovalues.push_back(std::move(seen.isovalues));
    }
    if (!(points > 0.0))
        return std::uint64_t{0};
    const double events = distinctInAll(isovalues, static_cast<double>(pointCount(dims)) / points);
    return static_cast<std::uint64_t>(kCurvesBytes +
                                      events * (sizeof(Sample) > 2 ? kBytesPerPreciseEvent : kBytesPerEvent));
}

} // namespace

Result<std::uint64_t> forecastTopologyBytes(const PlaneSource& source, const JobControl& job) {
    return visitScalarType(source.type, [&](auto sample) { return forecast<decltype(sample)>(source, job); });
}

} // namespace isoslider::topology
