#include "ui/model/opening/volume_preview.h"

#include <algorithm>
#include <cmath>

#include "core/grid/value_distribution.h"
#include "core/grid/volume_statistics.h"
#include "core/volume_io/sources/coarse_reader.h"
#include "ui/model/isovalue/histogram_model.h"

namespace isoslider::model {
namespace {

constexpr std::uint64_t kMostPlaneBytes = std::uint64_t{256} << 20;
constexpr int kBins = 512;
/// Share of the samples that may be darker than black, and as many brighter than white: a few outliers must
/// not make everything else one grey.
constexpr double kClippedShare = 0.002;

struct ShadeRange {
    double black = 0.0;
    double white = 1.0;
};

/// Upper end of the bins, from either side, that hold kClippedShare of the counts.
ShadeRange shadeRangeOf(const Histogram& histogram) {
    ShadeRange range{histogram.min, histogram.max};
    double total = 0.0;
    for (const auto count : histogram.counts)
        total += static_cast<double>(count);
    const std::size_t bins = histogram.counts.size();
    const double clipped = total * kClippedShare;
    std::size_t low = 0, high = bins;
    for (double sum = 0.0; low < bins && (sum += static_cast<double>(histogram.counts[low])) <= clipped;)
        ++low;
    for (double sum = 0.0; high > low && (sum += static_cast<double>(histogram.counts[high - 1])) <= clipped;)
        --high;
    // All but a few samples in one bin: then those few are what there is to see.
    if (high <= low + 1)
        return range;
    return {binLowerEnd(histogram, low), binLowerEnd(histogram, high)};
}

std::int16_t shadeOf(double value, const ShadeRange& range) {
    if (!std::isfinite(value))
        return SliceImage::kMissing;
    const double width = range.white - range.black;
    const double share = width > 0.0 ? (value - range.black) / width : 0.5;
    return static_cast<std::int16_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255.0));
}

SliceImage middleSlice(const ScalarGrid& grid, int axis, std::int64_t step, const ShadeRange& range) {
    const auto& geometry = grid.geometry();
    const int across = axis == 0 ? 1 : 0, down = axis == 2 ? 1 : 2;
    const auto at = [&](int which) { return static_cast<std::size_t>(which); };
    const std::int64_t middle = geometry.dims[at(axis)] / 2;
    SliceImage slice;
    slice.axis = axis;
    slice.position = middle * step;
    slice.width = static_cast<int>(geometry.dims[at(across)]);
    slice.height = static_cast<int>(geometry.dims[at(down)]);
    slice.pixelWidth = geometry.spacing[across];
    slice.pixelHeight = geometry.spacing[down];
    slice.shades.reserve(at(slice.width) * at(slice.height));
    GridDims point{};
    point[at(axis)] = middle;
    for (point[at(down)] = 0; point[at(down)] < slice.height; ++point[at(down)])
        for (point[at(across)] = 0; point[at(across)] < slice.width; ++point[at(across)])
            slice.shades.push_back(shadeOf(grid.valueAt(point[0], point[1], point[2]), range));
    return slice;
}

Result<std::int64_t> previewStep(const io::VolumeInfo& info, std::uint64_t mostSamples) {
    const auto& dims = info.geometry.dims;
    const auto planeBytes = static_cast<std::uint64_t>(dims[0] * dims[1]) * scalarTypeSizeBytes(info.type);
    if (planeBytes > kMostPlaneBytes)
        return makeError(ErrorCode::OutOfSpace,
                         "its planes are too large for a preview; it can be opened all the same");
    if (static_cast<std::uint64_t>(pointCount(dims)) <= mostSamples)
        return std::int64_t{1};
    const auto step = io::coarseStep(dims, mostSamples);
    if (!step)
        return makeError(ErrorCode::OutOfSpace, "is too flat for a preview; it can be opened all the same");
    return *step;
}

} // namespace

Result<VolumePreview> readVolumePreview(const std::filesystem::path& path, const io::ReadOptions& options,
                                        const VolumeAccess& volumes, const JobControl& job, std::uint64_t mostSamples) {
    const auto source = volumes.open(path, options);
    if (!source.isOk())
        return source.error();
    if (job.isStopRequested())
        return cancelledError();
    VolumePreview preview;
    preview.info = source.value()->info();
    preview.isResampled = options.resampleDims[0] > 0;
    const auto step = previewStep(preview.info, mostSamples);
    if (!step.isOk())
        return step.error();
    preview.coarseStep = step.value();
    ISO_TRY(source.value()->prepare(job.part(0.0, 0.5)));
    const auto read = io::readCoarse(*source.value(), step.value(), job.part(0.5, 1.0));
    if (!read.isOk())
        return read.error();
    preview.info = source.value()->info(); // complete by now
    const ScalarGrid& grid = *read.value();
    preview.samples = static_cast<std::uint64_t>(pointCount(grid.dims()));
    const auto statistics = computeStatistics(grid, false, kBins, job);
    if (statistics.isOk()) {
        preview.min = statistics.value().min;
        preview.max = statistics.value().max;
        preview.missingSamples = statistics.value().nanCount;
        // An outlier or a fill value would leave the slices black, and the histogram in one bin.
        auto values = distributionOf(grid, preview.min, preview.max, job);
        if (!values.isOk())
            return std::move(values).error();
        preview.histogram = std::move(values).value().body;
    } else if (statistics.error().code == ErrorCode::InvalidArgument) { // no finite sample
        preview.missingSamples = preview.samples;
    } else {
        return statistics.error();
    }
    const ShadeRange range = shadeRangeOf(preview.histogram);
    for (int i = 0; i < 3; ++i) {
        auto& slice = preview.slices[static_cast<std::size_t>(i)] = middleSlice(grid, 2 - i, step.value(), range);
        if (preview.isResampled)
            slice.position = -1;
    }
    return preview;
}

} // namespace isoslider::model
