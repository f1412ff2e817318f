#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/job_control.h"
#include "core/grid/histogram.h"
#include "ui/model/opening/volume_access.h"

namespace isoslider::model {

/// A plane of samples as shades, in rows; column and row run along the two other axes, in their order.
struct SliceImage {
    static constexpr std::int16_t kMissing = -1;

    int axis = 2; ///< the axis that the plane lies across: 0 x, 1 y, 2 z
    std::int64_t position = 0; ///< grid point of the whole volume on that axis, from 0; negative: unknown
    int width = 0; ///< pixels
    int height = 0;
    double pixelWidth = 1.0; ///< in the file's units of length
    double pixelHeight = 1.0;
    std::vector<std::int16_t> shades; ///< 0 to 255, or kMissing; x fastest
};

/// What is shown of a volume before it is opened.
struct VolumePreview {
    io::VolumeInfo info; ///< of the whole volume
    std::int64_t coarseStep = 1; ///< all below are of every coarseStep-th sample along each axis
    bool isResampled = false; ///< all below are of a grid made for the preview, of info's dims
    double min = 0.0; ///< of finite samples, as is max; both 0 if there are none
    double max = 0.0;
    std::uint64_t samples = 0;
    std::uint64_t missingSamples = 0;
    Histogram histogram; ///< no counts if no sample is finite
    std::array<SliceImage, 3> slices; ///< through the middle, across z, y and x
};

/// Most samples that a preview is made of.
inline constexpr std::uint64_t kMostPreviewPaneSamples = std::uint64_t{1} << 22;

/// Reads one plane of samples at a time, and no more planes than are shown. Worker thread.
/// Errors: Cancelled, OutOfSpace (a plane is too large to hold), whatever opening and reading report.
Result<VolumePreview> readVolumePreview(const std::filesystem::path& path, const io::ReadOptions& options,
                                        const VolumeAccess& volumes, const JobControl& job,
                                        std::uint64_t mostSamples = kMostPreviewPaneSamples);

} // namespace isoslider::model
