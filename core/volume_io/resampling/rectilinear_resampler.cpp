#include "core/volume_io/resampling/rectilinear_resampler.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include <tbb/parallel_for.h>

#include "core/volume_io/parsing/header_checks.h"
#include "core/volume_io/resampling/point_lattice.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kChunkSamples = std::size_t{1} << 22;

constexpr int kMostRefinement = 32; ///< in points, along an axis and in all
constexpr std::int64_t kMostDefaultPoints = std::int64_t{1} << 26;

/// Cells as wide as the narrowest of `axis`, over its whole length; whole if that is a multiple but for rounding.
std::int64_t finestCells(const GridAxis& axis) {
    const auto own = static_cast<std::int64_t>(axis.at.size()) - 1;
    if (axis.isEven || own < 1)
        return own;
    double narrowest = axis.at[1] - axis.at[0];
    for (std::size_t i = 2; i < axis.at.size(); ++i)
        narrowest = std::min(narrowest, axis.at[i] - axis.at[i - 1]);
    const double cells = (axis.at.back() - axis.at.front()) / narrowest;
    const std::int64_t most = std::min<std::int64_t>((own + 1) * kMostRefinement, kMaxDim) - 1;
    if (!(cells < static_cast<double>(most)))
        return std::max(own, most);
    const double nearest = std::round(cells);
    return static_cast<std::int64_t>(std::abs(cells - nearest) < kEvenTolerance * cells ? nearest : std::ceil(cells));
}

/// Where an output point lies on an axis: between `first` and `second`, which are one where it is on a point.
struct Between {
    std::size_t first, second;
    double weight; ///< of second
};

std::vector<Between> placesOn(const GridAxis& axis, double origin, double spacing, std::int64_t count) {
    std::vector<Between> places(static_cast<std::size_t>(count));
    std::size_t cell = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double at = std::clamp(origin + static_cast<double>(i) * spacing, axis.at.front(), axis.at.back());
        while (cell + 2 < axis.at.size() && at >= axis.at[cell + 1])
            ++cell;
        if (axis.at.size() < 2) {
            places[i] = {0, 0, 0.0};
            continue;
        }
        const double weight = (at - axis.at[cell]) / (axis.at[cell + 1] - axis.at[cell]);
        constexpr double kOnPoint = 1e-9; // the last output point misses the last one of the axis by rounding
        if (weight < kOnPoint)
            places[i] = {cell, cell, 0.0};
        else if (weight > 1.0 - kOnPoint)
            places[i] = {cell + 1, cell + 1, 0.0};
        else
            places[i] = {cell, cell + 1, weight};
    }
    return places;
}

double mixed(double first, double second, double weight) { return first + weight * (second - first); }

class RectilinearMesh final : public SourceMesh {
public:
    RectilinearMesh(std::unique_ptr<VolumeSource> source, std::array<GridAxis, 3> axes)
        : source_(std::move(source)), axes_(std::move(axes)) {}

    Result<ScalarGrid> resample(const GridGeometry& geometry, const JobControl& job) override {
        ISO_TRY(load(job.part(0.0, 0.5)));
        return resampleRectilinear(axes_, values_, geometry, job.part(0.5, 1.0));
    }
    std::span<const float> values() const override { return values_; }
    glm::dvec3 point(std::size_t index) const override {
        const std::size_t nx = axes_[0].at.size(), ny = axes_[1].at.size();
        return {axes_[0].at[index % nx], axes_[1].at[index / nx % ny], axes_[2].at[index / nx / ny]};
    }

private:
    Status load(const JobControl& job) {
        const VolumeInfo& info = source_->info();
        const GridDims& dims = info.geometry.dims;
        const auto plane = static_cast<std::size_t>(dims[0] * dims[1]);
        const auto step = static_cast<std::int64_t>(std::max<std::size_t>(1, kChunkSamples / plane));
        values_.clear();
        values_.reserve(static_cast<std::size_t>(pointCount(dims)));
        std::vector<std::byte> slab;
        for (std::int64_t z = 0; z < dims[2]; z += step) {
            if (job.isStopRequested())
                return cancelledError();
            const std::int64_t end = std::min(z + step, dims[2]);
            slab.resize(plane * static_cast<std::size_t>(end - z) * scalarTypeSizeBytes(info.type));
            ISO_TRY(source_->readSlab(z, end, slab));
            visitScalarType(info.type, [&](auto sample) {
                const std::span values(reinterpret_cast<const decltype(sample)*>(slab.data()),
                                       slab.size() / sizeof sample);
                for (const auto value : values)
                    values_.push_back(static_cast<float>(value));
            });
            job.report(static_cast<double>(end) / static_cast<double>(dims[2]), "reading");
        }
        return {};
    }

    std::unique_ptr<VolumeSource> source_;
    std::array<GridAxis, 3> axes_;
    std::vector<float> values_;
};

/// Another source's samples at a separate place.
class PlacedSource final : public VolumeSource {
public:
    PlacedSource(std::unique_ptr<VolumeSource> source, const GridGeometry& geometry)
        : source_(std::move(source)), info_(source_->info()) {
        info_.geometry = geometry;
    }
    const VolumeInfo& info() const override { return info_; }
    Status readSlab(std::int64_t zBegin, std::int64_t zEnd, std::span<std::byte> out) override {
        return source_->readSlab(zBegin, zEnd, out);
    }

private:
    std::unique_ptr<VolumeSource> source_;
    VolumeInfo info_;
};

} // namespace

double GridAxis::spacing(std::size_t count) const {
    return count < 2 || at.size() < 2 ? 1.0 : (at.back() - at.front()) / static_cast<double>(count - 1);
}

Result<GridAxis> makeAxis(std::vector<double> coordinates, std::string_view field, const std::filesystem::path& path) {
    ISO_CHECK(!coordinates.empty());
    GridAxis axis;
    axis.isDescending = coordinates.size() > 1 && coordinates[1] < coordinates[0];
    if (axis.isDescending)
        std::reverse(coordinates.begin(), coordinates.end());
    axis.at = std::move(coordinates);
    for (std::size_t i = 0; i < axis.at.size(); ++i)
        if (!std::isfinite(axis.at[i]) || (i > 0 && !(axis.at[i] > axis.at[i - 1])))
            return refuseField(field,
                               "the coordinates neither ascend nor descend from one point to the next (at " +
                                   std::to_string(i) + " of " + std::to_string(axis.at.size()) + ")",
                               path);
    const double spacing = axis.spacing(axis.at.size());
    if (!std::isfinite(spacing))
        return refuseField(field, "the coordinates span more than a number can hold", path);
    const double tolerance = latticeTolerance(spacing, std::max(std::abs(axis.at.front()), std::abs(axis.at.back())));
    for (std::size_t i = 0; i < axis.at.size(); ++i)
        if (std::abs(axis.at[i] - (axis.at[0] + static_cast<double>(i) * spacing)) > tolerance)
            axis.isEven = false;
    return axis;
}

GridAxis indexAxis(std::int64_t count) {
    GridAxis axis;
    for (std::int64_t i = 0; i < count; ++i)
        axis.at.push_back(static_cast<double>(i));
    return axis;
}

GridGeometry axesGeometry(const std::array<GridAxis, 3>& axes, const GridDims& dims) {
    GridGeometry geometry;
    geometry.dims = dims;
    for (int axis = 0; axis < 3; ++axis) {
        const auto index = static_cast<std::size_t>(axis);
        geometry.origin[axis] = axes[index].origin();
        geometry.spacing[axis] = axes[index].spacing(static_cast<std::size_t>(dims[index]));
    }
    return geometry;
}

GridDims defaultDims(const std::array<GridAxis, 3>& axes, std::uint64_t memoryBytes) {
    std::array<double, 3> finestOf{};
    std::transform(axes.begin(), axes.end(), finestOf.begin(),
                   [](const GridAxis& axis) { return static_cast<double>(finestCells(axis)); });
    const auto dimsAt = [&](double share) {
        GridDims dims{1, 1, 1};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto own = static_cast<std::int64_t>(axes[axis].at.size());
            const auto cells = static_cast<std::int64_t>(share * finestOf[axis]);
            dims[axis] = std::max(own, cells + 1);
        }
        return dims;
    };
    // Half, for the file's own samples are in memory too; each point twice while they are made.
    const std::uint64_t room = memoryBytes / 2 / (2 * sizeof(float));
    const auto countOf = [](const GridDims& dims) { // three factors of 2^20: too many for 64 bits
        return static_cast<double>(dims[0]) * static_cast<double>(dims[1]) * static_cast<double>(dims[2]);
    };
    const double most = std::min({static_cast<double>(kMostDefaultPoints), kMostRefinement * countOf(dimsAt(0.0)),
                                  memoryBytes == 0 ? HUGE_VAL : static_cast<double>(room)});
    const auto isTooLarge = [&](const GridDims& dims) { return countOf(dims) > most; };
    const GridDims finest = dimsAt(1.0);
    if (!isTooLarge(finest))
        return finest;
    double fits = 0.0, exceeds = 1.0; // at 0 they have their own
    for (int step = 0; step < 40; ++step) {
        const double middle = 0.5 * (fits + exceeds);
        (isTooLarge(dimsAt(middle)) ? exceeds : fits) = middle;
    }
    return dimsAt(fits);
}

Result<ScalarGrid> resampleRectilinear(const std::array<GridAxis, 3>& axes, std::span<const float> values,
                                       const GridGeometry& geometry, const JobControl& job) {
    const std::size_t nx = axes[0].at.size(), ny = axes[1].at.size();
    ISO_CHECK(values.size() == nx * ny * axes[2].at.size());
    std::array<std::vector<Between>, 3> places;
    for (int axis = 0; axis < 3; ++axis) {
        const auto index = static_cast<std::size_t>(axis);
        places[index] = placesOn(axes[index], geometry.origin[axis], geometry.spacing[axis], geometry.dims[index]);
    }
    std::vector<float> samples(static_cast<std::size_t>(pointCount(geometry.dims)));
    std::atomic<std::int64_t> finished = 0;
    std::mutex progressMutex;
    tbb::parallel_for(std::int64_t{0}, geometry.dims[2], [&](std::int64_t k) {
        if (job.isStopRequested())
            return;
        const Between& z = places[2][static_cast<std::size_t>(k)];
        float* out = samples.data() + geometry.dims[0] * geometry.dims[1] * k;
        for (const Between& y : places[1]) {
            const auto row = [&](std::size_t j, std::size_t plane) { return values.data() + nx * (j + ny * plane); };
            const float* rows[2][2] = {{row(y.first, z.first), row(y.second, z.first)},
                                       {row(y.first, z.second), row(y.second, z.second)}};
            for (const Between& x : places[0]) {
                const auto along = [&](const float* r) {
                    return mixed(static_cast<double>(r[x.first]), static_cast<double>(r[x.second]), x.weight);
                };
                *out++ = static_cast<float>(mixed(mixed(along(rows[0][0]), along(rows[0][1]), y.weight),
                                                  mixed(along(rows[1][0]), along(rows[1][1]), y.weight), z.weight));
            }
        }
        const std::scoped_lock lock(progressMutex);
        job.report(static_cast<double>(++finished) / static_cast<double>(geometry.dims[2]), "resampling");
    });
    if (job.isStopRequested())
        return cancelledError();
    return ScalarGrid::fromValues<float>(geometry, ScalarType::F32, samples);
}

Result<std::unique_ptr<VolumeSource>> placeOnAxes(std::unique_ptr<VolumeSource> source, std::array<GridAxis, 3> axes,
                                                  const ReadOptions& options, const std::filesystem::path& path) {
    const GridDims own = source->info().geometry.dims;
    for (std::size_t axis = 0; axis < 3; ++axis)
        ISO_CHECK(axes[axis].at.size() == static_cast<std::size_t>(own[axis]));
    if (axes[0].isEven && axes[1].isEven && axes[2].isEven) {
        const GridGeometry geometry = axesGeometry(axes, own);
        ISO_TRY(checkGeometry(geometry, "coordinates", path));
        return std::unique_ptr<VolumeSource>(std::make_unique<PlacedSource>(std::move(source), geometry));
    }
    auto dims = resampledDims(options, defaultDims(axes, options.memoryBytes), path);
    if (!dims.isOk())
        return dims.error();
    for (std::size_t axis = 0; axis < 3; ++axis) // a plane stays one, and a box is no plane
        if ((own[axis] > 1) != (dims.value()[axis] > 1))
            return refuseField(
                "size", own[axis] > 1 ? "two points or more are needed along each axis" : "the data is one plane",
                path);
    ISO_TRY(checkFitsMemory(sizeof(float) * static_cast<std::uint64_t>(pointCount(own)), options.memoryBytes, path));
    VolumeInfo info = source->info();
    info.geometry = axesGeometry(axes, dims.value());
    ISO_TRY(checkGeometry(info.geometry, "coordinates", path));
    return makeResampledSource(std::move(info), std::make_unique<RectilinearMesh>(std::move(source), std::move(axes)));
}

} // namespace isoslider::io
