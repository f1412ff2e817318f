#include "core/volume_io/resampling/resampled_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/matrix.hpp>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

/// A point this close to a plane of grid points, in cells, lies on it: else rounding would make points on the
/// border depend on missing neighbours.
constexpr double kOnPlane = 1e-6;

class ResampledSource final : public WholeGridSource {
public:
    ResampledSource(VolumeInfo info, std::unique_ptr<SourceMesh> mesh)
        : info_(std::move(info)), mesh_(std::move(mesh)) {
        info_.type = ScalarType::F32;
    }

    const VolumeInfo& info() const override { return info_; }

    Result<std::shared_ptr<const ScalarGrid>> grid(const JobControl& job) override {
        if (grid_)
            return grid_;
        auto made = mesh_->resample(info_.geometry, job);
        if (!made.isOk())
            return std::move(made).error();
        info_.resampling = compareWithSource(made.value(), *mesh_);
        grid_ = std::make_shared<const ScalarGrid>(std::move(made).value());
        mesh_.reset();
        return grid_;
    }

private:
    VolumeInfo info_;
    std::unique_ptr<SourceMesh> mesh_;
    std::shared_ptr<const ScalarGrid> grid_;
};

class CurvilinearMesh final : public SourceMesh {
public:
    explicit CurvilinearMesh(CurvilinearGrid grid) : grid_(std::move(grid)) {}

    Result<ScalarGrid> resample(const GridGeometry& geometry, const JobControl& job) override {
        return resampleCurvilinear(grid_, geometry, job);
    }
    std::span<const float> values() const override { return grid_.values; }
    glm::dvec3 point(std::size_t index) const override { return grid_.points[index]; }

private:
    CurvilinearGrid grid_;
};

/// A place on one axis of a grid: between grid points `first` and first + 1, or at `first` if weight is 0.
struct Place {
    std::int64_t first;
    double weight;
};

std::optional<Place> placeOn(double at, std::int64_t count) {
    const double nearest = std::round(at);
    if (std::abs(at - nearest) < kOnPlane)
        at = nearest;
    if (!(at >= 0.0 && at <= static_cast<double>(count - 1)))
        return std::nullopt;
    const double first = std::floor(at);
    return Place{static_cast<std::int64_t>(first), at - first};
}

/// Trilinear; NaN outside the grid. A corner without weight has no say, missing or not.
double interpolated(std::span<const float> values, const GridDims& dims, const glm::dvec3& at) {
    std::array<Place, 3> places{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto place = placeOn(at[axis], dims[static_cast<std::size_t>(axis)]);
        if (!place)
            return std::numeric_limits<double>::quiet_NaN();
        places[static_cast<std::size_t>(axis)] = *place;
    }
    double sum = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        std::array<std::int64_t, 3> index{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool isUpper = (corner >> axis & 1) != 0;
            index[axis] = places[axis].first + isUpper;
            weight *= isUpper ? places[axis].weight : 1.0 - places[axis].weight;
        }
        if (weight > 0.0)
            sum += weight * values[static_cast<std::size_t>(index[0] + dims[0] * (index[1] + dims[1] * index[2]))];
    }
    return sum;
}

} // namespace

std::unique_ptr<VolumeSource> makeResampledSource(VolumeInfo info, std::unique_ptr<SourceMesh> mesh) {
    return std::make_unique<ResampledSource>(std::move(info), std::move(mesh));
}

std::unique_ptr<SourceMesh> makeCurvilinearMesh(CurvilinearGrid grid) {
    return std::make_unique<CurvilinearMesh>(std::move(grid));
}

ResampleReport compareWithSource(const ScalarGrid& grid, const SourceMesh& mesh) {
    const GridGeometry& geometry = grid.geometry();
    const glm::dmat3 toIndex = glm::inverse(geometry.direction);
    const auto samples = grid.values<float>();
    const auto values = mesh.values();
    ResampleReport report;
    report.sourcePoints = static_cast<std::int64_t>(values.size());
    report.outsidePoints = std::count_if(samples.begin(), samples.end(), [](float v) { return std::isnan(v); });
    double low = std::numeric_limits<double>::infinity(), high = -low, squares = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = static_cast<double>(values[i]);
        if (!std::isfinite(value))
            continue;
        low = std::min(low, value);
        high = std::max(high, value);
        const double there =
            interpolated(samples, geometry.dims, toIndex * (mesh.point(i) - geometry.origin) / geometry.spacing);
        if (!std::isfinite(there))
            continue;
        const double difference = std::abs(there - value);
        ++report.comparedPoints;
        report.maxDifference = std::max(report.maxDifference, difference);
        squares += difference * difference;
    }
    if (report.comparedPoints > 0)
        report.rmsDifference = std::sqrt(squares / static_cast<double>(report.comparedPoints));
    if (high > low)
        report.rangeFraction = report.maxDifference / (high - low);
    return report;
}

GridDims evenDims(const glm::dvec3& low, const glm::dvec3& high, std::int64_t count) {
    const glm::dvec3 size = high - low;
    const auto dimsFor = [&](double spacing) {
        GridDims dims{2, 2, 2};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double cells = std::round(size[static_cast<int>(axis)] / spacing);
            dims[axis] = 1 + std::clamp<std::int64_t>(
                                 std::isfinite(cells) && cells < 1e6 ? std::llround(cells) : kMaxDim, 1, kMaxDim - 1);
        }
        return dims;
    };
    const auto countOf = [](const GridDims& dims) { // three factors of 2^20: too many for 64 bits
        return static_cast<double>(dims[0]) * static_cast<double>(dims[1]) * static_cast<double>(dims[2]);
    };
    const double longest = std::max({size.x, size.y, size.z});
    double fine = longest / static_cast<double>(kMaxDim), coarse = longest;
    for (int step = 0; step < 80; ++step) { // the spacing, by halves on a logarithmic scale
        const double middle = std::sqrt(fine) * std::sqrt(coarse);
        (countOf(dimsFor(middle)) > static_cast<double>(count) ? fine : coarse) = middle;
    }
    return dimsFor(coarse);
}

Result<GridDims> resampledDims(const ReadOptions& options, const GridDims& otherwise,
                               const std::filesystem::path& path) {
    const GridDims wanted = options.resampleDims == GridDims{0, 0, 0} ? otherwise : options.resampleDims;
    auto dims = checkDims(wanted, "size", path);
    if (dims.isOk()) // while it is made there are two
        ISO_TRY(checkFitsMemory(2 * sizeof(float) * static_cast<std::uint64_t>(pointCount(dims.value())),
                                options.memoryBytes, path));
    return dims;
}

} // namespace isoslider::io
