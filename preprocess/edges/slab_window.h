#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "core/volume_io/sources/volume_source.h"

namespace isoslider::preprocess {

/// A run of z planes of a volume in memory that slides upwards: each plane is read once per pass.
template <class Sample>
class SlabWindow {
public:
    /// It will hold no more than so many planes.
    SlabWindow(io::VolumeSource& source, std::int64_t mostPlanes)
        : source_(source), dims_(source.info().geometry.dims), plane_(static_cast<std::size_t>(dims_[0] * dims_[1])) {
        samples_.reserve(static_cast<std::size_t>(std::min(mostPlanes, dims_[2])) * plane_);
    }

    /// Afterwards planes [zBegin, zEnd) are there. REQUIRES: bounds within the grid, zBegin never falls.
    Status advance(std::int64_t zBegin, std::int64_t zEnd) {
        const std::int64_t kept = std::max<std::int64_t>(0, end_ - zBegin);
        if (kept > 0 && zBegin > begin_)
            std::memmove(samples_.data(), samples_.data() + static_cast<std::size_t>(zBegin - begin_) * plane_,
                         static_cast<std::size_t>(kept) * plane_ * sizeof(Sample));
        samples_.resize(static_cast<std::size_t>(zEnd - zBegin) * plane_);
        const std::int64_t firstNew = zBegin + kept;
        begin_ = zBegin;
        end_ = zEnd;
        if (firstNew >= zEnd)
            return {};
        const auto fresh = std::span(samples_).subspan(static_cast<std::size_t>(firstNew - zBegin) * plane_);
        return source_.readSlab(firstNew, zEnd, std::as_writable_bytes(fresh));
    }

    std::int64_t begin() const { return begin_; }
    std::int64_t end() const { return end_; }
    /// REQUIRES: begin() <= z < end().
    const Sample* plane(std::int64_t z) const {
        return samples_.data() + static_cast<std::size_t>(z - begin_) * plane_;
    }

private:
    io::VolumeSource& source_;
    GridDims dims_;
    std::size_t plane_;
    std::int64_t begin_ = 0;
    std::int64_t end_ = 0;
    std::vector<Sample> samples_;
};

} // namespace isoslider::preprocess
