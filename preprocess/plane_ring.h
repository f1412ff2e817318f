#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <tbb/task_group.h>

#include "core/index/chunk_codec.h"
#include "core/volume_io/volume_source.h"

namespace isoslider::preprocess {

/// The z planes of a volume in slabs as thick as a chunk. Four are in memory: one that is worked on, those
/// beside it, and one that is being read meanwhile. Each plane is read once a pass.
template <class Sample>
class PlaneRing {
public:
    static constexpr std::int64_t kThickness = index::kChunkSide;
    static constexpr std::int64_t kSlabs = 4;

    explicit PlaneRing(io::VolumeSource& source)
        : source_(source), dims_(source.info().geometry.dims), plane_(static_cast<std::size_t>(dims_[0] * dims_[1])) {}
    ~PlaneRing() { reading_.wait(); }
    PlaneRing(const PlaneRing&) = delete;
    PlaneRing& operator=(const PlaneRing&) = delete;

    std::int64_t slabCount() const { return (dims_[2] + kThickness - 1) / kThickness; }
    static std::size_t memoryBytes(const GridDims& dims) {
        const std::int64_t planes = std::min(dims[2], kSlabs * kThickness);
        return static_cast<std::size_t>(dims[0] * dims[1] * planes) * sizeof(Sample);
    }

    /// Afterwards the slab, one plane below and one above it are there, and another slab is on its way.
    /// REQUIRES: called with 0, 1, 2, … Errors: those of the source.
    Status advance(std::int64_t slab) {
        ISO_TRY(await());
        while (next_ < std::min(slab + 2, slabCount())) {
            read();
            ISO_TRY(await());
        }
        if (next_ < slabCount())
            reading_.run([this] { read(); });
        return {};
    }
    /// REQUIRES: in the slab, or beside it.
    const Sample* plane(std::int64_t z) const {
        return slabs_[static_cast<std::size_t>(z / kThickness % kSlabs)].data() + static_cast<std::size_t>(z % kThickness) * plane_;
    }

private:
    void read() {
        const std::int64_t begin = next_ * kThickness, end = std::min(dims_[2], begin + kThickness);
        std::vector<Sample>& slab = slabs_[static_cast<std::size_t>(next_ % kSlabs)];
        slab.resize(static_cast<std::size_t>(end - begin) * plane_);
        if (Status status = source_.readSlab(begin, end, std::as_writable_bytes(std::span(slab))); !status.isOk())
            error_ = status.error();
        ++next_;
    }
    Status await() {
        reading_.wait();
        return error_ ? Status(*error_) : Status();
    }

    io::VolumeSource& source_;
    GridDims dims_;
    std::size_t plane_;
    std::array<std::vector<Sample>, kSlabs> slabs_;
    std::int64_t next_ = 0; ///< slab to read
    std::optional<Error> error_;
    tbb::task_group reading_;
};

} // namespace isoslider::preprocess
