#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <optional>
#include <stop_token>
#include <vector>

#include <tbb/task_group.h>

#include "core/base/job_control.h"
#include "core/index/format/chunk_codec.h"
#include "core/volume_io/sources/volume_source.h"

namespace isoslider::preprocess {

/// The z planes of a volume in slabs as thick as a chunk: those of one slab, one plane on either side, and, where
/// there is memory for it, the next slab's, which are read meanwhile. Each plane is read once a pass.
template <class Sample>
class PlaneRing {
public:
    static constexpr std::int64_t kThickness = index::kChunkSide;
    /// Planes in memory: the least, and with the next slab.
    static constexpr std::int64_t kLeastPlanes = kThickness + 2;
    static constexpr std::int64_t kPlanes = kLeastPlanes + kThickness;

    /// `firstSlab`: the one to begin with.
    PlaneRing(io::VolumeSource& source, bool readsAhead, std::stop_token stop, std::int64_t firstSlab = 0)
        : source_(source),
          dims_(source.info().geometry.dims),
          planeSize_(static_cast<std::size_t>(dims_[0] * dims_[1])),
          planes_(std::min(dims_[2], readsAhead ? kPlanes : kLeastPlanes)),
          readsAhead_(readsAhead),
          stop_(std::move(stop)),
          samples_(planeSize_ * static_cast<std::size_t>(planes_)),
          next_(std::max<std::int64_t>(0, firstSlab * kThickness - 1)) {}
    ~PlaneRing() { reading_.wait(); }
    PlaneRing(const PlaneRing&) = delete;
    PlaneRing& operator=(const PlaneRing&) = delete;

    std::int64_t slabCount() const { return (dims_[2] + kThickness - 1) / kThickness; }
    static std::uint64_t memoryBytes(const GridDims& dims, bool readsAhead) {
        const std::int64_t planes = std::min(dims[2], readsAhead ? kPlanes : kLeastPlanes);
        return static_cast<std::uint64_t>(dims[0] * dims[1] * planes) * sizeof(Sample);
    }

    /// Afterwards the slab, one plane below and one above it are there.
    /// REQUIRES: called with the first slab, then the next ones in turn. Errors: those of the source, Cancelled.
    Status advance(std::int64_t slab) {
        reading_.wait();
        const std::int64_t end = std::min(dims_[2], (slab + 1) * kThickness + 1);
        readUpTo(end);
        if (error_)
            return *error_;
        if (readsAhead_ && end < dims_[2])
            reading_.run([this, end] { readUpTo(std::min(dims_[2], end + kThickness)); });
        return {};
    }
    /// REQUIRES: in the slab, or beside it.
    const Sample* plane(std::int64_t z) const {
        return samples_.data() + static_cast<std::size_t>(z % planes_) * planeSize_;
    }

private:
    // In parts, so that a job can be stopped between them.
    void readUpTo(std::int64_t end) {
        constexpr std::size_t kPartBytes = std::size_t{8} << 20;
        const auto most =
            static_cast<std::int64_t>(std::max<std::size_t>(1, kPartBytes / (planeSize_ * sizeof(Sample))));
        try {
            while (next_ < end && !error_) {
                if (stop_.stop_requested()) {
                    error_ = cancelledError();
                    return;
                }
                const std::int64_t slot = next_ % planes_;
                const std::int64_t count = std::min({most, end - next_, planes_ - slot});
                const auto out = std::span(samples_).subspan(static_cast<std::size_t>(slot) * planeSize_,
                                                             static_cast<std::size_t>(count) * planeSize_);
                if (Status status = source_.readSlab(next_, next_ + count, std::as_writable_bytes(out)); !status.isOk())
                    error_ = status.error();
                next_ += count;
            }
        } catch (const std::bad_alloc&) {
            error_ = makeError(ErrorCode::OutOfSpace, "not enough memory to read the volume");
        }
    }

    io::VolumeSource& source_;
    GridDims dims_;
    std::size_t planeSize_;
    std::int64_t planes_;
    bool readsAhead_;
    std::stop_token stop_;
    std::vector<Sample> samples_; ///< plane z at z modulo planes_
    std::int64_t next_; ///< plane to read
    std::optional<Error> error_;
    tbb::task_group reading_;
};

} // namespace isoslider::preprocess
