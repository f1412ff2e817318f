#include "core/volume_io/sources/coarse_reader.h"

#include <algorithm>
#include <new>
#include <vector>

namespace isoslider::io {
namespace {

std::uint64_t planeBytes(const VolumeInfo& info) {
    const auto& dims = info.geometry.dims;
    return static_cast<std::uint64_t>(dims[0] * dims[1]) * scalarTypeSizeBytes(info.type);
}

/// The samples of one plane that stay, at `out`. Returns the end of what was written.
std::byte* thinPlane(std::span<const std::byte> plane, const VolumeInfo& info, std::int64_t step, std::byte* out) {
    const auto& dims = info.geometry.dims;
    return visitScalarType(info.type, [&](auto sample) {
        constexpr std::int64_t kSize = sizeof sample; // a constant, or every copy is a call
        for (std::int64_t y = 0; y < dims[1]; y += step)
            for (std::int64_t x = 0; x < dims[0]; x += step)
                out = std::copy_n(plane.data() + (x + dims[0] * y) * kSize, kSize, out);
        return out;
    });
}

Result<std::vector<std::byte>> readThinned(VolumeSource& source, std::int64_t step, const JobControl& job) {
    const VolumeInfo& info = source.info();
    const std::int64_t depth = info.geometry.dims[2];
    std::vector<std::byte> plane(planeBytes(info));
    std::vector<std::byte> samples(static_cast<std::size_t>(pointCount(coarseDims(info.geometry.dims, step))) *
                                   scalarTypeSizeBytes(info.type));
    std::byte* next = samples.data();
    for (std::int64_t z = 0; z < depth; z += step) {
        if (job.isStopRequested())
            return cancelledError();
        ISO_TRY(source.readSlab(z, z + 1, plane));
        next = thinPlane(plane, info, step, next);
        job.report(static_cast<double>(std::min(z + step, depth)) / static_cast<double>(depth), "reading a preview");
    }
    return samples;
}

} // namespace

GridDims coarseDims(const GridDims& dims, std::int64_t step) {
    GridDims coarse{};
    std::transform(dims.begin(), dims.end(), coarse.begin(), [step](std::int64_t n) { return (n + step - 1) / step; });
    return coarse;
}

GridGeometry coarseGeometry(const GridGeometry& geometry, std::int64_t step) {
    GridGeometry coarse = geometry;
    coarse.dims = coarseDims(geometry.dims, step);
    coarse.spacing *= static_cast<double>(step);
    return coarse;
}

std::optional<std::int64_t> coarseStep(const GridDims& dims, std::uint64_t maxSamples) {
    for (std::int64_t step = 2;; step *= 2) {
        const GridDims coarse = coarseDims(dims, step);
        for (std::size_t axis = 0; axis < dims.size(); ++axis)
            if (coarse[axis] < std::min<std::int64_t>(2, dims[axis]))
                return std::nullopt;
        if (static_cast<std::uint64_t>(pointCount(coarse)) <= maxSamples)
            return step;
        if (step > kMaxDim)
            return std::nullopt;
    }
}

Result<std::shared_ptr<const ScalarGrid>> readCoarse(VolumeSource& source, std::int64_t step, const JobControl& job) {
    try {
        auto samples = readThinned(source, step, job);
        if (!samples.isOk())
            return std::move(samples).error();
        const auto& info = source.info();
        return std::make_shared<const ScalarGrid>(coarseGeometry(info.geometry, step), info.type,
                                                  std::move(samples).value());
    } catch (const std::bad_alloc&) {
        return makeError(ErrorCode::OutOfSpace, "not enough memory for a preview");
    }
}

} // namespace isoslider::io
